"""Identify a plant's parameters from recorded experiments and run logs, with 95 % intervals, correlations and tests.

FILES are experiments (TOML of `twinlaw experiments`, or a folder of them) and run logs of the plant (CSV with sidecar). Experiments are
taken in the order of the paper, each for its own subsystem, and what one tells goes on to the next with its covariance; logs come last
and are cut into windows with free starts, so that closed loops and unstable plants are welcome. Writes DIR/plant.toml, which every verb
takes, DIR/identification.json and DIR/report.html; an interrupted run leaves plant.toml and identification.json of what was found so far.
--search looks through the whole range first (genetic: the algorithm of seed 001), and the report lays the gradient method beside it.
With --truth the report lays the truth beside every estimate, and the controller designed from the result flies that plant; for
ce150_velagic it redraws Figs. 12 to 14 of seed 001.

--method frequency matches the frequency responses of swept logs (`twinlaw sweep`) instead: the plant linearised where the logs rest, or
the helicopter of seed 002, plants/raptor50.toml. It takes --free, --bounds, --band-rad-s, --trim, --truth, --holdout and
--seed.
"""

import argparse
import json
from collections.abc import Mapping
from pathlib import Path

from identification.results.facts import facts
from identification.results.quality import identification_quality
from identification.results.result import Identification
from identification.runs.run import coefficient_names
from identification.search.methods import METHODS, Search
from records.errors import BadInput
from records.files import write_atomic
from records.quality import Quality, quality_facts
from sim.bind import BoundPlant
from twinlaw.cli import console, options
from twinlaw.pages.identify.report import identify_page
from twinlaw.pages.identify.summary import (
    AID_HEADING,
    FIT_HEADING,
    aid_rows,
    estimate_heading,
    estimate_rows,
    held_out_rows,
)
from twinlaw.pages.identify.truth import true_values
from twinlaw.pages.page import page_text
from twinlaw.pages.quality import quality_sentence
from twinlaw.workflows.identify.by_time import Wishes, identify
from twinlaw.workflows.identify.columns import usable_inputs
from twinlaw.workflows.identify.inputs import free_names, read_limits
from twinlaw.workflows.identify.proof import linear_rotors, proof_facts, proven
from twinlaw.workflows.reading import load_bound


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """--plant, --out, --method, --band-rad-s, --free, --bounds, --search, --seed, --window, --trim, --truth, --offsets,
    --prior, --holdout, --json, FILES.
    """
    options.plant(parser)
    options.out(parser)
    parser.add_argument(
        "--method",
        choices=("time", "frequency"),
        default="time",
        help="match readings over time, or frequency responses of sweeps; default: %(default)s",
    )
    options.band(parser, "match responses over this band; default: all that the records carry")
    parser.add_argument(
        "--free",
        metavar="NAMES",
        help="estimate these, with commas; default: all that the plant file does not state as exact",
    )
    parser.add_argument(
        "--bounds", type=Path, metavar="BOUNDS.toml", help="NAME = [lowest, highest]; default: a fifth to five times"
    )
    parser.add_argument(
        "--search", choices=tuple(METHODS), help="search the whole range first, for a start that may be far off"
    )
    options.seed(parser, "the search")
    _add_log_arguments(parser)
    options.as_json(parser)
    options.logs(parser, "files", "FILES", "experiments, folders of them, run logs")


def _add_log_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--window",
        type=float,
        metavar="SECONDS",
        help="length of the windows of logs; default: logs whole where the model explains them, else the one that tells most",
    )
    parser.add_argument(
        "--trim", nargs=2, type=float, metavar=("BEGIN", "END"), help="use only these seconds of the logs to fit"
    )
    parser.add_argument(
        "--truth",
        type=Path,
        metavar="PLANT.toml",
        help="the plant that was recorded: to lay beside the result, and to fly",
    )
    parser.add_argument(
        "--offsets", action="store_true", help="estimate a constant added to each input of logs, the rig's trim"
    )
    parser.add_argument(
        "--prior", action="store_true", help="what the plant file knows (values, sd, correlation) counts as data"
    )


def run(chosen: argparse.Namespace) -> int:
    """Read everything, estimate, write, tell."""
    holdout = options.held_out(chosen, "files")
    if chosen.method == "frequency":
        # With SciPy's signals, a second to load.
        from twinlaw.workflows.identify.by_frequency import identify_by_frequency

        return identify_by_frequency(chosen, holdout)
    if chosen.band_rad_s is not None:
        raise BadInput("--band-rad-s", "command line", "given without its method", "--method frequency", "add that")
    if chosen.window is not None and not chosen.window > 0.0:
        raise BadInput("--window", "command line", f"{chosen.window:g}", "a time above 0 s", "give seconds")
    bound = load_bound(chosen.plant)
    truth = None if chosen.truth is None else _truth(chosen.truth, bound)
    inputs = usable_inputs(chosen.files, holdout, bound, chosen.trim)
    wishes = _wishes(chosen, bound, len(inputs.experiments) + bool(inputs.logs))
    result = identify(bound, inputs, wishes, chosen.out)
    known = None if truth is None else true_values(truth)
    linear, proof = linear_rotors(inputs.experiments, bound), proven(result, truth)
    for name, picture in proof.pictures.items():
        write_atomic(chosen.out / f"fig-{name}.svg", picture)
    write_atomic(
        chosen.out / "report.html", page_text(identify_page(result, inputs.experiments, linear, proof.sections, known))
    )
    quality = identification_quality(result, known or {})
    content = facts(result) | {"quality": quality_facts(quality)} | proof_facts(result, linear, proof)
    content |= {} if known is None else {"truth": dict(known)}
    write_atomic(chosen.out / "identification.json", json.dumps(content, indent=1) + "\n")
    if chosen.json:
        print(json.dumps(content))
    else:
        _tell(chosen, result, known, quality)
    return 0


def _truth(path: Path, bound: BoundPlant) -> BoundPlant:
    """The plant that was recorded; raises BadInput for one of other equations, whose parameters are none of these."""
    truth = load_bound(path)
    if truth.nominal.name != bound.nominal.name:
        got, expected = f"equations of {truth.nominal.name}", f"those of {bound.nominal.name}, as --plant has"
        raise BadInput("--truth", str(path), got, expected, "give the file of the plant that was recorded")
    return truth


def _wishes(chosen: argparse.Namespace, bound: BoundPlant, fits: int) -> Wishes:
    """What the command line asks of so many `fits`, each with a search of its own."""
    names = free_names(bound, chosen.free)
    limits = read_limits(chosen.bounds, coefficient_names(bound.model))
    beside = tuple(method for method in ("gradient",) if method != chosen.search)
    progress = console.Countdown(f"{chosen.search} search: generation", fits)
    search = None if chosen.search is None else Search(chosen.search, chosen.seed, beside=beside, progress=progress)
    only = None if chosen.free is None else names
    return Wishes(names, limits, search, chosen.window, chosen.prior, chosen.offsets, only)


def _tell(
    chosen: argparse.Namespace, result: Identification, truth: Mapping[str, float] | None, quality: Quality
) -> None:
    if result.warning:
        print(f"{result.warning}\n")
    print(console.table(estimate_rows(result.estimates, result.at_bound, truth), estimate_heading(truth)))
    if result.aids:
        print("\n" + console.table(aid_rows(result.aids), AID_HEADING))
    if result.holdout:
        print("\n" + console.table(held_out_rows(result.holdout), FIT_HEADING))
    console.notes(result.notes)
    print(f"\n{quality_sentence(quality)}\n{chosen.out / 'plant.toml'}")
