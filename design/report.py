"""What is known of a table: fit, pole migration, margins over the scheduling angle, and all loops closed together."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.polynomial.polynomial import polyval
from numpy.typing import NDArray

from design.analysis.coupled import Coupling, coupled_poles, coupling
from design.analysis.margins import Margins, margins
from design.analysis.migration import Migration, ScheduledAxis, SlowestPole, migrations, pole_map, slowest_of
from design.analysis.rounding import FLOAT32, Rounding
from design.direct_form import DeltaForm
from design.discretise import SampledPlant, sample
from design.linear_plant import LinearPlant
from design.linearise import linearise, of_loops, subsystem
from design.loop import PlantPolynomials, Poles, controller_poles, open_loop, plant_polynomials
from design.operating_points import DesignPoints, equilibria, grid, rest_V
from design.schedule import FitError, Schedule, evaluate, fit_error, schedule_of
from design.settings import AxisSettings, DesignSettings
from records.loops import LOOPS, Loop
from records.table import ControllerTable, Polynomial
from sim.bind import BoundPlant

Array = NDArray[np.float64]

ANGLES_BETWEEN = 200


@dataclass(frozen=True, eq=False)
class AxisReport:
    """One axis over the angles psi_rad of the report.

    `poles_fitted_rad_s` and `poles_flown_rad_s` have shape (angles, poles); `margins` and `controller_radius`, the largest |z| of the
    controller's own poles, belong to the table as its arithmetic rounds it, as it flies.
    `scheduled` has the feedback and `operating_V` (points,) the voltage at each operating point, `schedule` and `feedforward_V` are the
    polynomials fitted to them; `plants` (angles,) are what the law is closed around at `psi_rad` (angles,).
    """

    axis: str
    poles_rad_s: tuple[complex, ...]
    free_degree: str
    condition: float
    fit_error: FitError
    feedforward_error_V: float
    scheduled: ScheduledAxis
    operating_V: Array
    feedforward_V: Polynomial
    poles_fitted_rad_s: Poles
    poles_flown_rad_s: Poles
    designed_slowest_rad_s: float
    after_fit: SlowestPole
    after_rounding: SlowestPole
    margins: tuple[Margins, ...]
    controller_radius: tuple[float, ...]
    psi_rad: Array
    plants: tuple[PlantPolynomials, ...]

    @property
    def designs(self) -> tuple[DeltaForm, ...]:
        """The feedback (points,) at each operating point."""
        return self.scheduled.designs

    @property
    def schedule(self) -> Schedule:
        """The polynomials fitted to `designs`."""
        return self.scheduled.schedule

    @cached_property
    def migrations(self) -> tuple[Migration, ...]:
        """Where the slowest pole goes in every form, from every source and storage: more work than all the rest, for those who ask."""
        return migrations(self.scheduled, self.psi_rad, self.plants)

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
class DesignReport:
    """All axes over the scheduling angles psi_rad (angles,): the operating points and at least 200 angles between them.

    points_rad (points,) are the operating points alone, `angle` names the axis that they are of. `arithmetic` is that of the law that
    flies; `coupled_slowest_rad_s` (angles,) is the slowest pole of all its loops closed on the whole plant, and `coupled` its worst.
    `coupling` is what the loops do to one another at each operating point.
    """

    arithmetic: str
    angle: str
    psi_rad: Array
    points_rad: Array
    axes: tuple[AxisReport, ...]
    coupled_slowest_rad_s: Array
    coupled: SlowestPole
    coupling: tuple[Coupling, ...]
    loops: tuple[Loop, ...] = LOOPS

    @property
    def scheduled_by(self) -> str:
        """The column that the coefficients go by; the first loop's where they go by none."""
        return next((loop.output for loop in self.loops if loop.axis == self.angle), self.loops[0].output)

    @property
    def is_scheduled(self) -> bool:
        """Whether the coefficients go by a measured output; else there is one rest point, and nothing between."""
        return any(loop.axis == self.angle for loop in self.loops)

    def loop(self, axis: str) -> Loop:
        """The loop of this axis."""
        return next(loop for loop in self.loops if loop.axis == axis)

    def axis(self, name: str) -> AxisReport:
        """The entry of the axis called `name`."""
        (found,) = (axis for axis in self.axes if axis.axis == name)
        return found

    def pole_entries(self) -> list[dict[str, Any]]:
        """The entries `poles` of verification.json: designed poles against those that fly, per axis."""
        return [_pole_entry(axis.axis, axis.designed_slowest_rad_s, axis.after_rounding) for axis in self.axes]


def _pole_entry(axis: str, designed_rad_s: float, flown: SlowestPole) -> dict[str, Any]:
    return {
        "axis": axis,
        "designed_slowest_rad_s": designed_rad_s,
        "worst_slowest_rad_s": flown.worst_rad_s,
        "at_psi_rad": flown.at_psi_rad,
        "stable": flown.stable,
    }


