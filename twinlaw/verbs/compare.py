"""Compare the controllers: each as generated C on the same firmware, flown on the papers' own manoeuvres, or on steps of each loop.

Writes DIR/compare.json, DIR/controllers.md (of another plant than ce150: controllers-PLANT.md) with a plot of each figure, and for each
controller DIR/NAME/ with its table, C and image. Those that cannot be designed for the plant are
told and left out; those that do not settle on it, which `design` refuses, are told and flown.
Besides the nominal plant they fly plants whose parameters are all up to 10 % off, and each of a list of effects that the
equations lack; these flights are shared out among processes and kept in DIR/jobs. Exit status 1 when twin, compiled C and the emulated
board differ in a single bit.
"""

import argparse
import json
import shlex
from collections.abc import Sequence
from pathlib import Path

from controllers.table import CONTROLLERS
from design.structure import missing
from records.files import write_atomic
from records.quality import quality_facts
from sim.bind import BoundPlant
from twinlaw.cli import console, options
from twinlaw.pages.compare import tables
from twinlaw.pages.compare.comparison import Compared, Wanted, facts
from twinlaw.pages.compare.plots import figure_plot, open_loop_plot
from twinlaw.pages.compare.quality import controller_quality
from twinlaw.pages.compare.reach import reach_sentences
from twinlaw.pages.compare.report import OPEN_LOOP_CAPTION, Told, Where, page_text, verdict
from twinlaw.workflows import sweeping
from twinlaw.workflows.chain.verifying import STEPS
from twinlaw.workflows.comparing import compare_controllers, demand_equal, design_controllers, eq26_errors
from twinlaw.workflows.reading import load_bound
from verification.comparison.conditions import EFFECTS, effects_of
from verification.comparison.flights import Trial
from verification.comparison.manoeuvres import figures, spread_figure
from verification.comparison.open_loop import fly_open_loop

RUNS, SEED = 100, 2


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """--plant, --controllers, --runs, --seed, --effects, --steps, --workers, --cluster, --out, --json."""
    options.plant(parser)
    parser.add_argument(
        "--controllers", nargs="+", choices=tuple(CONTROLLERS), default=tuple(CONTROLLERS), metavar="NAME",
        help=f"which of them: {', '.join(CONTROLLERS)}; default: all",
    )  # fmt: skip
    parser.add_argument("--runs", type=options.count, default=RUNS, help="spread plants; default: %(default)s")
    options.seed(parser, "the spread", SEED)
    parser.add_argument(
        "--effects", nargs="*", metavar="EFFECT",
        help=f"added one at a time, each at its reference size; default, of a helicopter: {', '.join(EFFECTS)}; of another plant: all "
        "that it may have",
    )  # fmt: skip
    parser.add_argument("--steps", type=options.count, default=STEPS, help="compared at least; default: %(default)s")
    sweeping.workers(parser)
    options.out(parser)
    options.as_json(parser)


def run(chosen: argparse.Namespace) -> int:
    """Design, verify, fly, write, tell, and fail where bits differ."""
    bound = load_bound(chosen.plant)
    wanted = Wanted(Trial(chosen.runs, chosen.seed, effects_of(bound, chosen.effects)), chosen.steps)
    names = tuple(dict.fromkeys(chosen.controllers))
    crew = sweeping.crew_of(chosen)
    with crew():  # a cluster that is not there is told now, not after a minute of building
        pass
    each = sweeping.each("flights, 25 at a time", crew, chosen.out / "jobs", lambda order: order.name)
    designed, refused, unsettled = design_controllers(bound, names)
    rows = compare_controllers(bound, designed, wanted, chosen.out, each)
    eq26 = eq26_errors(bound, designed)
    colours = {row.row.name: quality_facts(controller_quality(row)) for row in rows}
    beyond = reach_sentences(rows, spread_figure(bound), is_papers=not missing(bound))
    told = {"refused": refused, "unsettled": unsettled, "beyond_reach": beyond, "quality": colours}
    content = facts(bound, rows, wanted, eq26) | told
    write_atomic(chosen.out / "compare.json", json.dumps(content, indent=1) + "\n")
    page = _write_page(chosen, bound, rows, Told(wanted, eq26, refused, unsettled, beyond))
    if chosen.json:
        print(json.dumps(content))
    else:
        if beyond:
            print("\n".join(beyond), end="\n\n")
        print(console.table(tables.cost_rows(rows), tables.cost_heading(rows)))
        for loop in rows[0].loops:
            print(f"\n{loop.axis}, {wanted.trial.runs} plants within +-10 %")
            print(console.table(tables.spread_rows(rows, loop), tables.SPREAD_HEADING))
        print(f"\n{console.table(tables.quality_rows(rows), tables.QUALITY_HEADING)}")
        for name, why in refused.items():
            print(f"\nnot designed: {name}: {why}")
        for name, why in unsettled.items():
            print(f"\ndoes not settle: {name}: {why}")
        print(f"\n{verdict(rows)}\n{page}")
    demand_equal(rows)
    return 0


def _write_page(
    chosen: argparse.Namespace,
    bound: BoundPlant,
    rows: Sequence[Compared],
    told: Told,
) -> Path:
    """The page and its pictures, all named controllers, behind that the plant where it is not the design's own."""
    stem = "controllers" if bound.plant.name == "ce150" else f"controllers-{bound.plant.name}"
    for name in figures(bound):
        write_atomic(chosen.out / f"{stem}-{name}.svg", figure_plot(rows, name))
    alone = fly_open_loop(bound)
    if alone:
        write_atomic(chosen.out / f"{stem}-fig-18.svg", open_loop_plot(alone))
    titles = {name: figure.title for name, figure in figures(bound).items()}
    caption = OPEN_LOOP_CAPTION if alone else None
    where = Where(
        _command(chosen), str(chosen.out), stem, caption, titles, spread_figure(bound), is_papers=not missing(bound)
    )
    page: Path = chosen.out / f"{stem}.md"
    write_atomic(page, page_text(rows, told, where))
    return page


def _command(chosen: argparse.Namespace) -> str:
    """The command that was typed, as far as it differs from the defaults."""
    words = ["twinlaw", "compare", "--plant", str(chosen.plant), "--out", str(chosen.out)]
    if tuple(chosen.controllers) != tuple(CONTROLLERS):
        words += ["--controllers", *chosen.controllers]
    for name, default in (("runs", RUNS), ("seed", SEED), ("steps", STEPS)):
        if getattr(chosen, name) != default:
            words += [f"--{name}", str(getattr(chosen, name))]
    if chosen.effects is not None:
        words += ["--effects", *chosen.effects]
    return shlex.join(words)
