"""What the designs of all controllers share: sampled plants at the operating points, and the frame's part of the table."""

from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from design.discretise import SampledPlant, sample
from design.linear_plant import LinearPlant
from design.linearise import linearise, of_loops, subsystem
from design.operating_points import equilibria, grid
from design.settings import AxisSettings, DesignSettings
from design.table import frame_entries
from records.law_table import AxisTable, LawTable
from sim.added_effects import without_effects
from sim.bind import BoundPlant
from sim.equilibrium import OperatingPoint

Array = NDArray[np.float64]
G = TypeVar("G")
# Beyond so many times the largest reference a remembered output comes from a broken state: a rig that is thrown off, or turned once more,
# is not so far away.
OUTPUT_RANGES = 16.0


@dataclass(frozen=True)
class Points:
    """The operating points psi_rad (points,) of the schedule's range: equilibria, and the plant linearised there."""

    bound: BoundPlant
    settings: DesignSettings
    psi_rad: Array
    equilibria: tuple[OperatingPoint, ...]
    linear: tuple[LinearPlant, ...]

    def axis(self, name: str) -> tuple[LinearPlant, ...]:
        """The part of each from the axis' input to its angle."""
        loops = self.settings.loops
        return tuple(subsystem(self.bound, plant, self.settings.loop(name), loops) for plant in self.linear)

    def sampled(self, name: str) -> tuple[SampledPlant, ...]:
        """The axis' parts, sampled with a zero-order hold."""
        return tuple(sample(plant, self.settings.sample_period_s) for plant in self.axis(name))

    def whole(self) -> tuple[SampledPlant, ...]:
        """All of the plant, from both inputs to both angles, sampled likewise."""
        loops, period_s = self.settings.loops, self.settings.sample_period_s
        return tuple(sample(of_loops(self.bound, plant, loops), period_s) for plant in self.linear)


def mean_speed_rad_s(wishes: AxisSettings) -> float:
    """The geometric mean of all wished poles' distances from the origin."""
    return float(np.exp(np.mean(np.log(np.abs(np.array(wishes.placed_rad_s))))))


def largest_output(wishes: AxisSettings) -> float:
    """What neither a measurement nor what a law remembers of it exceeds unless its state is broken, in the output's unit."""
    return OUTPUT_RANGES * max(abs(wishes.reference_min_rad), abs(wishes.reference_max_rad))


def points_of(bound: BoundPlant, settings: DesignSettings) -> Points:
    """The operating points of the nominal plant: controllers are designed without added effects. Raises BadInput for one out of reach."""
    seen = without_effects(bound)
    psi_rad = grid(settings)
    points = equilibria(seen, settings, psi_rad)
    return Points(seen, settings, psi_rad, points, tuple(linearise(seen, point) for point in points))


def axis_table(points: Points, axis: str, gains: G, prefilter_time_constant_s: float | None = None) -> AxisTable[G]:
    """A controller's `gains` in the frame of the scheduled law's axis; its reference filter may be another than [design] wishes."""
    entries = frame_entries(points.bound, points.settings, points.psi_rad, points.equilibria, axis)
    if prefilter_time_constant_s is not None:
        entries["prefilter_time_constant_s"] = prefilter_time_constant_s
    return AxisTable(gains=gains, **entries)


def law_table(controller: str, points: Points, axes: dict[str, AxisTable[G]], origin: dict[str, Any]) -> LawTable[G]:
    """The table of all axes."""
    return LawTable(
        controller=controller,
        plant=points.bound.plant.name,
        sample_period_s=points.settings.sample_period_s,
        schedule=points.settings.schedule,
        axes=tuple(axes[loop.axis] for loop in points.settings.loops),
        loops=points.settings.loops,
        origin=origin,
    )
