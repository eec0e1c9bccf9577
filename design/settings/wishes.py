"""What the controller shall be, as records: of one axis, of the margins, of the whole table."""

from dataclasses import dataclass, replace
from typing import Any

from design.schedule import Degrees
from records.loops import LOOPS, Loop
from records.table import Schedule
from records.text.units import said

# Below this sample period [s] a wished roll-off is left out: it makes what v moves by in a sample smaller once more, Q(1) falls with the
# period to the power of the poles' number less three, and float32 and fixed point then lose it. On the CE150 both lose the azimuth at
# 0.5 ms, float32 overshoots by 2 % at 0.7 ms; at 1 ms it is 0.6 %, and double precision shows nothing at any period.
ROLL_OFF_FROM_S = 1e-3

# Bristol's rule: a pairing with a relative gain below a half loses over half of its loop's gain, or its sign, as others close or open.
LEAST_RELATIVE_GAIN = 0.5


@dataclass(frozen=True)
class AxisSettings:
    """Wishes for the law of the loop `axis`; poles in rad/s of the continuous plane, `observer_pole` in z.

    `coefficient_degree` is that of the fits of its q_i, None where it is the whole table's; `u_min_V` and `u_max_V` are None where the
    law may command all that the plant's input takes.
    """

    axis: str
    poles_rad_s: tuple[complex, ...]
    roll_off_pole_rad_s: float
    coefficient_degree: int | None
    free_degree: str
    prefilter_time_constant_s: float
    observer_pole: float
    reference_min_rad: float
    reference_max_rad: float
    u_min_V: float | None = None
    u_max_V: float | None = None

    @property
    def placed_rad_s(self) -> tuple[complex, ...]:
        """All poles of the closed loop: `poles_rad_s`, and with a roll-off that one."""
        roll_off = self.roll_off_pole_rad_s
        return (*self.poles_rad_s, complex(roll_off)) if roll_off else self.poles_rad_s

    @property
    def without_roll_off(self) -> "AxisSettings":
        """The same wishes for the controller of eq (22)."""
        return replace(self, roll_off_pole_rad_s=0.0)


@dataclass(frozen=True)
class MarginLimits:
    """What every operating point must hold: max|1/(1 + L)|, phase margin, extra loop delay, and each loop's relative gain."""

    max_sensitivity: float
    min_phase_margin_rad: float
    min_delay_margin_s: float
    min_relative_gain: float = LEAST_RELATIVE_GAIN


@dataclass(frozen=True)
class DesignSettings:
    """Wishes for the whole table; `axes` in the order of `loops`."""

    sample_period_s: float
    schedule: Schedule | None
    operating_points: int
    coefficient_degree: int
    recursion_degree: int
    feedforward_degree: int
    axes: tuple[AxisSettings, ...]
    margins: MarginLimits
    loops: tuple[Loop, ...] = LOOPS

    def axis(self, name: str) -> AxisSettings:
        """The wishes for one axis, without a roll-off below ROLL_OFF_FROM_S."""
        wishes = self.axes[self.index(name)]
        return wishes if self.sample_period_s >= ROLL_OFF_FROM_S else wishes.without_roll_off

    def with_axis(self, name: str, **change: Any) -> "DesignSettings":
        """The same with other wishes for one axis."""
        changed = [replace(axis, **change) if axis.axis == name else axis for axis in self.axes]
        return replace(self, axes=tuple(changed))

    def index(self, name: str) -> int:
        """The place of the loop of this axis."""
        return [loop.axis for loop in self.loops].index(name)

    def loop(self, name: str) -> Loop:
        """The loop of this axis."""
        return self.loops[self.index(name)]

    def degrees(self, axis: str) -> Degrees:
        """Those of the fits of one axis' feedback."""
        own = self.axis(axis).coefficient_degree
        return Degrees(self.coefficient_degree if own is None else own, self.recursion_degree)

    def place(self, what: str, psi_rad: float) -> str:
        """Where something is, in words: elevation at psi = -7.9 deg."""
        return f"{what} at rest" if self.schedule is None else f"{what}{self.scheduled_at(psi_rad)}"

    def scheduled_at(self, psi_rad: float) -> str:
        """The same of what schedules the law alone; empty where nothing does."""
        if self.schedule is None:
            return ""
        loop = self.loop(self.schedule.axis)
        return f" at {loop.symbol} = {said(loop.output, psi_rad)}"
