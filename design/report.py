"""What is known of a table: fit, pole migration, margins over the elevation, and both loops closed together."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.polynomial.polynomial import polyval
from numpy.typing import NDArray

from design.both_axes import BothAxes
from design.coupled import coupled_poles
from design.direct_form import DeltaForm
from design.discretise import sample
from design.linearise import LinearPlant, linearise, subsystem
from design.loop import PlantPolynomials, Poles, controller_poles, open_loop, plant_polynomials
from design.margins import Margins, margins
from design.migration import Migration, ScheduledAxis, SlowestPole, migrations, pole_map, slowest_of
from design.operating_points import DesignPoints, equilibria
from design.rounding import FLOAT32, Rounding
from design.schedule import FitError, Schedule, evaluate, fit_error, schedule_of
from design.settings import DesignSettings
from records.table import AXES, ControllerTable, Polynomial
from sim.bind import BoundPlant

Array = NDArray[np.float64]

ANGLES_BETWEEN = 200


@dataclass(frozen=True, eq=False)
class AxisReport:
    """One axis over the angles psi_rad of the report.

    `poles_fitted_rad_s` and `poles_flown_rad_s` have shape (angles, poles); `margins` and `controller_radius`, the largest |z| of the
    controller's own poles, belong to the table as its arithmetic rounds it, as it flies. `largest_q_V_rad` is that of eq (22).
    `designs` and `operating_V` (points,) are the feedback and the voltage at each operating point, `schedule` and `feedforward_V` the
    polynomials fitted to them.
    """

    axis: str
    poles_rad_s: tuple[complex, ...]
    free_degree: str
    largest_q_V_rad: float
    condition: float
    fit_error: FitError
    feedforward_error_V: float
    designs: tuple[DeltaForm, ...]
    operating_V: Array
    schedule: Schedule
    feedforward_V: Polynomial
    poles_fitted_rad_s: Poles
    poles_flown_rad_s: Poles
    designed_slowest_rad_s: float
    after_fit: SlowestPole
    after_rounding: SlowestPole
    migrations: tuple[Migration, ...]
    margins: tuple[Margins, ...]
    controller_radius: tuple[float, ...]

    @property
    def worst_margins(self) -> Margins:
        """The worst of each margin over all angles; they need not come from the same angle."""
        return Margins(
            sensitivity=max(m.sensitivity for m in self.margins),
            gain_up=min(m.gain_up for m in self.margins),
            gain_down=max(m.gain_down for m in self.margins),
            phase_rad=min(m.phase_rad for m in self.margins),
            delay_s=min(m.delay_s for m in self.margins),
            crossover_rad_s=max(m.crossover_rad_s for m in self.margins),
        )


@dataclass(frozen=True, eq=False)
class DesignReport(BothAxes[AxisReport]):
    """Both axes over the elevations psi_rad (angles,): the operating points and at least 200 angles between them.

    points_rad (points,) are the operating points alone. `arithmetic` is that of the law that flies; `coupled_slowest_rad_s` (angles,) is
    the slowest pole of both its loops closed on the whole plant, and `coupled` its worst.
    """

    arithmetic: str
    psi_rad: Array
    points_rad: Array
    elevation: AxisReport
    azimuth: AxisReport
    coupled_slowest_rad_s: Array
    coupled: SlowestPole

    def pole_entries(self) -> list[dict[str, Any]]:
        """The entries `poles` of verification.json: designed poles against those that fly, per axis."""
        return [
            {
                "axis": axis.axis,
                "designed_slowest_rad_s": axis.designed_slowest_rad_s,
                "worst_slowest_rad_s": axis.after_rounding.worst_rad_s,
                "at_psi_rad": axis.after_rounding.at_psi_rad,
                "stable": axis.after_rounding.stable,
            }
            for axis in (self.elevation, self.azimuth)
        ]


def make_report(
    bound: BoundPlant,
    settings: DesignSettings,
    table: ControllerTable,
    points: DesignPoints,
    rounding: Rounding = FLOAT32,
) -> DesignReport:
    """Examine `table`, flown as `rounding` makes it, at the operating points and between them.

    Raises BadInput where an angle cannot be held at rest.
    """
    psi_rad = angles(points.psi_rad)
    linear = tuple(linearise(bound, point) for point in equilibria(bound, psi_rad))
    survey = _Survey(bound, settings, table, points, rounding, psi_rad, linear)
    elevation, azimuth = (_axis_report(survey, axis) for axis in AXES)
    poles = _coupled(survey)
    return DesignReport(
        rounding.name,
        psi_rad,
        points.psi_rad,
        elevation,
        azimuth,
        np.max(poles.real, axis=1),
        slowest_of(psi_rad, poles),
    )


def angles(grid_rad: Array) -> Array:
    """The operating points (points,) and, spread evenly strictly between them, at least ANGLES_BETWEEN angles: (angles,) [rad]."""
    intervals = len(grid_rad) - 1
    parts = -(-ANGLES_BETWEEN // intervals) + 1
    return np.interp(np.arange(intervals * parts + 1) / parts, np.arange(len(grid_rad)), grid_rad)


@dataclass(frozen=True, eq=False)
class _Survey:
    """What is examined, and the linear plants (angles,) at psi_rad (angles,)."""

    bound: BoundPlant
    settings: DesignSettings
    table: ControllerTable
    points: DesignPoints
    rounding: Rounding
    psi_rad: Array
    linear: tuple[LinearPlant, ...]

    def scheduled(self, axis: str) -> ScheduledAxis:
        return ScheduledAxis(
            name=axis,
            wishes=self.settings.axis(axis),
            grid_rad=self.points.psi_rad,
            designs=tuple(design.delta for design in self.points.axis(axis)),
            degree=self.settings.coefficient_degree,
            schedule=schedule_of(self.table.axis(axis)),
        )

    def plants(self, axis: str) -> tuple[PlantPolynomials, ...]:
        parts = (subsystem(self.bound, plant, axis) for plant in self.linear)
        return tuple(plant_polynomials(sample(part, self.settings.sample_period_s)) for part in parts)

    def flown(self, axis: str) -> tuple[DeltaForm, ...]:
        """The controllers (angles,) as they fly."""
        return self.rounding.controllers(self.table, axis, self.psi_rad)


def _axis_report(survey: _Survey, axis: str) -> AxisReport:
    psi_rad, plants, controllers = survey.psi_rad, survey.plants(axis), survey.flown(axis)
    scheduled, designs = survey.scheduled(axis), survey.points.axis(axis)
    fitted = pole_map(plants, [evaluate(scheduled.schedule, float(psi)) for psi in psi_rad])
    rounded = pole_map(plants, controllers)
    return AxisReport(
        axis=axis,
        poles_rad_s=scheduled.wishes.placed_rad_s,
        free_degree=scheduled.wishes.free_degree,
        largest_q_V_rad=max(float(np.max(np.abs(design.placement.controller.q))) for design in designs),
        condition=max(design.placement.condition for design in designs),
        fit_error=fit_error(scheduled.grid_rad, scheduled.designs, scheduled.schedule),
        feedforward_error_V=_feedforward_error_V(survey, axis),
        designs=scheduled.designs,
        operating_V=_operating_V(survey, axis),
        schedule=scheduled.schedule,
        feedforward_V=survey.table.axis(axis).feedforward_V,
        poles_fitted_rad_s=fitted,
        poles_flown_rad_s=rounded,
        designed_slowest_rad_s=max(pole.real for pole in scheduled.wishes.placed_rad_s),
        after_fit=slowest_of(psi_rad, fitted),
        after_rounding=slowest_of(psi_rad, rounded),
        migrations=migrations(scheduled, psi_rad, plants),
        margins=tuple(margins(open_loop(p, c)) for p, c in zip(plants, controllers, strict=True)),
        controller_radius=tuple(float(np.max(np.abs(1.0 + controller_poles(c)))) for c in controllers),
    )


def _feedforward_error_V(survey: _Survey, axis: str) -> float:
    fitted_V = polyval(survey.points.psi_rad, survey.table.axis(axis).feedforward_V)
    return float(np.max(np.abs(fitted_V - _operating_V(survey, axis))))


def _operating_V(survey: _Survey, axis: str) -> Array:
    return np.array([point.u0[AXES.index(axis)] for point in survey.points.equilibria])


def _coupled(survey: _Survey) -> Poles:
    """Poles of both loops closed on the whole plant, shape (angles, states), for the controllers as they fly."""
    plants = [sample(plant, survey.settings.sample_period_s) for plant in survey.linear]
    pairs = zip(*(survey.flown(axis) for axis in AXES), strict=True)
    return np.array([coupled_poles(plant, pair) for plant, pair in zip(plants, pairs, strict=True)])
