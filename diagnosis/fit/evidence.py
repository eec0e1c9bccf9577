"""How probable a fitted hypothesis makes the logs: its evidence, by Laplace's method."""

from dataclasses import dataclass

import numpy as np

from diagnosis import decisions
from diagnosis.fit.gauss_newton import Fit, from_zero
from diagnosis.hypothesis.case import Case
from diagnosis.library.effect_library import is_gust

STEPS_COST = 8.0  # nats for the choice of an input's step among some thousand
WAVE_COST = 5.0  # nats for the choice of a sine's waves among some hundred
GUST_COST = 10.0  # nats for a gust's size and time, which the fit does not count among its numbers


@dataclass(frozen=True, eq=False)
class FittedHypothesis:
    """A hypothesis with its fit: `effects` its names in order, `evidence` the log evidence by Laplace, unscaled."""

    effects: tuple[str, ...]
    fit: Fit
    evidence: float


def evidence(found: Fit) -> float:
    """Log evidence by Laplace's method, with theta normal, sizes SIZE_SD times their reference, shapes known to a factor."""
    size = len(found.hypothesis.theta)
    sign, volume = np.linalg.slogdet(found.information)
    new = [(row, from_zero(entry.parameter)) for row, entry in enumerate(found.free, size) if entry.stated is None]
    prior = sum(-np.log(decisions.SIZE_SD) if is_size else -decisions.SHAPE_COST for _, is_size in new)
    shapes = [row for row, is_size in new if not is_size]
    prior -= WAVE_COST * sum(entry.parameter.symbol in ("waves", "rate") for entry in found.free)
    prior -= STEPS_COST * sum(name.endswith("_input.quantization") for name in found.hypothesis.effects)
    prior -= GUST_COST * sum(map(is_gust, found.hypothesis.effects))
    own = 0.5 * sum(float(np.log(max(found.information[row, row], 1.0))) for row in shapes)
    return found.log_posterior - 0.5 * float(volume if sign > 0 else 0.0) + prior + own


def as_fitted(case: Case, found: Fit) -> FittedHypothesis:
    """A fit with the effects that the plant file does not state, and its evidence."""
    return FittedHypothesis(case.added(found.hypothesis.effects), found, evidence(found))
