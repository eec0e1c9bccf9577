"""Identify a helicopter's linear models over its flight envelope from flight tests with multistep inputs, and interpolate between them.

Without FLIGHTS the tests are flown on a simulated helicopter: 22 conditions to identify, each with three flights to validate it, and nine
between them that are only predicted. FLIGHTS is a folder of sidecars NAME.toml with their NAME.csv, as --keep-flights writes them. Writes
DIR/envelope.json, after each condition, and DIR/report.html; models are judged by the FAA's margins and the three-second rule. Conditions
are shared out among processes; DIR/jobs keeps what is done until all is, so that the same command goes on where it was interrupted.
Initial states are tuned automatically; --starts takes others, typed in by flight, to lay beside them.
"""

import argparse
import json
import shutil
from pathlib import Path

from identification.envelope.by_hand import tried
from identification.envelope.flights.flight import Flight
from identification.envelope.flights.flight_file import load_flights, save_flight
from identification.envelope.flights.starts import NONE, load_starts
from identification.envelope.record import facts, summary
from identification.envelope.study import Study, study
from identification.envelope.truth.figures import drawn
from identification.envelope.truth.fly import fly
from identification.envelope.truth.plan import plan
from records.errors import BadInput
from records.files import write_atomic
from twinlaw.cli import console, options
from twinlaw.pages.envelope.report import SHOWN, envelope_page, notes_of, verdict
from twinlaw.pages.envelope.tables import by_hand, conditions, interpolation, open_loop
from twinlaw.pages.page import Table, page_text
from twinlaw.workflows import sweeping


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """--seed, --keep-flights, --forgetting, --starts, --workers, --cluster, --out, --json, FLIGHTS."""
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
    sweeping.workers(parser)
    options.out(parser)
    options.as_json(parser)
    parser.add_argument("flights", nargs="?", type=Path, metavar="FLIGHTS", help="folder of flight tests")


def run(chosen: argparse.Namespace) -> int:
    """Fly or read, identify, write, tell."""
    flights, origin = _flights(chosen)
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
    tries = tried(found, starts)
    with console.stage("drawing the report"):
        write_atomic(chosen.out / "report.html", page_text(envelope_page(found, origin, tries)))
    shutil.rmtree(kept, ignore_errors=True)
    if chosen.json:
        print(json.dumps({**summary(found), "notes": list(notes_of(found))}))
        return 0
    print(verdict(summary(found)))
    for flight in tries:
        print(f"\n{_shown(by_hand(flight))}")
    print(f"\n{found.at(SHOWN).condition.name}, one step ahead\n{_shown(open_loop(found.at(SHOWN)))}")
    print(f"\nPoints outside the margins, starts tuned\n{_shown(conditions(found))}")
    if found.left_out:
        tables = "\n\n".join(map(_shown, interpolation(found)))
        print(f"\nConditions left out\n{tables}")
    for note in notes_of(found):
        print(f"- {note}")
    print(f"\n{chosen.out / 'report.html'}")
    return 0


def _left(path: Path, saved: list[Study]) -> str:
    again = "the same command goes on from what is done"
    if not saved:
        return again
    done = len(saved[-1].conditions)
    held = f"{done} condition{'s' if done > 1 else ''} identified, and {len(saved[-1].left_out)} predicted between them"
    return f"{path} holds {held}; {again}"


def _flights(chosen: argparse.Namespace) -> tuple[tuple[Flight, ...], str]:
    """Read or flown, and where they came from."""
    if chosen.flights is not None:
        return load_flights(chosen.flights), str(chosen.flights)
    with console.stage(f"flying the simulated helicopter, seed {chosen.seed}"):
        flights = fly(drawn(chosen.seed), plan(), chosen.seed)
    if chosen.keep_flights:
        for flight in flights:
            save_flight(chosen.out / "flights", flight)
    return flights, f"simulated helicopter, seed {chosen.seed}"


def _shown(table: Table) -> str:
    return console.table(table.rows, table.heading)
