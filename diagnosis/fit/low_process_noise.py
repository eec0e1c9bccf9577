"""A fit whose air is held calmer than the innovations say: what an effect does over a second then shows against it.

Where an effect is missing, unrest takes its place: a filter that expects any motion follows the readings, and its innovations no longer
tell one effect from another. Under calm air the missing effect's own signature stands out.
"""

from dataclasses import replace

import numpy as np

from diagnosis.fit.gauss_newton import Fit, fit
from diagnosis.fit.process_noise import unrest_of
from diagnosis.hypothesis.case import Case

FARTHEST = 2.0  # decades that the unrest is lowered at most
LEAST = 0.3  # and at least, for a second look to be worth its time
FIRST_STEP = 0.6


def calmed(case: Case, found: Fit) -> Fit | None:
    """The fit anew under calm air; None where the air is calm already or the plant cannot follow its logs then."""
    unrest = found.supposed.unrest.copy()
    for place, level in enumerate(_calm(case)):
        unrest[place] = min(unrest[place], max(level, unrest[place] - FARTHEST))
    if np.max(found.supposed.unrest - unrest, initial=0.0) < LEAST:
        return None
    return fit(case, replace(found.supposed, unrest=unrest), rounds=4)


def awake(case: Case, found: Fit) -> Fit | None:
    """A fit found under calm air with the unrest that its innovations show."""
    return fit(case, unrest_of(case, found, FIRST_STEP), rounds=3)


def _calm(case: Case) -> list[float]:
    """The unrest (log10) of each axis that moves it in a second as far as one reading of it is uncertain: q 1 s^3 / 12 = r."""
    model, levels = case.kit.bound.model, []
    for axis in model.axes:
        read = [name for name, output in model.outputs.items() if output == axis.position]
        r = min(
            (flight.tape.single[case.kit.outputs.index(name)] for name in read for flight in case.flights),
            default=np.inf,
        )
        levels.append(0.5 * float(np.log10(12.0 * r)))
    return levels
