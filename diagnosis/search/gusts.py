"""Whether what is missing is coloured noise: a gust on an axis, by maximum likelihood, beside the plant alone.

A gust follows any readings, so it explains a part of whatever is missing. It is tried where nothing else explains the logs well: an
effect of the library that is there explains them better, and what depends on the rig's motion is left to forms beside it (weigh.py).
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from diagnosis import decisions
from diagnosis.fit.evidence import FittedHypothesis, as_fitted
from diagnosis.fit.gauss_newton import fit
from diagnosis.fit.process_noise import with_process_noise
from diagnosis.fit.profile_likelihood import likeliest, likelihoods
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import Hypothesis
from sim.effect import Effect, Role

FACTORS = (2.0, 1.4, 1.15)  # by which size and time are then tried apart
GUST_ROUNDS = 4
REACH = 1.2  # a factor of size and time over which the likelihood's bend is taken


def gusts(case: Case, nominal: FittedHypothesis) -> list[FittedHypothesis]:
    """The plant with a gust on each axis that moves, for those that can be fitted."""
    held = set.intersection(*(set(flight.locked) for flight in case.flights))
    free = [case.library.effects[name] for name in case.library.noises if case.library.effects[name].place not in held]
    return [found for gust in free if (found := _fitted(case, nominal, gust)) is not None]


def gust_sd(case: Case, hypothesis: Hypothesis, gust: Effect) -> dict[str, float]:
    """What is known of a gust's size and time (one standard deviation of each), by how the likelihood bends over a factor of REACH to all
    sides, with each known to a factor of e before."""
    v = np.reshape(likelihoods(case, list(_about(hypothesis, gust, REACH))), (3, 3))
    bends = v[1, 0] + v[2, 0] - 2.0 * v[0, 0], v[0, 1] + v[0, 2] - 2.0 * v[0, 0]
    both = 0.25 * (v[1, 1] + v[2, 2] - v[1, 2] - v[2, 1])
    curvature = -np.nan_to_num([[bends[0], both], [both, bends[1]]]) / np.log(REACH) ** 2
    values, vectors = np.linalg.eigh(curvature)
    relative = np.sqrt(vectors**2 @ (1.0 / (1.0 + np.maximum(values, 0.0))))
    symbols = (gust.symbol(Role.STRENGTH), gust.symbol(Role.MEMORY))
    return {
        symbol: float(share * hypothesis.effects[gust.name][symbol])
        for symbol, share in zip(symbols, relative, strict=True)
    }


def _fitted(case: Case, nominal: FittedHypothesis, gust: Effect) -> FittedHypothesis | None:
    hypothesis, axis = nominal.fit.hypothesis, gust.place
    process_noise = hypothesis.process_noise.copy()
    process_noise[[entry.name for entry in case.library.bound.model.axes].index(axis)] -= decisions.GUST_LOWERS_NOISE
    size = case.library.bound.model.places.axes[axis].torque_size
    low_noise = replace(hypothesis, process_noise=process_noise)
    starts = [
        _with(low_noise, gust, share * size, T) for T in decisions.GUST_TIMES_S for share in decisions.GUST_SHARES
    ]
    start, _ = likeliest(case, starts)
    for factor in FACTORS:
        start, _ = likeliest(case, list(_about(with_process_noise(case, start), gust, factor)))
    found = fit(case, start, rounds=GUST_ROUNDS)
    return None if found is None else as_fitted(case, found)


def _with(hypothesis: Hypothesis, gust: Effect, size: float, time_s: float) -> Hypothesis:
    given = {gust.symbol(Role.STRENGTH): size, gust.symbol(Role.MEMORY): time_s}
    bounds = gust.parameter
    values = {name: float(np.clip(value, bounds[name].lower, bounds[name].upper)) for name, value in given.items()}
    return hypothesis.with_effects({**hypothesis.effects, gust.name: values})


def _about(hypothesis: Hypothesis, gust: Effect, factor: float) -> Iterator[Hypothesis]:
    """The same, and with size and time larger and smaller by a factor, alone and together."""
    values = hypothesis.effects[gust.name]
    size, time_s = values[gust.symbol(Role.STRENGTH)], values[gust.symbol(Role.MEMORY)]
    for by_size in (1.0, factor, 1.0 / factor):
        for by_time in (1.0, factor, 1.0 / factor):
            yield _with(hypothesis, gust, by_size * size, by_time * time_s)
