"""What a roll-off buys and what it costs: the same design with its roll-off pole elsewhere, flown on the simulated plant."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

from design.analysis.margins import margins
from design.loop import open_loop
from design.operating_points import DesignPoints, design_points, equilibria, grid
from design.schedule import evaluate, schedule_of
from design.settings import AxisSettings, DesignSettings
from design.table import axis_law
from records.errors import BadInput
from records.loops import LOOPS
from records.table import AXES, ControllerTable
from sim.bind import BoundPlant
from sim.equilibrium import OperatingPoint
from sim.loop import fly_law
from sim.manoeuvres import flight
from sim.tracking import Tracking, tracking

# The roll-off poles of both axes are moved by these factors: from where a loop barely stands to where they might as well not be there.
FACTORS = (0.7, 1.0, 1.4, 2.0, 4.0, 8.0)


@dataclass(frozen=True)
class TradePoint:
    """A design with its roll-off poles [rad/s], by axis, at `factor` times the wished ones: largest sensitivity over the operating points
    by axis, and how its flight tracked and how busy it kept the inputs, by axis as well."""

    factor: float
    roll_off_pole_rad_s: Mapping[str, float]
    sensitivity: Mapping[str, float]
    tracking: Mapping[str, Tracking]


def trade_off(bound: BoundPlant, settings: DesignSettings, table: ControllerTable) -> tuple[TradePoint, ...]:
    """The points of FACTORS that can be designed for, from slow to fast; none without a roll-off on both axes of a helicopter."""
    if settings.loops != LOOPS or not all(settings.axis(axis).roll_off_pole_rad_s for axis in AXES):
        return ()
    points, rests = [], equilibria(bound, settings, grid(settings))
    for factor in FACTORS:
        moved = replace(settings, axes=tuple(_moved(settings, axis, factor) for axis in AXES))
        try:
            points.append(_point(bound, moved, rests, table, factor))
        except BadInput:  # a controller that is unstable itself
            continue
    return tuple(points)


def _moved(settings: DesignSettings, axis: str, factor: float) -> AxisSettings:
    wishes = settings.axis(axis)
    return replace(wishes, roll_off_pole_rad_s=factor * wishes.roll_off_pole_rad_s)


def _point(
    bound: BoundPlant,
    settings: DesignSettings,
    rests: tuple[OperatingPoint, ...],
    table: ControllerTable,
    factor: float,
) -> TradePoint:
    points = design_points(bound, settings, rests)
    moved = replace(table, axes=tuple(axis_law(bound, settings, points, axis) for axis in AXES))
    log = fly_law(bound, moved, flight(bound, settings.sample_period_s))
    return TradePoint(
        factor=factor,
        roll_off_pole_rad_s={axis: settings.axis(axis).roll_off_pole_rad_s for axis in AXES},
        sensitivity={axis: _sensitivity(moved, points, axis) for axis in AXES},
        tracking={loop.axis: tracking(log, loop) for loop in LOOPS},
    )


def _sensitivity(table: ControllerTable, points: DesignPoints, axis: str) -> float:
    """Of the fitted controllers at the operating points."""
    schedule = schedule_of(table.axis(axis))
    loops = [
        open_loop(design.plant, evaluate(schedule, float(psi)))
        for psi, design in zip(points.psi_rad, points.axes[AXES.index(axis)], strict=True)
    ]
    return max(margins(loop).sensitivity for loop in loops)
