"""Every effect alone beside freely re-tuned parameters, ranked by the Bayesian information criterion.

(1)  BIC = n ln(RSS / n) + k ln n

The errors count as n independent ones and the parameters as unknown before: what a textbook does without further thought.
"""

from collections.abc import Sequence

import numpy as np

from diagnosis import decisions
from diagnosis.baselines.windows import Array, Windows, errors, windows_of
from records.diagnosis import Diagnosis, Estimate, PlaceShare, RankedHypothesis, Unknown
from records.log import RunLog
from sim.added_effects import combined, library, redundant, with_values
from sim.bind import BoundPlant
from sim.effect import Effect

DIFFERENCE_STEP = 1e-3  # of a parameter: how far its difference quotient goes
NAMES_TOLD = 10


def by_bic(bound: BoundPlant, logs: Sequence[RunLog]) -> Diagnosis:
    """A gap where some effect lowers eq (1) below that of the re-tuned plant; probabilities by exp(-BIC / 2)."""
    windows = windows_of(bound, logs)
    error = errors(bound, windows)
    scale = np.maximum(np.sqrt(np.mean(error**2, axis=(0, 1))), 1e-12)
    J = _parameter_slopes(bound, windows, error, scale)
    Q = np.linalg.qr(J, mode="reduced")[0]
    left = _beside(Q, (error / scale).ravel())
    known = library(bound)
    names = [
        name
        for name, e in known.items()
        if e.on_equations and e.repeats and not redundant(bound, e, decisions.ANOTHER_PLANT)
    ]
    whole = combined(bound, names)
    fits = []
    for effect in (known[name] for name in names):
        own = _beside(Q, _effect_slope(whole, effect, windows, error, scale))
        power = float(own @ own)
        if np.isfinite(power) and power > 0.0:
            rest = left - own * (own @ left) / power
            fits.append((_bic(rest, J.shape[1] + len(effect.parameters)), _estimate(own, left, effect), effect))
    fits.sort(key=lambda fit: fit[0])
    return _answer(_bic(left, J.shape[1]), fits)


def _answer(plain: float, fits: list[tuple[float, Estimate, Effect]]) -> Diagnosis:
    scores = np.array([plain, *(bic for bic, _, _ in fits)])
    weights = np.exp(-0.5 * (scores - scores.min()))
    weights /= weights.sum()
    gap = bool(fits and fits[0][0] < plain)
    effects = tuple(
        RankedHypothesis(effect.name, effect.class_text, float(weight), {effect.size.symbol: estimate})
        for weight, (_, estimate, effect) in list(zip(weights[1:], fits, strict=True))[:NAMES_TOLD]
    )
    return Diagnosis(
        verdict="gap" if gap else "no gap",
        false_alarm_probability=float(weights[0]),
        places=(PlaceShare(fits[0][2].place, 1.0),) if gap else (),
        effects=effects,
        unknown=Unknown(0.0),
        found=(fits[0][2].name,) if gap else (),
    )


def _bic(left: Array, parameters: int) -> float:
    return float(left.size * np.log(np.sum(left**2) / left.size) + parameters * np.log(left.size))


def _beside(Q: Array, b: Array) -> Array:
    """What orthonormal columns Q leave of b."""
    return np.asarray(b - Q @ (Q.T @ b))


def _parameter_slopes(bound: BoundPlant, windows: Windows, error: Array, scale: Array) -> Array:
    """Errors by every parameter that is not known exactly, shape (errors, parameters)."""
    columns = []
    for k in np.flatnonzero(bound.sd > 0.0):
        p = bound.p.copy()
        p[k] += DIFFERENCE_STEP * (abs(p[k]) or bound.sd[k])
        columns.append(((errors(bound, windows, p) - error) / scale).ravel() / DIFFERENCE_STEP)
    return np.column_stack(columns)


def _effect_slope(whole: BoundPlant, effect: Effect, windows: Windows, error: Array, scale: Array) -> Array:
    """Errors by the effect's size, from its reference size in a plant that has all effects at next to none."""
    sizes = {p.symbol: p.reference for p in effect.parameters}
    return ((errors(with_values(whole, {effect.name: sizes}), windows) - error) / scale).ravel()


def _estimate(own: Array, left: Array, effect: Effect) -> Estimate:
    power = float(own @ own)
    reference = effect.size.reference - effect.size.first
    size, sd = -float(own @ left) / power, float(np.std(left)) / np.sqrt(power)
    return Estimate(effect.size.first + size * reference, abs(sd * reference), effect.size.unit)
