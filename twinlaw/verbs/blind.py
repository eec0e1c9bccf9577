"""Make sealed cases for a diagnosis, or score what it said of them.

`twinlaw blind make --seed S --out DIR` writes cases whose effects are withheld; `twinlaw blind score DIR RESULTS` opens the seal and
scores RESULTS/case-XXXX/diagnosis.json. The generator shares no code with simulation or diagnosis.
"""

import argparse
import json
from pathlib import Path

import blind
from twinlaw import options
from twinlaw.console import stage


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """make --seed --out --cases --kinds; score DIR RESULTS; --json."""
    verbs = parser.add_subparsers(title="what to do", metavar="make|score", required=True)
    maker = verbs.add_parser("make", help="write cases and seal what is hidden in them")
    maker.add_argument("--seed", type=int, required=True)
    maker.add_argument("--out", type=Path, required=True, metavar="DIR")
    maker.add_argument("--cases", type=options.count, default=60, help="default: %(default)s")
    maker.add_argument("--kinds", default=",".join(blind.KINDS), help="default: %(default)s")
    maker.set_defaults(part=_make)
    scorer = verbs.add_parser("score", help="score answers against the truth")
    scorer.add_argument("cases", type=Path, metavar="DIR")
    scorer.add_argument("results", type=Path, metavar="RESULTS")
    scorer.set_defaults(part=_score)
    for part in (maker, scorer):
        part.add_argument("--json", action="store_true", help="print one JSON object instead of text")


def run(chosen: argparse.Namespace) -> int:
    """Make or score."""
    return int(chosen.part(chosen))


def _make(chosen: argparse.Namespace) -> int:
    with stage(f"flying {chosen.cases} cases"):
        path = blind.make(chosen.seed, chosen.out, chosen.cases, tuple(chosen.kinds.split(",")))
    print(json.dumps({"cases": str(path)}) if chosen.json else f"{path}  {chosen.cases} cases, seed {chosen.seed}")
    return 0


def _score(chosen: argparse.Namespace) -> int:
    result = blind.score(chosen.cases, chosen.results)
    print(blind.to_json(result) if chosen.json else blind.markdown(result))
    return 0