def flown_poles(
    bound: BoundPlant, settings: DesignSettings, table: ControllerTable, rounding: Rounding = FLOAT32
) -> list[dict[str, Any]]:
    """The entries `poles` of verification.json for a table that exists already; raises BadInput where an angle cannot be held at rest."""
    survey = _survey(bound, settings, table, grid(settings), rounding)
    return [
        _pole_entry(axis, _designed_slowest_rad_s(settings.axis(axis)), slowest_of(survey.psi_rad, poles))
        for axis in (loop.axis for loop in settings.loops)
        for poles in [pole_map(survey.plants(axis), survey.flown(axis))]
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
    survey = _survey(bound, settings, table, points.psi_rad, rounding)
    psi_rad = survey.psi_rad
    axes = tuple(_axis_report(survey, points, loop.axis) for loop in settings.loops)
    poles = _coupled(survey)
    return DesignReport(
        rounding.name,
        "rest" if settings.schedule is None else settings.schedule.axis,
        psi_rad,
        points.psi_rad,
        axes,
        np.max(poles.real, axis=1),
        slowest_of(psi_rad, poles),
        _coupling(survey, points),
        settings.loops,
    )


def _survey(
    bound: BoundPlant, settings: DesignSettings, table: ControllerTable, grid_rad: Array, rounding: Rounding
) -> "_Survey":
    psi_rad = angles(grid_rad)
    linear = tuple(linearise(bound, point) for point in equilibria(bound, settings, psi_rad))
    return _Survey(bound, settings, table, rounding, psi_rad, linear)


def angles(grid_rad: Array) -> Array:
    """The operating points (points,) and, spread evenly strictly between them, at least ANGLES_BETWEEN angles: (angles,) [rad]."""
    if len(grid_rad) == 1:
        return grid_rad
    intervals = len(grid_rad) - 1
    parts = -(-ANGLES_BETWEEN // intervals) + 1
    return np.interp(np.arange(intervals * parts + 1) / parts, np.arange(len(grid_rad)), grid_rad)


@dataclass(frozen=True, eq=False)
class _Survey:
    """What is examined, and the linear plants (angles,) at psi_rad (angles,)."""

    bound: BoundPlant
    settings: DesignSettings
    table: ControllerTable
    rounding: Rounding
    psi_rad: Array
    linear: tuple[LinearPlant, ...]

    def plants(self, axis: str) -> tuple[PlantPolynomials, ...]:
        loop, loops = self.settings.loop(axis), self.settings.loops
        parts = (subsystem(self.bound, plant, loop, loops) for plant in self.linear)
        return tuple(plant_polynomials(sample(part, self.settings.sample_period_s)) for part in parts)

    def whole(self) -> list[SampledPlant]:
        """The plants (angles,) from all loops' inputs to all their angles."""
        loops, period_s = self.settings.loops, self.settings.sample_period_s
        return [sample(of_loops(self.bound, plant, loops), period_s) for plant in self.linear]

    def together(self) -> Iterator[tuple[DeltaForm, ...]]:
        """The controllers of all loops at each angle, as they fly."""
        return zip(*(self.flown(loop.axis) for loop in self.settings.loops), strict=True)

    def flown(self, axis: str) -> tuple[DeltaForm, ...]:
        """The controllers (angles,) as they fly."""
        return self.rounding.controllers(self.table, axis, self.psi_rad)


def _axis_report(survey: _Survey, points: DesignPoints, axis: str) -> AxisReport:
    psi_rad, plants, controllers = survey.psi_rad, survey.plants(axis), survey.flown(axis)
    designs = points.axes[survey.settings.index(axis)]
    scheduled = ScheduledAxis(
        name=axis,
        wishes=survey.settings.axis(axis),
        place=survey.settings.place,
        grid_rad=points.psi_rad,
        designs=tuple(design.delta for design in designs),
        degree=survey.settings.coefficient_degree,
        schedule=schedule_of(survey.table.axis(axis)),
    )
    operating_V = rest_V(survey.bound, points.equilibria, survey.settings.loop(axis))
    feedforward_V = survey.table.axis(axis).feedforward_V
    fitted = pole_map(plants, [evaluate(scheduled.schedule, float(psi)) for psi in psi_rad])
    rounded = pole_map(plants, controllers)
    return AxisReport(
        axis=axis,
        poles_rad_s=scheduled.wishes.placed_rad_s,
        free_degree=scheduled.wishes.free_degree,
        condition=max(design.placement.condition for design in designs),
        fit_error=fit_error(scheduled.grid_rad, scheduled.designs, scheduled.schedule),
        feedforward_error_V=float(np.max(np.abs(polyval(points.psi_rad, feedforward_V) - operating_V))),
        scheduled=scheduled,
        operating_V=operating_V,
        feedforward_V=feedforward_V,
        poles_fitted_rad_s=fitted,
        poles_flown_rad_s=rounded,
        designed_slowest_rad_s=_designed_slowest_rad_s(scheduled.wishes),
        after_fit=slowest_of(psi_rad, fitted),
        after_rounding=slowest_of(psi_rad, rounded),
        margins=tuple(margins(open_loop(p, c)) for p, c in zip(plants, controllers, strict=True)),
        controller_radius=tuple(float(np.max(np.abs(1.0 + controller_poles(c)))) for c in controllers),
        psi_rad=psi_rad,
        plants=plants,
    )


def _designed_slowest_rad_s(wishes: AxisSettings) -> float:
    return max(pole.real for pole in wishes.placed_rad_s)


def _coupled(survey: _Survey) -> Poles:
    """Poles of all loops closed on the whole plant, shape (angles, states), for the controllers as they fly."""
    pairs = zip(survey.whole(), survey.together(), strict=True)
    return np.array([coupled_poles(plant, controllers) for plant, controllers in pairs])


def _coupling(survey: _Survey, points: DesignPoints) -> tuple[Coupling, ...]:
    """At the operating points; nothing of one loop."""
    if len(survey.settings.loops) == 1:
        return ()
    wanted = set(points.psi_rad.tolist())
    rows = zip(survey.psi_rad.tolist(), survey.whole(), survey.together(), strict=True)
    return tuple(coupling(plant, controllers) for psi, plant, controllers in rows if psi in wanted)
