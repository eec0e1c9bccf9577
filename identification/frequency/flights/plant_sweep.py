"""Sweeps of a plant of this project under its own controller: on the references, as a real rig can be asked, or on the inputs."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from design.law import FloatLaw
from identification.frequency.flights.sweep import Sweep, sweep_input
from records.errors import BadInput
from records.log import RunLog
from records.table import ControllerTable
from sim.bind import BoundPlant
from sim.equilibrium import equilibrium
from sim.loop import Controller, fly, fly_law
from sim.manoeuvres import Manoeuvre

Array = NDArray[np.float64]


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
    bound: BoundPlant, table: ControllerTable, sweep: Sweep, psi_rad: float, amplitudes: tuple[float, float], on: str
) -> Mapping[str, RunLog]:
    """One record for each axis, swept about its rest at `psi_rad`; `on` "references" (amplitudes in rad) or "inputs" (in V).

    Raises BadInput for a sweep that leaves the controller's range or an angle where the plant cannot rest.
    """
    period_s = table.sample_period_s
    t_s = np.asarray(period_s * np.arange(round(sweep.duration_s / period_s) + 1), dtype=float)
    x0 = equilibrium(bound, psi_rad).x0
    found = {}
    for axis, name in enumerate(("elevation", "azimuth")):
        swept = np.zeros((t_s.size, 2))
        swept[:, axis] = sweep_input(sweep, t_s, amplitudes[axis])
        held = np.tile([psi_rad, 0.0], (t_s.size, 1))
        if on == "references":
            _check_range(table, held + swept, name)
            found[f"sweep_{name}"] = fly_law(bound, table, Manoeuvre(f"sweep {name}", t_s, held + swept, x0))
        else:
            controller = SweptController(FloatLaw(table), swept, _limits(table))
            flown = Manoeuvre(f"sweep {name}", t_s, held, x0)
            found[f"sweep_{name}"] = fly(bound, controller, flown, table_digest=table.digest)
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
