"""A fit with less process noise than the innovations say: what an effect does over a second then shows against it.

Where an effect is missing, process noise takes its place: a filter that expects any motion follows the readings, and
its innovations no longer
tell one effect from another. Under low process noise the missing effect's own signature stands out.
"""

from dataclasses import replace

import numpy as np

from diagnosis import decisions
from diagnosis.fit.gauss_newton import Fit, fit
from diagnosis.fit.process_noise import process_noise_of
from diagnosis.hypothesis.case import Case

LOWERED_FIRST_STEP = 0.6


def with_low_process_noise(case: Case, found: Fit) -> Fit | None:
    """The fit anew under low process noise; None where it is low already or the plant cannot follow its logs then."""
    process_noise = found.hypothesis.process_noise.copy()
    for place, level in enumerate(_lowest(case)):
        process_noise[place] = min(process_noise[place], max(level, process_noise[place] - decisions.LOWEST_NOISE))
    if np.max(found.hypothesis.process_noise - process_noise, initial=0.0) < decisions.LEAST_LOWERED:
        return None
    return fit(case, replace(found.hypothesis, process_noise=process_noise), rounds=4)


def with_own_process_noise(case: Case, found: Fit) -> Fit | None:
    """A fit found under low process noise with the process noise that its innovations show."""
    return fit(case, process_noise_of(case, found, LOWERED_FIRST_STEP), rounds=3)


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
