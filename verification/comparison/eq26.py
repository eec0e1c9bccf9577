"""Eq (26) solved in float32 at every elevation: how far the controllers found are from those in double precision.

Two forms. `plain` is the paper's, seven equations in powers of z^-1, helped where it can be: the plant's polynomials are computed in double
precision and only rounded, B is scaled to 1, the elimination pivots, P(1) = 0 is put right afterwards. `closed` is what the board does,
(C.14) to (C.23) from the plant's parameters on, all of it in float32.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from controllers.equations.frame import numbers_of
from controllers.instantaneous import EQUATIONS
from design.direct_form import DeltaForm, DirectForm, to_delta
from design.discretise import sample
from design.linearise import linearise, subsystem
from design.loop import closed_loop_poles, open_loop, plant_polynomials
from design.operating_points import design_point
from design.pole_placement import FREE_DEGREES, characteristic, poles_z, sylvester
from design.settings import AxisSettings, DesignSettings
from design.transfer import TransferFunction
from records.law_table import LawTable
from sim.bind import BoundPlant
from sim.equilibrium import equilibrium

Array = NDArray[np.float64]
ANGLES = 161
Solver = Callable[[TransferFunction, float], DeltaForm]


@dataclass(frozen=True)
class FormError:
    """One form and axis over the schedule's range.

    Largest relative error of any coefficient of Q and P in powers of delta, of Q(1) alone, and the closed loop's slowest pole [rad/s]
    at the angle where it is slowest (positive: unstable) and where it is fastest.
    """

    coefficients: float
    q_sum: float
    slowest_rad_s: float
    fastest_rad_s: float


def plain(settings: DesignSettings, axis: str) -> Solver:
    """The seven equations in float32."""
    wishes = settings.axis(axis)
    wanted = _single(characteristic(poles_z(wishes.poles_rad_s, settings.sample_period_s)))
    free = FREE_DEGREES[wishes.free_degree]

    def solve(transfer: TransferFunction, psi_rad: float) -> DeltaForm:
        a, b = _single(transfer.a), _single(transfer.b)
        scale, order = np.max(np.abs(b)), len(a) - 1
        rows = [
            *sylvester((b / scale).astype(float), a.astype(float), order),
            free.row(order, order + 1),
        ]  # exact: only single numbers are moved
        system = _single(np.array(rows))
        target = _single(np.append(wanted[1:] - np.append(a[1:], np.zeros(order)), free.value))
        solution = np.linalg.solve(system, target).astype(float)
        found = to_delta(DirectForm(q=solution[order:] / float(scale), p=np.append(1.0, solution[:order])))
        return DeltaForm(found.q, np.array([0.0, *found.p[1:]]))

    return solve


def closed(table: LawTable[Any], axis: str) -> Solver:
    """The board's arithmetic."""
    law = numbers_of(table, np.float32)
    numbers = law.axes[table.index(axis)]

    def solve(transfer: TransferFunction, psi_rad: float) -> DeltaForm:
        found = [float(value) for value in vars(EQUATIONS.placed(law, numbers, np.float32(psi_rad))).values()]
        return DeltaForm(np.array(found[:4]), np.array([0.0, *found[4:]]))

    return solve


def _range_rad(settings: DesignSettings) -> tuple[float, float]:
    assert settings.schedule is not None
    return settings.schedule.min_rad, settings.schedule.max_rad


def form_error(bound: BoundPlant, settings: DesignSettings, axis: str, solver: Solver) -> FormError:
    """One form over ANGLES elevations, against the design stage in double precision."""
    wishes = settings.axis(axis).without_roll_off
    rows = [
        _at(bound, psi_rad, settings, wishes, solver) for psi_rad in np.linspace(*_range_rad(settings), ANGLES).tolist()
    ]
    coefficients, sums, slowest = zip(*rows, strict=True)
    return FormError(max(coefficients), max(sums), max(slowest), min(slowest))


def form_errors(
    bound: BoundPlant, settings: DesignSettings, table: LawTable[Any]
) -> Mapping[tuple[str, str], FormError]:
    """Both forms of both axes, by form and axis, for the `instantaneous` controller's table."""
    errors = {}
    for axis in ("elevation", "azimuth"):
        errors["plain", axis] = form_error(bound, settings, axis, plain(settings, axis))
        errors["closed", axis] = form_error(bound, settings, axis, closed(table, axis))
    return errors


def _at(
    bound: BoundPlant, psi_rad: float, settings: DesignSettings, wishes: AxisSettings, solver: Solver
) -> tuple[float, float, float]:
    """Errors of coefficients and Q(1), and the slowest pole, at one angle."""
    point = equilibrium(bound, psi_rad)
    exact = design_point(bound, point, settings, wishes, psi_rad)
    found = solver(exact.transfer, psi_rad)
    apart = np.abs(np.append(found.q / exact.delta.q, found.p[1:] / exact.delta.p[1:]) - 1.0)
    part = subsystem(bound, linearise(bound, point), settings.loop(wishes.axis))
    plant = plant_polynomials(sample(part, settings.sample_period_s))
    poles = closed_loop_poles(open_loop(plant, found))
    return float(np.max(apart)), float(apart[0]), float(np.max(poles.real))


def _single(values: Array) -> NDArray[np.float32]:
    return np.asarray(values, dtype=np.float32)
