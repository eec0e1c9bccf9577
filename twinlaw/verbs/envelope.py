"""Identify a helicopter's linear models over its flight envelope from flight tests with multistep inputs, and interpolate between them.

Without FLIGHTS the tests are flown on a simulated helicopter: 22 conditions to identify, each with three flights to validate it, and nine
between them that are only predicted. FLIGHTS is a folder of sidecars NAME.toml with their NAME.csv, as --keep-flights writes them. Writes
DIR/envelope.json, after each condition, and DIR/report.html; models are judged by the FAA's margins and the three-second rule. Conditions
are shared out among processes; DIR/jobs keeps what is done until all is, so that the same command goes on where it was interrupted.
Initial states are tuned automatically; --starts takes others, typed in by flight, to lay beside them. It takes no --plant: it estimates A
and B of a rigid body in flight, whose eight states are all measured, and the FAA states its margins for helicopters alone. Equations of a
plant file hold at every operating point: `identify` takes logs from all of them, and `design` linearises at each.
"""

import argparse
import json
import shutil
from collections.abc import Callable, Sequence
from pathlib import Path

from identification.envelope.by_hand import Tried, tried
from identification.envelope.flights.conditions import Condition
from identification.envelope.flights.flight import Flight
from identification.envelope.flights.flight_file import load_flights, save_flight
from identification.envelope.flights.starts import NONE, load_starts
from identification.envelope.modes import Mode, modes_of
from identification.envelope.one_condition import ConditionResult
from identification.envelope.quality import envelope_quality
from identification.envelope.record import facts, modes_facts, modes_summary, open_loop_facts, summary, validations
from identification.envelope.state_equation.free_run import Model
from identification.envelope.study import Study, study
from identification.envelope.truth.figures import drawn
from identification.envelope.truth.fly import FlightTest, fly
from identification.envelope.truth.linear import linearised
from identification.envelope.truth.plan import plan
from records.errors import BadInput
from records.files import write_atomic
from records.quality import Quality, quality_facts
from twinlaw.cli import console, options
from twinlaw.pages.envelope.models import modes_off
from twinlaw.pages.envelope.report import envelope_page, notes_of, shown, verdict
from twinlaw.pages.envelope.tables import by_hand, conditions, interpolation, open_loop
from twinlaw.pages.page import Table, page_text
from twinlaw.pages.quality import quality_sentence
from twinlaw.workflows import sweeping


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """--seed, --keep-flights, --forgetting, --starts, --show, --workers, --cluster, --out, --json, FLIGHTS."""
    options.seed(parser, "the simulated helicopter and its flights")
    parser.add_argument(
        "--keep-flights", action="store_true", help="write the simulated flights to DIR/flights, some 30 MB"
    )
    parser.add_argument(
        "--forgetting", type=float, default=1.0, metavar="GAMMA", help="of the recursion, above 0; default: %(default)s"
    )
    parser.add_argument(
        "--starts", type=Path, metavar="STARTS.toml", help="initial states to try: sections [FLIGHT] of STATE = VALUE"
    )
    parser.add_argument(
        "--show", metavar="CONDITION", help="draw this condition, as HA6000ft-50kts; default: the worst"
    )
    sweeping.workers(parser)
    options.out(parser)
    options.as_json(parser)
    parser.add_argument("flights", nargs="?", type=Path, metavar="FLIGHTS", help="folder of flight tests")


