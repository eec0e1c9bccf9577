"""The sealed benchmark: rigs with hidden effects, flown by a second simulation, and the scorer that opens the seal."""

from blind.make import make
from blind.mix import KINDS
from blind.score import Score, score, score_all
from blind.table import markdown, to_json

__all__ = ["KINDS", "Score", "make", "markdown", "score", "score_all", "to_json"]
