"""How much the delay of a sensor scatters, by maximum likelihood: slopes of the innovations under fixed gains know nothing of it.

Fast motion that a plant predicts badly looks alike to the likelihood, but not to the readings by themselves: scatter that is new with each
reading shows in their fourth differences, which smooth motion leaves alone,

(1)  E (d4 y)^2 / 70 = r + (dy/dt jitter)^2,

so that those of faster readings are the larger. What they do not show is no scatter, and what they may show at most is its bound.
"""

from collections.abc import Iterable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from diagnosis import decisions
from diagnosis.fit.profile_likelihood import likeliest, likelihoods
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import Hypothesis
from diagnosis.library.sensor_effects import RATE_S, rates
from sim.effect import Role, place_and_kind

JITTER_SHARES = (0.03, 0.06, 0.1, 0.15, 0.22, 0.32, 0.45)  # of the delay, scatter that is tried,
JITTER_FINELY = (0.85, 0.92, 1.08, 1.15)  # of the likeliest of these
FOURTH = 70.0  # the sum of the squares of 1, 4, 6, 4, 1
# How much more a mean of squares of fourth differences scatters, as these share readings: the sum of their squared correlations.
SHARED = 1.0 + 2.0 * (56.0**2 + 28.0**2 + 8.0**2 + 1.0) / FOURTH**2
DIFFERENCE_GAIN = 5.0  # times the variance that fourth differences show, where each reading's scatter is its neighbour's as well: 70 / 14

Array = NDArray[np.float64]


def with_jitter(case: Case, hypothesis: Hypothesis, effects: Iterable[str]) -> Hypothesis:
    """The same with the scatter of those of `effects` that are a sensor's delay, likeliest by the logs; 0 where it explains little. Scatter
    may stand for errors of the readings that were supposed: it is looked for beside them, and without."""
    for name in effects:
        if scatters(case, name):
            output = case.library.bound.model.places.sensors[place_and_kind(name)[0]].output
            kept = {one: noise for one, noise in hypothesis.reading_noise.items() if one != output}
            bare = [replace(hypothesis, reading_noise=kept)] if output in hypothesis.reading_noise else []
            found = [_likeliest(case, start, name) for start in (hypothesis, *bare)]
            hypothesis = likeliest(case, found)[0] if bare else found[0]
    return hypothesis


def most_shown_s(case: Case, output: str) -> float:
    """The largest scatter (s) that readings of an output leave room for by themselves, by (1).

    0 where the faster half of those that turn by more than a step a row is no less smooth, or none is faster than another.
    """
    step = case.library.bound.plant.sensors.get(output, 0.0)
    place = case.library.outputs.index(output)
    span_s = RATE_S * case.second_s
    inputs = [flight.filter_input for flight in case.flights]
    found = [_roughness(given.t_s, given.read[:, place], step, span_s) for given in inputs]
    square, rate = np.concatenate(found, axis=1)
    if not len(rate):
        return 0.0
    fast = rate >= np.median(rate)
    if fast.all():
        return 0.0
    more = float(np.mean(square[fast]) - np.mean(square[~fast]))
    error = float(np.hypot(*(np.std(square[half]) / np.sqrt(np.sum(half)) for half in (fast, ~fast))))
    chance = decisions.BEYOND_CHANCE * float(np.sqrt(SHARED)) * error
    if more <= chance:
        return 0.0
    faster = float(np.mean(rate[fast] ** 2) - np.mean(rate[~fast] ** 2))
    return float(np.sqrt(DIFFERENCE_GAIN * (more + chance) / faster))


def scatters(case: Case, name: str) -> bool:
    """Whether an effect has a scatter."""
    return case.library.effects[name].having(Role.JITTER) is not None


def jitter_sd(case: Case, hypothesis: Hypothesis, name: str) -> float:
    """What is known of a delay's scatter (s, one standard deviation), by the likelihood over a fifth of it to both sides.

    Of none, what costs half a nat: the likelihood falls with the square of a scatter that is not there. As large as what was tried where
    the likelihood falls by less than that.
    """
    effect = case.library.effects[name]
    tau_s, jitter_s = (hypothesis.effects[name][effect.symbol(role)] for role in (Role.LATENESS, Role.JITTER))
    reach = 0.2 * jitter_s if jitter_s > 0.0 else JITTER_SHARES[0] * tau_s
    found = _tried(case, hypothesis, name, {max(jitter_s - reach, 0.0), jitter_s, jitter_s + reach})
    lost = found[jitter_s] - 0.5 * (found[max(jitter_s - reach, 0.0)] + found[jitter_s + reach])
    lost = lost if jitter_s > 0.0 else 2.0 * lost
    return float(reach * np.sqrt(0.5 / lost)) if 0.5 < lost < np.inf else reach


def _roughness(t_s: Array, read: Array, step: float, span_s: float) -> Array:
    """(d4 y)^2 / 70 and the rate about it (2, readings) where an axis turns by more than a step of its encoder a row."""
    t_s, read = t_s[np.isfinite(read)], read[np.isfinite(read)]
    square = np.diff(read, 4) ** 2 / FOURTH
    rate = np.abs(rates(t_s, read, span_s))[2:-2]
    faster = rate * (t_s[4:] - t_s[:-4]) > 4.0 * step
    return np.stack([square[faster], rate[faster]])


def _likeliest(case: Case, hypothesis: Hypothesis, name: str) -> Hypothesis:
    tau_s = hypothesis.effects[name][case.library.effects[name].symbol(Role.LATENESS)]
    most_s = most_shown_s(case, case.library.bound.model.places.sensors[place_and_kind(name)[0]].output)
    if most_s == 0.0:
        return _with(case, hypothesis, name, 0.0)
    coarse = _tried(
        case,
        hypothesis,
        name,
        (0.0, *(share * tau_s for share in JITTER_SHARES if share * tau_s < most_s), most_s),
    )
    best = max(coarse, key=lambda jitter_s: coarse[jitter_s])
    found = coarse | _tried(case, hypothesis, name, [share * best for share in JITTER_FINELY])
    best = max(found, key=lambda jitter_s: found[jitter_s])
    return _with(case, hypothesis, name, best if found[best] > found[0.0] + decisions.TAKEN_IN else 0.0)


def _tried(case: Case, hypothesis: Hypothesis, name: str, values_s: Iterable[float]) -> dict[float, float]:
    """The log likelihood by jitter."""
    asked = sorted(set(values_s))
    return dict(zip(asked, likelihoods(case, [_with(case, hypothesis, name, value) for value in asked]), strict=True))


def _with(case: Case, hypothesis: Hypothesis, name: str, jitter_s: float) -> Hypothesis:
    values = {**hypothesis.effects[name], case.library.effects[name].symbol(Role.JITTER): jitter_s}
    return hypothesis.with_effects({**hypothesis.effects, name: values})
