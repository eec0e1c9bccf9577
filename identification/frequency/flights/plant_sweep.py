"""Sweeps of a plant of this project under its own controller: on the references, as a real rig can be asked, or on the inputs."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from design.law import FloatLaw
from identification import thresholds
from identification.frequency.flights.sweep import Sweep, sweep_input
from records.errors import BadInput
from records.log import RunLog
from records.logs.sidecar import DOUBLE
from records.table import ControllerTable
from sim.bind import BoundPlant
from sim.equilibrium import rest_with
from sim.kernel.law import is_kernel_s
from sim.loop import Controller, Wired, fly, fly_law
from sim.manoeuvres import Manoeuvre, resting_outputs
from sim.wiring import wiring

Array = NDArray[np.float64]

BAND_RAD_S = (0.3, 10.0)  # of a loop as fast as the CE150's, see docs/seeds.md


def band_of(slowest_rad_s: float) -> tuple[float, float]:
    """The band [rad/s] for loops whose slowest pole is at -`slowest_rad_s`: as much slower as the loop is."""
    share = min(1.0, slowest_rad_s / thresholds.FAST_RAD_S)
    return share * BAND_RAD_S[0], share * BAND_RAD_S[1]


class SweptController:
    """A controller to whose commands a sweep is added, row by row; what is commanded stays within the plant's limits."""

    def __init__(self, controller: Controller, added: Array, limits: Array) -> None:
        self._controller, self._added, self._limits, self._row = controller, added, limits, 0

    def reset(self, *angles_rad: float) -> None:
        """Start anew."""
        self._controller.reset(*angles_rad)
        self._row = 0

    def step(self, *given_rad: float) -> tuple[float, ...]:
        """The controller's command and this row's sweep."""
        command = self._controller.step(*given_rad)
        swept = np.clip(np.add(command, self._added[self._row]), self._limits[:, 0], self._limits[:, 1])
        self._row += 1
        return tuple(swept.tolist())


def closed_loop_sweeps(
    bound: BoundPlant,
    table: ControllerTable,
    sweep: Sweep,
    rest_rad: float | None,
    amplitudes: Sequence[float],
    on: str,
) -> Mapping[str, RunLog]:
    """One record for each loop, swept about its rest; `on` "references" (amplitudes in rad) or "inputs" (in V), one a loop.

    Each loop rests in the middle of its references, the first at `rest_rad` where that is given. Raises BadInput for a sweep that leaves
    the controller's range or an angle where the plant cannot rest.
    """
    period_s = table.sample_period_s
    t_s = np.asarray(period_s * np.arange(round(sweep.duration_s / period_s) + 1), dtype=float)
    rest = np.array([0.5 * (axis.reference_min_rad + axis.reference_max_rad) for axis in table.axes])
    rest[0] = rest[0] if rest_rad is None else rest_rad
    wires = wiring(bound, table.loops)
    point = rest_with(bound, wires.outputs, rest.tolist(), wires.inputs)
    found = {}
    for place, loop in enumerate(table.loops):
        swept = np.zeros((t_s.size, len(rest)))
        swept[:, place] = sweep_input(sweep, t_s, amplitudes[place])
        references: Array = np.tile(resting_outputs(bound, point), (t_s.size, 1))
        references[:, list(wires.outputs)] = rest
        law: Controller = FloatLaw(table)
        if on == "references":
            _check_range(table, rest + swept, loop.axis)
            references[:, list(wires.outputs)] += swept
        else:
            law = SweptController(law, swept, _limits(table))
        plan = Manoeuvre(f"sweep {loop.axis}", t_s, references, point.x0)
        if on == "references" and is_kernel_s(table):
            found[f"sweep_{loop.axis}"] = fly_law(bound, table, plan)
        else:
            # With a sweep added behind it, the inputs are no longer the law's answers, which naming its table would promise.
            digest = table.digest if on == "references" else None
            log = fly(bound, Wired(law, wires), plan, table_digest=digest, arithmetic=DOUBLE)
            found[f"sweep_{loop.axis}"] = log
    return found


def _limits(table: ControllerTable) -> Array:
    return np.array([[axis.u_min_V, axis.u_max_V] for axis in table.axes])


def _check_range(table: ControllerTable, reference_rad: Array, name: str) -> None:
    for axis, column in zip(table.axes, reference_rad.T, strict=True):
        if column.min() < axis.reference_min_rad or column.max() > axis.reference_max_rad:
            got = f"{np.degrees(column.min()):.3g} to {np.degrees(column.max()):.3g} deg"
            least, most = np.degrees([axis.reference_min_rad, axis.reference_max_rad])
            raise BadInput(
                "amplitude", f"sweep of the {name}'s reference", got, f"within {least:.3g} to {most:.3g} deg",
                "sweep with less amplitude, or about another angle",
            )  # fmt: skip