def run(chosen: argparse.Namespace) -> int:
    """Fly or read, identify, write, tell."""
    flights, origin, exact = _flights(chosen)
    if not any(flight.use == "identification" for flight in flights):
        raise BadInput("flights", origin, "none to identify from", 'one with use = "identification"', "set its use")
    starts = NONE if chosen.starts is None else load_starts(chosen.starts, flights)

    path, saved = chosen.out / "envelope.json", list[Study]()

    def save(so_far: Study) -> None:
        write_atomic(path, json.dumps(facts(so_far), indent=1) + "\n")
        saved.append(so_far)

    kept = chosen.out / "jobs"
    each = sweeping.each("flight conditions", sweeping.crew_of(chosen), kept, lambda order: order.name)
    with console.leaving(lambda: _left(path, saved)):
        found = study(flights, chosen.forgetting, each, save, starts)
    tries, modes = tried(found, starts), modes_of(found, exact)
    quality = envelope_quality(found)
    drawn_one = shown(found, chosen.show)
    means = {
        "open_loop": open_loop_facts(found, drawn_one),
        "validations": validations(found),
        "modes_off": modes_summary(modes),
    }
    content = {**facts(found), **means, "quality": quality_facts(quality), "modes": modes_facts(modes)}
    write_atomic(path, json.dumps(content, indent=1) + "\n")
    with console.stage("drawing the report"):
        write_atomic(chosen.out / "report.html", page_text(envelope_page(found, origin, tries, chosen.show, modes)))
    shutil.rmtree(kept, ignore_errors=True)
    if chosen.json:
        print(
            json.dumps({**summary(found), **means, "quality": quality_facts(quality), "notes": list(notes_of(found))})
        )
        return 0
    _tell(found, quality, tries, drawn_one, None if exact is None else modes)
    print(f"\n{chosen.out / 'report.html'}")
    return 0


def _tell(
    found: Study, quality: Quality, tries: Sequence[Tried], drawn_one: ConditionResult, modes: Sequence[Mode] | None
) -> None:
    """What was found in tables; `modes` where the truth is known."""
    print(f"{verdict(summary(found))}\n{quality_sentence(quality)}")
    for flight in tries:
        print(f"\n{_shown(by_hand(flight))}")
    print(f"\n{drawn_one.condition.name}, one step ahead\n{_shown(open_loop(drawn_one))}")
    print(f"\nPoints outside the margins, starts tuned\n{_shown(conditions(found))}")
    if found.left_out:
        tables = "\n\n".join(map(_shown, interpolation(found)))
        print(f"\nConditions left out\n{tables}")
    if modes is not None:
        print(f"\n{_shown(modes_off(modes))}")
    console.notes(notes_of(found))


def _left(path: Path, saved: list[Study]) -> str:
    again = "the same command goes on from what is done"
    if not saved:
        return again
    done = len(saved[-1].conditions)
    held = f"{done} condition{'s' if done > 1 else ''} identified, and {len(saved[-1].left_out)} predicted between them"
    return f"{path} holds {held}; {again}"


def _demand_shown(name: str | None, flights: Sequence[Flight | FlightTest]) -> None:
    """Raise BadInput now for a condition that no flight identifies."""
    known = dict.fromkeys(flight.condition.name for flight in flights if flight.use == "identification")
    if name is not None and name not in known:
        raise BadInput("--show", "command line", repr(name), f"one of {', '.join(known)}", "name one of these")


Exact = Callable[[Condition], Model]


def _flights(chosen: argparse.Namespace) -> tuple[tuple[Flight, ...], str, Exact | None]:
    """Read or flown, where they came from, and the exact model of a condition where it is known."""
    if chosen.flights is not None:
        flights = load_flights(chosen.flights)
        _demand_shown(chosen.show, flights)
        return flights, str(chosen.flights), None
    machine, tests = drawn(chosen.seed), plan()
    _demand_shown(chosen.show, tests)
    with console.stage(f"flying the simulated helicopter, seed {chosen.seed}"):
        flights = fly(machine, tests, chosen.seed)
    period_s = flights[0].sample_period_s
    if chosen.keep_flights:
        for flight in flights:
            save_flight(chosen.out / "flights", flight)
    return (
        flights,
        f"simulated helicopter, seed {chosen.seed}",
        lambda condition: Model(*linearised(machine, condition, period_s), period_s),
    )


def _shown(table: Table) -> str:
    return console.table(table.rows, table.heading)
