"""From a plant and wishes to a controller table and the report on it: the entry of the design stage."""

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from design.operating_points import PointDesign, design_point, equilibria, grid
from design.schedule import fit, fit_error, fit_schedule
from design.settings import AXES, AxisSettings, DesignSettings
from records.plant import plant_text
from records.table import AxisLaw, ControllerTable
from sim.bind import BoundPlant
from sim.equilibrium import OperatingPoint

LIMITS = {"elevation": ("u_min", "u_max"), "azimuth": ("uT_min", "uT_max")}
SENSORS = {"elevation": "psi_rad", "azimuth": "phi_rad"}


def make_table(bound: BoundPlant, settings: DesignSettings) -> ControllerTable:
    """The table for `settings`, not yet judged; raises BadInput where a point cannot be reached or designed for."""
    points = equilibria(bound, grid(settings))
    designs = {axis: _designs(bound, points, axis, settings) for axis in AXES}
    return ControllerTable(
        plant=bound.plant.name,
        sample_period_s=settings.sample_period_s,
        psi_min_rad=settings.psi_min_rad,
        psi_max_rad=settings.psi_max_rad,
        elevation=_axis_law(bound, settings, "elevation", points, designs["elevation"]),
        azimuth=_axis_law(bound, settings, "azimuth", points, designs["azimuth"]),
        origin=_origin(bound, settings, points, designs),
    )


def _designs(
    bound: BoundPlant, points: Sequence[OperatingPoint], axis: str, settings: DesignSettings
) -> tuple[PointDesign, ...]:
    wishes: AxisSettings = getattr(settings, axis)
    return tuple(design_point(bound, point, axis, wishes, settings.sample_period_s) for point in points)


def _axis_law(
    bound: BoundPlant,
    settings: DesignSettings,
    axis: str,
    points: Sequence[OperatingPoint],
    designs: Sequence[PointDesign],
) -> AxisLaw:
    wishes: AxisSettings = getattr(settings, axis)
    psi_rad = grid(settings)
    schedule = fit_schedule(psi_rad, [design.delta for design in designs], settings.coefficient_degree)
    voltages_V = np.array([point.u0[AXES.index(axis)] for point in points])
    u_min_V, u_max_V = (bound.parameter(name) for name in LIMITS[axis])
    return AxisLaw(
        q_V_rad=schedule.q,
        p=schedule.p,
        a=observer(wishes.observer_pole),
        feedforward_V=fit(psi_rad, voltages_V, settings.feedforward_degree),
        prefilter_time_constant_s=wishes.prefilter_time_constant_s,
        u_min_V=u_min_V,
        u_max_V=u_max_V,
        u_safe_V=min(max(0.0, u_min_V), u_max_V),
        reference_min_rad=wishes.reference_min_rad,
        reference_max_rad=wishes.reference_max_rad,
        resolution_rad=bound.plant.sensors[SENSORS[axis]],
    )


def observer(pole: float) -> tuple[float, float, float]:
    """a_0, a_1, a_2 of A = (1 - pole z^-1)^3 = 1 - z^-1 [(1 - a_0) + a_1 delta + a_2 delta^2]."""
    return (1.0 - pole) ** 3, 3.0 * pole**2 - 2.0 * pole**3, pole**3


def _origin(
    bound: BoundPlant,
    settings: DesignSettings,
    points: Sequence[OperatingPoint],
    designs: Mapping[str, Sequence[PointDesign]],
) -> dict[str, Any]:
    """Plain lists and numbers from which each coefficient of the table can be traced to its operating point."""
    return {
        "plant_digest": hashlib.sha256(plant_text(bound.plant).encode()).hexdigest(),
        "model": bound.model.name,
        "coefficient_degree": settings.coefficient_degree,
        "feedforward_degree": settings.feedforward_degree,
        "operating_points": [
            {"psi_rad": float(point.psi_rad), "x0": _plain(point.x0), "u0_V": _plain(point.u0)} for point in points
        ],
        **{axis: _axis_origin(settings, axis, designs[axis]) for axis in AXES},
    }


def _axis_origin(settings: DesignSettings, axis: str, designs: Sequence[PointDesign]) -> dict[str, Any]:
    wishes: AxisSettings = getattr(settings, axis)
    deltas = [design.delta for design in designs]
    error = fit_error(grid(settings), deltas, fit_schedule(grid(settings), deltas, settings.coefficient_degree))
    return {
        "poles_rad_s": [[pole.real, pole.imag] for pole in wishes.poles_rad_s],
        "free_degree": wishes.free_degree,
        "observer_pole": wishes.observer_pole,
        "fit_error": asdict(error),
        "b": [_plain(design.transfer.b) for design in designs],
        "a": [_plain(design.transfer.a) for design in designs],
        "q_V_rad": [_plain(design.delta.q) for design in designs],
        "p": [_plain(design.delta.p) for design in designs],
    }


def _plain(values: Sequence[float] | np.ndarray[Any, Any]) -> list[float]:
    return [float(value) for value in values]
