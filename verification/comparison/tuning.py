"""What a controller's design leaves open, found by flying the plant that it is for: the same rule for all of them.

    minimise the mean of |elevation's error| + |azimuth's error| through TUNING (manoeuvres.py)

over the open numbers of both axes at once, within their ranges, by differential evolution (Storn and Price, J. Global Optimization 11,
1997) from a seed. The generated C flies, as float32, against the equations with their encoders; only its numbers change
from flight to flight.
"""

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from controllers.equations.designing import Points
from controllers.equations.equation_controller import EquationController
from controllers.equations.source import tunable_law
from controllers.equations.tuned import OpenNumber, Tunable
from records.errors import BadInput
from records.table import AXES
from sim.wiring import wiring
from verification.comparison.flights import WiredLaw, fly_plan
from verification.comparison.manoeuvres import TUNING
from verification.flown_law import FlownLaw

Array = NDArray[np.float64]

POPULATION = 6  # times the numbers that are open
GENERATIONS = 50  # some minutes on one core; on ce150_velagic the mean error is then 7.2 deg (pid) and 6.3 deg (fuzzy)
KEPT_DIGITS = 4  # of a number that is kept


class TunableLaw(FlownLaw):
    """A flown law whose gains may be set between flights."""

    declarations = FlownLaw.declarations + "void law_tune(uint32_t axis, const float *numbers);"

    def set_gains(self, axis: int, numbers: list[float]) -> None:
        """All numbers of one axis, as the controller's template takes them."""
        self._lib.law_tune(axis, self._ffi.new("float[]", numbers))


def tune(row: EquationController, points: Points, seed: int) -> dict[str, dict[str, float]]:
    """The open numbers by axis, to KEPT_DIGITS digits; raises BadInput where none is open."""
    tunable = row.tunable
    if tunable is None:
        remedy = "choose pid or fuzzy, or leave --tune out"
        raise BadInput(
            "--tune", f"controller {row.name!r}", "no number that its design leaves open", "one that has some", remedy
        )
    from scipy.optimize import differential_evolution  # half a second, which whoever flies another controller is spared

    bounds = _bounds(tunable)
    middle = tunable.table(points, _numbers(tunable, np.mean(bounds, axis=1)))
    wires = wiring(points.bound, middle.loops)
    law = TunableLaw(tunable_law(row.generate(middle), tunable.template), middle.loops, wires)
    wired = WiredLaw(law, middle.loops, wires)
    plan = TUNING.manoeuvre(points.bound, points.settings.sample_period_s)

    def cost(x: Array) -> float:
        for index, axis in enumerate(tunable.table(points, _numbers(tunable, x)).axes):
            law.set_gains(index, tunable.flat(axis.gains))
        flown = fly_plan(points.bound, wired, plan)[0]
        error_rad = float(np.mean(np.sum(np.abs(flown.reference_rad - flown.y_rad), axis=1)))
        return error_rad if math.isfinite(error_rad) else math.inf

    found = differential_evolution(
        cost, bounds, rng=seed, popsize=POPULATION, maxiter=GENERATIONS, tol=0.0, polish=False
    )
    return _numbers(tunable, found.x)


def _each(tunable: Tunable) -> list[tuple[str, OpenNumber]]:
    return [(axis, number) for axis in AXES for number in tunable.open[axis]]


def _bounds(tunable: Tunable) -> list[tuple[float, float]]:
    return [
        (entry.low, entry.high) if entry.linear else (math.log(entry.low), math.log(entry.high))
        for _, entry in _each(tunable)
    ]


def _numbers(tunable: Tunable, x: Array) -> dict[str, dict[str, float]]:
    """The numbers at a point of the search, as a plant file will state them."""
    found: dict[str, dict[str, float]] = {axis: {} for axis in AXES}
    for (axis, entry), value in zip(_each(tunable), x.tolist(), strict=True):
        found[axis][entry.name] = float(f"{value if entry.linear else math.exp(value):.{KEPT_DIGITS}g}")
    return found


def tuned_section(controller: str, numbers: Mapping[str, Mapping[str, float]]) -> str:
    """The numbers as the plant file has them."""
    return "\n".join(
        f"[design.tuned.{controller}.{axis}]\n" + "".join(f"{name} = {value!r}\n" for name, value in entries.items())
        for axis, entries in numbers.items()
    )
