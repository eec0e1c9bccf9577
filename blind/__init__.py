"""The sealed benchmark: rigs of several kinds with hidden effects, each kind with its own simulation, and the scorer."""

from blind.make import make
from blind.mix import KINDS
from blind.rigs import FIRST, RIGS
from blind.score import Score, score, score_all
from blind.table import markdown, to_json

__all__ = ["FIRST", "KINDS", "RIGS", "Score", "make", "markdown", "score", "score_all", "to_json"]
