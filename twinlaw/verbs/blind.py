"""Make sealed cases for a diagnosis, or score what it said of them.

`twinlaw blind make --seed S --out DIR` writes cases whose effects are withheld, `--rig second` or `--rig real` with another kind of rig;
`twinlaw blind score DIR RESULTS` opens the seal and scores RESULTS/case-XXXX/diagnosis.json. `twinlaw blind diagnose DIR
RESULTS` diagnoses all cases that have no answer yet, `twinlaw blind baseline NAME DIR RESULTS` answers them in a plain way,
to be beaten. `twinlaw blind calibrate --family NAME DIR RESULTS ... --out FILE.json` learns from answers to families of cases,
kinds of rigs say, how probable a diagnosis should call its first name. `twinlaw blind sensitivity DIR OUT` tells what changes
with each constant of diagnosis/decisions.py a little other, most sensitive first. The generator shares no code with simulation
or diagnosis. What was interrupted goes on where it was.
"""

import argparse
import json
import math
import shutil
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import blind
from blind.calibration.table import HEADING, law_text, law_told, rows
from diagnosis.baselines import BASELINES
from jobs.job import Done
from records.errors import BadInput
from records.files import demand_writable, write_atomic
from twinlaw.cli import console, options
from twinlaw.pages import plots
from twinlaw.workflows import sweeping
from twinlaw.workflows.diagnose import sensitivity
from twinlaw.workflows.diagnose.baselines import plain_answers
from twinlaw.workflows.diagnose.each import Answered, answers
from twinlaw.workflows.diagnose.questions import questions
from twinlaw.workflows.diagnose.sensitivity import FACTORS


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """make --seed --out --cases --kinds --rig --plant; diagnose, baseline, score, sensitivity DIR RESULTS; calibrate; --workers; --json."""
    verbs = parser.add_subparsers(
        title="what to do", metavar="make|diagnose|baseline|score|calibrate|sensitivity", required=True
    )
    maker = verbs.add_parser("make", help="write cases and seal what is hidden in them")
    maker.add_argument("--seed", type=int, required=True)
    maker.add_argument("--out", type=Path, required=True, metavar="DIR")
    maker.add_argument("--cases", type=options.count, default=60, help="default: %(default)s")
    maker.add_argument("--kinds", default=",".join(blind.KINDS), help="default: %(default)s")
    maker.add_argument("--rig", default=blind.FIRST, help=f"kind of rig: {', '.join(blind.RIGS)}; default: %(default)s")
    maker.add_argument("--plant", type=Path, metavar="PLANT.toml", help="start from this file, not from the rig's own")
    maker.set_defaults(part=_make)
    asker = verbs.add_parser(
        "diagnose", help="diagnose all cases that RESULTS does not answer yet, side by side, with the time of each"
    )
    asker.add_argument("cases", type=Path, metavar="DIR")
    asker.add_argument("results", type=Path, metavar="RESULTS")
    asker.set_defaults(part=_diagnose)
    plain = verbs.add_parser("baseline", help="answer all cases in a plain way that a diagnosis has to beat")
    plain.add_argument("name", choices=BASELINES)
    plain.add_argument("cases", type=Path, metavar="DIR")
    plain.add_argument("results", type=Path, metavar="RESULTS")
    plain.set_defaults(part=_baseline)
    scorer = verbs.add_parser("score", help="score answers against the truth")
    scorer.add_argument(
        "answered",
        type=Path,
        nargs="+",
        metavar="DIR RESULTS",
        help="cases and their answers; several are scored as one",
    )
    scorer.add_argument(
        "--reliability", type=Path, metavar="FILE.svg", help="also draw stated against true probabilities"
    )
    scorer.set_defaults(part=_score)
    teacher = verbs.add_parser("calibrate", help="learn from answers how probable a first name should be called")
    teacher.add_argument(
        "--family",
        type=Path,
        nargs=3,
        action="append",
        required=True,
        metavar=("NAME", "DIR", "RESULTS"),
        help="cases of one kind and their answers; one for each family, several of one name are one",
    )
    teacher.add_argument("--out", type=Path, required=True, metavar="FILE.json", help="the law that was learned")
    teacher.add_argument("--commit", default="", help="of the engine that answered, to be noted; default: not known")
    teacher.set_defaults(part=_calibrate)
    shaker = verbs.add_parser("sensitivity", help="diagnose all cases again with each constant a little other")
    shaker.add_argument("cases", type=Path, metavar="DIR")
    shaker.add_argument("out", type=Path, metavar="OUT", help="folder for a folder of answers for each change")
    shaker.add_argument(
        "--constant", nargs="+", default=[], metavar="NAME", help="of diagnosis/decisions.py; default: all, one by one"
    )
    shaker.add_argument(
        "--factors",
        nargs="+",
        type=_factor,
        default=FACTORS,
        metavar="X",
        help=f"each constant times each; default: {' '.join(map(str, FACTORS))}",
    )
    shaker.set_defaults(part=_sensitivity)
    for part in (maker, asker, plain, shaker):
        sweeping.workers(part)
    for part in (maker, asker, plain, scorer, teacher, shaker):
        part.add_argument("--json", action="store_true", help="print JSON instead of text, and nothing besides")


