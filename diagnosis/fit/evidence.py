"""How probable a fitted hypothesis makes the logs: its evidence, by Laplace's method."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from diagnosis import decisions
from diagnosis.fit.free_numbers import from_zero
from diagnosis.fit.linear_problem import Fit
from diagnosis.hypothesis.case import Case
from sim.effect import Effect, Role

# Nats of a choice among as many as are tried: some 800 steps of an input in eight kinds of rounding (detect/input_steps.py), and as many
# waves as detect/waves.py has rates.
STEPS_COST, WAVES_COST = math.log(800 * 8), math.log(274)


@dataclass(frozen=True, eq=False)
class FittedHypothesis:
    """A hypothesis with its fit: `effects` its names in order, `evidence` the log evidence by Laplace, unscaled."""

    effects: tuple[str, ...]
    fit: Fit
    evidence: float


def log_evidence(found: Fit, effects: Mapping[str, Effect]) -> float:
    """Log evidence by Laplace's method, with theta normal and sizes SIZE_SD times their reference; each shape costs SHAPE_COST, whatever
    the logs tell of it: one of which they tell nothing makes nothing likelier. Which logs an effect is not in costs what that choice does.

    `effects` is the plant's library.
    """
    size = len(found.hypothesis.theta)
    new = [(row, from_zero(entry.parameter)) for row, entry in enumerate(found.free, size) if entry.stated is None]
    prior = sum(-np.log(decisions.SIZE_SD) if is_size else -decisions.SHAPE_COST for _, is_size in new)
    known = np.setdiff1d(np.arange(len(found.information)), [row for row, is_size in new if not is_size])
    sign, volume = np.linalg.slogdet(found.information[np.ix_(known, known)])
    carried = [effects[name] for name in found.hypothesis.effects]
    prior -= WAVES_COST * sum(entry.parameter.role in (Role.WAVES, Role.RATE) for entry in found.free)
    rough = [p.is_size for effect in carried for p in effect.parameters if p.rough]
    prior -= sum(STEPS_COST if is_size else decisions.SHAPE_COST for is_size in rough)
    prior -= sum(lack.cost for lack in found.hypothesis.lacks.values())
    prior -= decisions.TAKEN_IN * (len(found.hypothesis.reading_noise) + sum(effect.is_noise for effect in carried))
    return found.log_posterior - 0.5 * float(volume if sign > 0 else 0.0) + prior


def as_fitted(case: Case, found: Fit) -> FittedHypothesis:
    """A fit with the effects that the plant file does not state, and its evidence."""
    return FittedHypothesis(case.added(found.hypothesis.effects), found, log_evidence(found, case.library.effects))


def least_near(best: FittedHypothesis, nominal: FittedHypothesis) -> float:
    """The evidence above which a hypothesis may yet become the best: of 115 ends that were settled none came from further."""
    return best.evidence - max(decisions.PLAIN_TO_SEE, decisions.NEGLIGIBLE_SHARE * (best.evidence - nominal.evidence))
