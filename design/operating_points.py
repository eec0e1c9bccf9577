"""The design at each operating point: equilibrium, linear plant, controller."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from design.direct_form import DeltaForm, to_delta
from design.discretise import extended, sample
from design.linearise import linearise, subsystem
from design.loop import PlantPolynomials, plant_polynomials
from design.obstacles import advice
from design.pole_placement import (
    FREE_DEGREES,
    INTEGRAL,
    Placement,
    characteristic,
    demand_usable,
    placed_in_gamma,
    placed_in_z,
    poles_z,
    refined,
)
from design.settings import AxisSettings, DesignSettings
from design.transfer import TransferFunction, transfer_function
from records.errors import BadInput
from records.loops import Loop
from sim.bind import BoundPlant
from sim.equilibrium import OperatingPoint, rest_with
from sim.wiring import wiring

Array = NDArray[np.float64]


@dataclass(frozen=True)
class PointDesign:
    """The controller of one axis at one elevation, with the sampled plant that it was made for."""

    plant: PlantPolynomials
    transfer: TransferFunction
    placement: Placement
    delta: DeltaForm


def grid(settings: DesignSettings) -> Array:
    """The scheduling angles Psi_0 [rad], (points,), of the operating points, evenly spread over the range; 0 alone without a schedule."""
    if settings.schedule is None:
        return np.zeros(1)
    return np.linspace(settings.schedule.min_rad, settings.schedule.max_rad, settings.operating_points)


def rest(bound: BoundPlant, settings: DesignSettings, psi_rad: float) -> OperatingPoint:
    """Eq (16) with the scheduling axis at this angle and every other one where its loop rests, those without a loop at 0; of a plant that
    has no position at all with all that its loops measure there.

    Raises BadInput naming value and input beyond its limits.
    """
    scheduling = "" if settings.schedule is None else settings.schedule.axis
    has_position = any(axis.position is not None for axis in bound.model.axes)
    rests_at = _rests_at if has_position else _middle
    values = {axis.axis: psi_rad if axis.axis == scheduling else rests_at(axis) for axis in settings.axes}
    if has_position:
        values = {name: value for name, value in values.items() if name == scheduling or value != 0.0}
    loops = tuple(loop for loop in settings.loops if loop.axis in values)
    places, driven = wiring(bound, loops).outputs, wiring(bound, settings.loops).inputs
    return rest_with(bound, places, [values[loop.axis] for loop in loops], driven)


def _rests_at(axis: AxisSettings) -> float:
    """0 where the loop's references reach it, else their middle: a ball below its magnet is never at the magnet."""
    return 0.0 if axis.reference_min_rad <= 0.0 <= axis.reference_max_rad else _middle(axis)


def _middle(axis: AxisSettings) -> float:
    return 0.5 * (axis.reference_min_rad + axis.reference_max_rad)


def equilibria(bound: BoundPlant, settings: DesignSettings, psi_rad: Array) -> tuple[OperatingPoint, ...]:
    """`rest` at each scheduling angle."""
    return tuple(rest(bound, settings, float(psi)) for psi in psi_rad)


def rest_V(bound: BoundPlant, equilibria: Sequence[OperatingPoint], loop: Loop) -> Array:
    """The loop's voltage at each operating point, (points,)."""
    column = [symbol.name for symbol in bound.model.inputs].index(loop.input)
    return np.array([point.u0[column] for point in equilibria])


@dataclass(frozen=True)
class DesignPoints:
    """Equilibria (points,) over the schedule's range and the controllers made for each of them, by loop."""

    psi_rad: Array
    equilibria: tuple[OperatingPoint, ...]
    axes: tuple[tuple[PointDesign, ...], ...]


def design_points(
    bound: BoundPlant, settings: DesignSettings, points: tuple[OperatingPoint, ...] | None = None
) -> DesignPoints:
    """Design all axes at each operating point; raises BadInput naming angle and axis where that is not possible.

    `points` are the plant's equilibria over the grid, where somebody has them: other poles leave them where they are.
    """
    psi_rad = grid(settings)
    points = equilibria(bound, settings, psi_rad) if points is None else points
    axes = tuple(
        tuple(
            design_point(bound, point, settings, settings.axis(loop.axis), float(psi))
            for psi, point in zip(psi_rad, points, strict=True)
        )
        for loop in settings.loops
    )
    return DesignPoints(psi_rad, points, axes)


def design_point(
    bound: BoundPlant, point: OperatingPoint, settings: DesignSettings, wishes: AxisSettings, psi_rad: float
) -> PointDesign:
    """The controller of one axis at `point`; raises BadInput naming axis and angle when eq (26) cannot be used there."""
    where = settings.place(wishes.axis, psi_rad)
    linear = subsystem(bound, linearise(bound, point), settings.loop(wishes.axis), settings.loops)
    transfer = transfer_function(linear, settings.sample_period_s, where)
    plant, exact = (plant_polynomials(sample(of, settings.sample_period_s)) for of in (linear, extended(linear)))
    return placed(transfer, plant, wishes, where, exact)


def placed(
    transfer: TransferFunction,
    plant: PlantPolynomials,
    wishes: AxisSettings,
    where: str,
    exact: PlantPolynomials | None = None,
) -> PointDesign:
    """Eq (26) solved for one sampled plant, given in powers of z^-1 and of gamma, there perhaps in extended precision too; raises
    BadInput naming `where` (see place)."""
    states, poles = len(plant.a) - 1, len(wishes.poles_rad_s)
    if poles != 2 * states:
        raise BadInput(
            "poles", where,
            f"{poles} poles of a loop of {states} state{'s' * (states > 1)} that its input moves and its output shows",
            f"{2 * states} poles",
            f"give plant and controller {states} each in poles_rad_s",
        )  # fmt: skip
    wanted, free = characteristic(poles_z(wishes.placed_rad_s, plant.sample_period_s)), FREE_DEGREES[wishes.free_degree]
    placement = placed_in_z(transfer.b, transfer.a, wanted, free)
    if not placement.is_sound:
        placement = placed_in_gamma(plant, wishes.placed_rad_s, free)
    try:
        demand_usable(placement, where)
    except BadInput as refusal:
        raise replace(refusal, remedy=advice(plant, integrates=wishes.free_degree == INTEGRAL)) from None
    return PointDesign(plant, transfer, placement, exact_delta(exact or plant, placement, wishes))


def exact_delta(plant: PlantPolynomials, placement: Placement, wishes: AxisSettings) -> DeltaForm:
    """The delta form to rounding, in which the coefficient that the free degree makes zero is zero to the last bit."""
    free_degree = wishes.free_degree
    delta = refined(plant, to_delta(placement.controller), wishes.placed_rad_s, FREE_DEGREES[free_degree])
    if free_degree == INTEGRAL:
        return DeltaForm(delta.q, np.append(0.0, delta.p[1:]))
    if free_degree == "q3_zero":
        return DeltaForm(np.append(delta.q[:-1], 0.0), delta.p)
    return delta
