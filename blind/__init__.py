"""A seed and a kind of rig in; cases with sealed effects, scores of their answers and what these teach of probabilities out."""

from blind.calibration.calibrate import calibrate
from blind.calibration.examples import family
from blind.cases.make import Benchmark, make
from blind.cases.mix import KINDS
from blind.rigs.table import FIRST, RIGS
from blind.scoring.score import Score, score, score_all
from blind.scoring.table import markdown, to_json

__all__ = [
    "FIRST",
    "KINDS",
    "RIGS",
    "Benchmark",
    "Score",
    "calibrate",
    "family",
    "make",
    "markdown",
    "score",
    "score_all",
    "to_json",
]