def run(chosen: argparse.Namespace) -> int:
    """Make or score."""
    return int(chosen.part(chosen))


def _make(chosen: argparse.Namespace) -> int:
    kept = chosen.out.parent / f".{chosen.out.name}.unfinished"
    each = sweeping.each("flown", sweeping.crew_of(chosen), kept, lambda order: order.name)
    asked = blind.Benchmark(chosen.seed, chosen.cases, tuple(chosen.kinds.split(",")), chosen.plant, chosen.rig)
    path = blind.make(asked, chosen.out, each)
    shutil.rmtree(kept, ignore_errors=True)
    print(json.dumps({"cases": str(path)}) if chosen.json else f"{path}  {chosen.cases} cases, seed {chosen.seed}")
    return 0


def _folders(cases: Path) -> list[Path]:
    folders = sorted(cases.glob("case-*"))
    if not folders:
        raise BadInput("cases", str(cases), "no folder case-*", "what `twinlaw blind make` wrote", "name its DIR")
    return folders


def _diagnose(chosen: argparse.Namespace) -> int:
    asked = questions(Path(), _folders(chosen.cases), ())
    found = list(answers(asked, chosen.results, sweeping.crew_of(chosen)))
    new = sum(not entry.kept and entry.failure is None for entry in found)
    return _answered(chosen, found, {"new": new}, f", {new} of them now")


def _baseline(chosen: argparse.Namespace) -> int:
    asked = questions(Path(), _folders(chosen.cases), ())
    found = list(plain_answers(asked, chosen.name, chosen.results, sweeping.crew_of(chosen)))
    return _answered(chosen, found, {"baseline": chosen.name}, f" by {chosen.name}")


def _answered(
    chosen: argparse.Namespace, found: Sequence[Answered] | Sequence[Done], facts: Mapping[str, Any], told: str
) -> int:
    """Those that failed on stderr, how many were answered on stdout; the exit status."""
    status = sweeping.failures([(entry.name, entry.failure) for entry in found])
    done = sum(entry.failure is None for entry in found)
    line = f"{chosen.results}  {done} of {len(found)} cases answered{told}"
    print(json.dumps({"results": str(chosen.results), "cases": len(found), **facts}) if chosen.json else line)
    return status


def _score(chosen: argparse.Namespace) -> int:
    if len(chosen.answered) % 2:
        got = f"{len(chosen.answered)} folders"
        raise BadInput("folders", "blind score", got, "a RESULTS behind every DIR", "name both of each")
    result = blind.score_all(list(zip(chosen.answered[::2], chosen.answered[1::2], strict=True)))
    if chosen.reliability is not None:
        bins = [(entry.stated, entry.right, entry.count) for entry in result.bins]
        write_atomic(chosen.reliability, plots.reliability(bins))
    print(blind.to_json(result) if chosen.json else blind.markdown(result))
    return 0


def _calibrate(chosen: argparse.Namespace) -> int:
    options.demand_ending(chosen.out, ".json")
    demand_writable(chosen.out)
    folders: dict[str, list[tuple[Path, Path]]] = {}
    for name, cases, results in chosen.family:
        folders.setdefault(str(name), []).append((cases, results))
    found = blind.calibrate([blind.family(name, paths) for name, paths in folders.items()])
    text = law_text(found, chosen.commit)
    write_atomic(chosen.out, text)
    table = console.table(rows(found), HEADING)
    print(text.rstrip() if chosen.json else f"{table}\n\n{law_told(found)}\n{chosen.out}")
    return 0


def _factor(text: str) -> float:
    """What a constant is multiplied by, as the type of an option."""
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 0.0 < value < math.inf or value == 1.0:
        raise argparse.ArgumentTypeError(f"got {text[:30]!r}, expected a positive number other than 1")
    return value


def _sensitivity(chosen: argparse.Namespace) -> int:
    asked, crew = questions(Path(), _folders(chosen.cases), ()), sweeping.crew_of(chosen)
    trials, untried = sensitivity.trials_of(chosen.constant, chosen.factors)
    before = sensitivity.unchanged_answers(asked, chosen.out, crew)
    found = sensitivity.tried(trials, asked, chosen.cases, chosen.out, crew)
    failed = [(f"{sensitivity.UNCHANGED}/{entry.name}", entry.failure) for entry in before]
    status = sweeping.failures([*failed, *(end for entry in found for end in entry.failures)])
    if chosen.json:
        print(
            json.dumps({"cases": len(asked), "changes": sensitivity.facts(found), "untried": dict(untried)}, indent=1)
        )
        return status
    lines = [f"{chosen.out}  {len(asked)} cases, {len(trials)} changes; what they change:", ""]
    lines += [console.table(sensitivity.rows(found), sensitivity.HEADING)] if found else ["nothing tried"]
    lines += ["", *(f"{name} not tried: {reason}" for name, reason in untried.items())] if untried else []
    print("\n".join(lines))
    return status
