"""How large an effect has to be for a wanted severity: trials on short runs."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.random import Generator

from blind.cases.injection import Injected, coarse_rad, fly_with_shadows, loss, within_range
from blind.cases.severity import severity
from blind.effects.effect import Effect, Shape
from blind.rigs.bench import Bench
from blind.simulation.record import Record

TRIALS = 5
CONTENT_FROM = 4  # attempts after which an effect is taken as it comes
SHOWN_FROM = 12  # attempts after which one of several effects need not show where the bench asks for it


def sized(bench: Bench, effect: Effect, target: float, rng: Generator, attempt: int) -> Injected | None:
    """The effect with the size that gives about `target` alone on a short run; None when no size flies or comes near.

    Late attempts take the nearest there is: some effects cannot be severe in a quiet run.
    """
    shape = effect.draw(rng)
    trial_seed = int(rng.integers(2**32))
    low, high = effect.bounds
    m, best, miss = 1.0, None, np.inf
    for _ in range(TRIALS):
        entry = _tried(bench, effect, m, shape, trial_seed)
        if entry is None:
            high, m = m, max(low, 0.4 * m)
            continue
        ratio = max(entry.trial_severity, 1e-6) / target
        if abs(np.log(ratio)) < miss:
            best, miss = entry, abs(float(np.log(ratio)))
        top = high if high == effect.bounds[1] else 0.8 * high
        after = float(np.clip(m * np.clip(1.0 / ratio, 0.05, 20.0), low, top))
        if miss < 0.15 or after == m:
            break
        m = after
    return best if miss < np.log(2.0) or attempt >= CONTENT_FROM else None


def as_expected(bench: Bench, injected: Sequence[Injected], records: Sequence[Record], attempt: int) -> bool:
    """Whether the training runs came out about as severe as the trials: one hit on a stop can make an effect look huge."""
    if not injected:
        return True
    found = severity(bench.nominal, records, 1, coarse_rad(injected, len(bench.columns.outputs)))
    expected = float(np.sqrt(sum(entry.trial_severity**2 for entry in injected)))
    if bench.each_shows and attempt < SHOWN_FROM and not _each_shows(bench, injected, records):
        return False
    return found <= 4.0 * expected and (found >= 0.25 * expected or attempt >= CONTENT_FROM)


def _each_shows(bench: Bench, injected: Sequence[Injected], records: Sequence[Record]) -> bool:
    """Whether each of several effects, in these logs, is a fourth of what it was in its trial: its axis may be held, or stick."""
    outputs = len(bench.columns.outputs)
    return len(injected) == 1 or all(
        severity(bench.nominal, records, 2 + i, coarse_rad([entry], outputs)) >= 0.25 * entry.trial_severity
        for i, entry in enumerate(injected)
    )


def _tried(bench: Bench, effect: Effect, m: float, shape: Shape, seed: int) -> Injected | None:
    """The effect with its severity on a short run; None when the rig did not stay in its range."""
    entry = Injected(effect, m, shape, 0.0)
    inputs = bench.lab.inputs(np.random.default_rng(seed), loss([entry]), None)
    record = fly_with_shadows(bench, [entry], inputs)
    if not within_range(record):
        return None
    coarse = coarse_rad([entry], len(bench.columns.outputs))
    return replace(entry, trial_severity=severity(bench.nominal, [record], 1, coarse))
