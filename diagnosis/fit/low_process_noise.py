"""A fit with less process noise than the innovations say: what an effect does over a second then shows against it.

Where an effect is missing, process noise takes its place: a filter that expects any motion follows the readings, and
its innovations no longer
tell one effect from another. Under low process noise the missing effect's own signature stands out.
"""

import numpy as np

from diagnosis import decisions
from diagnosis.fit.gauss_newton import Fit, fit
from diagnosis.fit.process_noise import with_process_noise
from diagnosis.hypothesis.case import Case, beginning_of
from diagnosis.hypothesis.hypothesis import scaled

LOWERED_FIRST_STEP = 0.6


def with_low_process_noise(case: Case, found: Fit) -> Fit | None:
    """The fit anew under low process noise; None where it is low already or the plant cannot follow its logs then."""
    lowered = found.hypothesis
    for axis, level in enumerate(_lowest(case)):
        now = float(lowered.process_noise[axis])
        lowered = scaled(case, lowered, axis, min(now, max(level, now - decisions.LOWEST_NOISE)))
    if np.max(found.hypothesis.process_noise - lowered.process_noise, initial=0.0) < decisions.LEAST_LOWERED:
        return None
    return fit(case, lowered, rounds=4)


def with_own_process_noise(case: Case, found: Fit) -> Fit | None:
    """A fit found under low process noise with the process noise that its innovations show."""
    noisy = with_process_noise(beginning_of(case), found.hypothesis, LOWERED_FIRST_STEP)
    return fit(case, noisy, rounds=3)


def _lowest(case: Case) -> list[float]:
    """The process noise (log10) of each axis that moves it in a second as far as one reading of it is uncertain: q 1 s^3 / 12 = r."""
    model, levels = case.library.bound.model, []
    for axis in model.axes:
        read = [name for name, output in model.outputs.items() if output == axis.position]
        r = min(
            (flight.filter_input.single[case.library.outputs.index(name)] for name in read for flight in case.flights),
            default=np.inf,
        )
        levels.append(0.5 * float(np.log10(12.0 * r)))
    return levels
