"""The design at each operating point: equilibrium, linear plant, controller."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from design.both_axes import BothAxes
from design.direct_form import DeltaForm, to_delta
from design.discretise import sample
from design.linearise import linearise, subsystem
from design.loop import PlantPolynomials, plant_polynomials
from design.pole_placement import FREE_DEGREES, Placement, characteristic, place, poles_z
from design.refine import refined
from design.settings import AxisSettings, DesignSettings
from design.transfer import TransferFunction, transfer_function
from records.table import AXES
from sim.bind import BoundPlant
from sim.equilibrium import OperatingPoint, equilibrium

Array = NDArray[np.float64]


@dataclass(frozen=True)
class PointDesign:
    """The controller of one axis at one elevation, with the sampled plant that it was made for."""

    plant: PlantPolynomials
    transfer: TransferFunction
    placement: Placement
    delta: DeltaForm


def grid(settings: DesignSettings) -> Array:
    """The elevations Psi_0 [rad], (points,), of the operating points, evenly spread over the schedule's range."""
    return np.linspace(settings.psi_min_rad, settings.psi_max_rad, settings.operating_points)


def equilibria(bound: BoundPlant, psi_rad: Array) -> tuple[OperatingPoint, ...]:
    """Eq (16) at each elevation; raises BadInput naming the angle and the input that would leave its limits."""
    return tuple(equilibrium(bound, float(psi)) for psi in psi_rad)


@dataclass(frozen=True)
class DesignPoints(BothAxes[tuple[PointDesign, ...]]):
    """Equilibria (points,) over the schedule's range and the controllers made for each of them."""

    psi_rad: Array
    equilibria: tuple[OperatingPoint, ...]
    elevation: tuple[PointDesign, ...]
    azimuth: tuple[PointDesign, ...]


def design_points(bound: BoundPlant, settings: DesignSettings) -> DesignPoints:
    """Design both axes at each operating point; raises BadInput naming angle and axis where that is not possible."""
    psi_rad = grid(settings)
    points = equilibria(bound, psi_rad)
    elevation, azimuth = (
        tuple(design_point(bound, point, axis, settings.axis(axis), settings.sample_period_s) for point in points)
        for axis in AXES
    )
    return DesignPoints(psi_rad, points, elevation, azimuth)


def design_point(
    bound: BoundPlant, point: OperatingPoint, axis: str, wishes: AxisSettings, sample_period_s: float
) -> PointDesign:
    """The controller of `axis` at `point`; raises BadInput naming axis and angle when eq (26) cannot be used there."""
    where = f"{axis} at psi = {math.degrees(point.psi_rad):.1f} deg"
    linear = subsystem(bound, linearise(bound, point), axis)
    transfer = transfer_function(linear, sample_period_s, where)
    return placed(transfer, plant_polynomials(sample(linear, sample_period_s)), wishes, where)


def placed(transfer: TransferFunction, plant: PlantPolynomials, wishes: AxisSettings, where: str) -> PointDesign:
    """Eq (26) solved for one sampled plant, given in powers of z^-1 and of gamma; raises BadInput naming `where` (see place)."""
    wanted = characteristic(poles_z(wishes.placed_rad_s, plant.sample_period_s))
    placement = place(transfer.b, transfer.a, wanted, FREE_DEGREES[wishes.free_degree], where)
    return PointDesign(plant, transfer, placement, exact_delta(plant, placement, wishes))


def exact_delta(plant: PlantPolynomials, placement: Placement, wishes: AxisSettings) -> DeltaForm:
    """The delta form to rounding, in which the coefficient that the free degree makes zero is zero to the last bit."""
    free_degree = wishes.free_degree
    delta = refined(plant, to_delta(placement.controller), wishes.placed_rad_s, FREE_DEGREES[free_degree])
    if free_degree == "integral":
        return DeltaForm(delta.q, np.append(0.0, delta.p[1:]))
    if free_degree == "q3_zero":
        return DeltaForm(np.append(delta.q[:3], 0.0), delta.p)
    return delta
