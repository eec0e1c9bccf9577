"""What the controller shall be: the [design] section of a plant file, read, completed with defaults and checked.

[design]                             every key may be left out; the defaults are DEFAULTS below, and for an axis those of plants/MODEL.toml
sample_period_s = 0.01
schedule = "psi_rad"                 the measured angle that the coefficients go by; without it none, but the helicopter's elevation
psi_min_rad = -0.698                 the schedule's range of that angle, within the hard stops
psi_max_rad = 0.698
operating_points = 17                spread evenly over that range
coefficient_degree = 2               of the fits of q_i in Psi
recursion_degree = 0                 of the fits of p_i in Psi; without it, coefficient_degree
feedforward_degree = 2               of the fits of u_M0 and u_T0

[design.elevation]                   and [design.azimuth]; another plant's loops, one to four, each by a name of its own
output = "psi_rad"                   what is measured; may be left out where the plant has one
input = "u_M_V"                      what the loop commands; likewise
poles_rad_s = [-3.0, [-2.5, 1.5], [-2.5, -1.5], ...]     two for each state of the axis, real or [re, im]
roll_off_pole_rad_s = -20.0          a seventh: the controller then falls towards the Nyquist frequency; 0 = none, as below 1 ms
coefficient_degree = 0               of this axis' q_i; without it, that of [design]
free_degree = "integral"             a name of design.pole_placement.FREE_DEGREES
prefilter_time_constant_s = 0.4      0 = none
observer_pole = 0.9                  triple pole in z of the anti-windup observer
reference_min_rad = -0.698           references outside are clamped
reference_max_rad = 0.698
u_min_V = 0.0                        narrower limits than the plant's: for a thrust that does not turn round with its voltage
u_max_V = 10.0

Keys in _rad and _V are so for an angle and a voltage; for another loop they end in its columns' units: reference_min_m, u_max_A.

[design.margins]                     a table that falls below them anywhere in the range is refused
max_sensitivity = 6.0
min_phase_margin_rad = 0.175
min_delay_margin_s = 0.02
min_relative_gain = 0.5

[design.tuned]                       what other controllers than this leave open: controllers/equations/tuned.py
"""

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from typing import Any

from design.pins import demand_in_reach
from design.pole_placement import FREE_DEGREES
from design.schedule import Degrees
from design.structure import loops_of, measured_axis, stops
from records.errors import BadInput
from records.loops import LOOPS, Loop
from records.plant import PLANTS, Plant, load_plant
from records.table import ORDERS, Schedule
from records.text import checks
from records.text.units import said, unit_of
from sim.bind import BoundPlant

DEFAULTS: Mapping[str, float] = {
    "sample_period_s": 0.01,
    "operating_points": 17,
    "coefficient_degree": 3,
    "feedforward_degree": 2,
}

# Shortest and longest sample period [s]: below, float32 has too few digits for what v moves by in a sample and the step on the
# STM32G071 fills the period; above, the watchdog's 125 ms leave no room for a missed one, and a rig's poles lie near the Nyquist frequency.
SAMPLE_PERIODS_S = (0.5e-3, 50e-3)

# Below this sample period [s] a wished roll-off is left out: it makes what v moves by in a sample smaller once more, Q(1) falls with the
# period to the power of the poles' number less three, and float32 and fixed point then lose it. On the CE150 both lose the azimuth at
# 0.5 ms, float32 overshoots by 2 % at 0.7 ms; at 1 ms it is 0.6 %, and double precision shows nothing at any period.
ROLL_OFF_FROM_S = 1e-3

# Wishes for an axis that neither its plant file nor that of its model states anything of; the poles are named by one of them.
PLAIN_AXIS: Mapping[str, Any] = {
    "roll_off_pole_rad_s": 0.0,
    "coefficient_degree": None,
    "free_degree": "integral",
    "prefilter_time_constant_s": 0.0,
    "observer_pole": 0.9,
}

# Without a schedule there is one operating point, and every coefficient is a constant.
UNSCHEDULED: Mapping[str, float] = {"operating_points": 1, "coefficient_degree": 0, "feedforward_degree": 0}

# Poles of a plant file's own are placed alone, and scheduled, unless it asks for a roll-off or another degree as well.
OWN_POLES: Mapping[str, float | None] = {"roll_off_pole_rad_s": 0.0, "coefficient_degree": None}

# The limits refuse tables that do not fly, not tables that fly badly: taste in margins belongs to the plant file.
# Six times the sensitivity or 10 deg leave no room for the parameters' spread; two samples cover a serial link's delay.
# Bristol's rule: a pairing with a relative gain below a half loses over half of its loop's gain, or its sign, as others close or open.
LEAST_RELATIVE_GAIN = 0.5
MARGIN_DEFAULTS: Mapping[str, float] = {
    "max_sensitivity": 6.0,
    "min_phase_margin_rad": 0.175,
    "min_delay_margin_s": 0.02,
    "min_relative_gain": LEAST_RELATIVE_GAIN,
}

# Share of the hard stops that the defaults use, so that neither schedule nor reference ends on a stop; the azimuth's by its own name.
_SHARE, _AZIMUTH_SHARE = 8.0 / 9.0, 12.0 / 13.0


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
        if self.schedule is None:
            return f"{what} at rest"
        loop = self.loop(self.schedule.axis)
        return f"{what} at {loop.symbol} = {said(loop.output, psi_rad)}"


def read_settings(bound: BoundPlant) -> DesignSettings:
    """The settings in the plant's [design] section; raises BadInput naming key, range or pole that cannot be used."""
    section, where = bound.plant.design, f"plant {bound.plant.name!r}: design"
    loops = loops_of(bound, section, where)
    scheduling = _scheduling(section, loops, where)
    ranges = () if scheduling is None else _range_keys(scheduling)
    names = [loop.axis for loop in loops]
    tuned = ("tuned",) if loops == LOOPS else ()  # the papers' controllers are the helicopter's
    checks.keys(section, where, (), (*DEFAULTS, "recursion_degree", "schedule", *ranges, *names, "margins", *tuned))
    schedule = None if scheduling is None else _schedule(bound, section, scheduling, where)
    counts = DEFAULTS if schedule else {**DEFAULTS, **UNSCHEDULED}
    coefficient_degree = _count(section, "coefficient_degree", where, counts)
    settings = DesignSettings(
        sample_period_s=checks.positive(_entry(section, "sample_period_s", DEFAULTS), f"{where}.sample_period_s"),
        schedule=schedule,
        operating_points=_count(section, "operating_points", where, counts),
        coefficient_degree=coefficient_degree,
        recursion_degree=_count({"recursion_degree": coefficient_degree, **section}, "recursion_degree", where),
        feedforward_degree=_count(section, "feedforward_degree", where, counts),
        axes=tuple(_axis(bound, section, loop, where, schedule) for loop in loops),
        margins=_margins(section, f"{where}.margins"),
        loops=loops,
    )
    _check_period(settings, where)
    _check_degrees(settings, where)
    for name in names:
        _check_nyquist(settings, name, where)
    return settings


def _wishes_of_model(plant: Plant, axis: str) -> Mapping[str, Any]:
    """What the project's own file of the plant's model wishes for an axis of this name; its ranges follow from the plant's stops."""
    file = PLANTS / f"{plant.model}.toml"
    if plant.equations is not None or not file.is_file():
        return {}
    section = load_plant(file).design.get(axis, {})
    return {name: value for name, value in section.items() if name in PLAIN_AXIS or name == "poles_rad_s"}


def _scheduling(section: Mapping[str, Any], loops: tuple[Loop, ...], where: str) -> Loop | None:
    """The loop whose angle the coefficients go by; the helicopter's is its first."""
    if "schedule" not in section:
        return loops[0] if loops == LOOPS else None
    name = checks.text(section["schedule"], f"{where}.schedule")
    for loop in loops:
        if name == loop.output:
            return loop
    known = ", ".join(loop.output for loop in loops)
    raise BadInput(
        "schedule", f"{where}.schedule", repr(name), f"a loop's output, {known}", "leave it out for no schedule"
    )


def _schedule(bound: BoundPlant, section: Mapping[str, Any], loop: Loop, where: str) -> Schedule:
    has_positions = any(axis.position is not None for axis in bound.nominal.axes)
    if has_positions and measured_axis(bound.nominal, loop) is None:
        expected = "an output that is the position of an axis, as this plant has positions: it is put to rest at these"
        raise BadInput("schedule", f"{where}.schedule", loop.output, expected, "leave it out for no schedule")
    low_key, high_key = _range_keys(loop)
    stops_rad = stops(bound, loop)
    default = _within(stops_rad, _SHARE)
    low, high = (_range_end(section, key, default, end, where) for end, key in enumerate((low_key, high_key)))
    _check_range(f"{where}: {low_key}, {high_key}", low, high, stops_rad, "operating range", loop)
    return Schedule(loop.axis, low, high)


def _range_keys(loop: Loop) -> tuple[str, str]:
    return loop.own(f"{loop.symbol}_min_rad"), loop.own(f"{loop.symbol}_max_rad")


def _range_end(
    section: Mapping[str, Any], key: str, default: tuple[float, float] | None, end: int, where: str
) -> float:
    if key not in section and default is None:
        raise BadInput(f"key {key!r}", where, "nothing", "a number, as this axis has no stops", f"add {key}")
    return checks.number(section.get(key, default[end] if default else None), f"{where}.{key}")


def _within(stops_rad: tuple[float, float], share: float) -> tuple[float, float] | None:
    """The default of a range within stops; None where there are none."""
    return (share * stops_rad[0], share * stops_rad[1]) if all(map(math.isfinite, stops_rad)) else None


def _entry(section: Mapping[str, Any], key: str, defaults: Mapping[str, Any]) -> Any:
    return section[key] if key in section else defaults[key]


def _count(section: Mapping[str, Any], key: str, where: str, defaults: Mapping[str, float] = DEFAULTS) -> int:
    value = _entry(section, key, defaults)
    if isinstance(value, bool) or not isinstance(value, int) or value < 0:
        raise BadInput(
            "count", f"{where}.{key}", repr(value), "a whole number of 0 or more", "write it without a point"
        )
    return value


def _own_degree(value: Any, where: str) -> int | None:
    return None if value is None else _count({"coefficient_degree": value}, "coefficient_degree", where)


def _check_range(where: str, low: float, high: float, stops_rad: tuple[float, float], what: str, loop: Loop) -> None:
    unit = unit_of(loop.output)
    got = f"{low:g} .. {high:g} {unit}"
    if low >= high:
        raise BadInput(what, where, f"{got}, which is empty", "min < max", "widen the range")
    if low < stops_rad[0] or high > stops_rad[1]:
        symmetric = stops_rad[0] == -stops_rad[1]
        stops = f"+-{stops_rad[1]:g} {unit}" if symmetric else f"{stops_rad[0]:g} and {stops_rad[1]:g} {unit}"
        raise BadInput(what, where, got, f"a range within the hard stops at {stops}", "narrow the range")


def _axis(
    bound: BoundPlant, design: Mapping[str, Any], loop: Loop, design_where: str, schedule: Schedule | None
) -> AxisSettings:
    axis, where = loop.axis, f"{design_where}.{loop.axis}"
    section = checks.table(design.get(axis, {}), where)
    wished = tuple(loop.own(name) for name in AxisSettings.__dataclass_fields__ if name != "axis")
    of_model = _wishes_of_model(bound.plant, axis)
    checks.keys(section, where, () if "poles_rad_s" in of_model else ("poles_rad_s",), (*wished, "output", "input"))
    stops_rad = stops(bound, loop)
    if schedule is not None and schedule.axis == axis:
        reference_rad: tuple[float, float] | None = (schedule.min_rad, schedule.max_rad)
    else:
        reference_rad = _within(stops_rad, _AZIMUTH_SHARE if axis == "azimuth" else _SHARE)
    defaults = {**PLAIN_AXIS, **of_model, **(OWN_POLES if "poles_rad_s" in section else {})}
    filter_s = checks.number(
        _entry(section, "prefilter_time_constant_s", defaults), f"{where}.prefilter_time_constant_s"
    )
    if filter_s < 0.0:
        raise BadInput(
            "time constant", f"{where}.prefilter_time_constant_s", repr(filter_s), "0 or more", "write 0 for no filter"
        )
    ends = (loop.own("reference_min_rad"), loop.own("reference_max_rad"))
    low, high = (_range_end(section, key, reference_rad, end, where) for end, key in enumerate(ends))
    _check_range(f"{where}: {', '.join(ends)}", low, high, stops_rad, "reference range", loop)
    demand_in_reach(loop, low, high, "reference range", f"{where}: {', '.join(ends)}")
    return AxisSettings(
        axis=axis,
        poles_rad_s=read_poles(_entry(section, "poles_rad_s", defaults), f"{where}.poles_rad_s"),
        roll_off_pole_rad_s=_roll_off(_entry(section, "roll_off_pole_rad_s", defaults), f"{where}.roll_off_pole_rad_s"),
        coefficient_degree=_own_degree(_entry(section, "coefficient_degree", defaults), where),
        free_degree=_free_degree(_entry(section, "free_degree", defaults), f"{where}.free_degree"),
        prefilter_time_constant_s=filter_s,
        observer_pole=_observer_pole(_entry(section, "observer_pole", defaults), f"{where}.observer_pole"),
        reference_min_rad=low,
        reference_max_rad=high,
        **{
            name: checks.number(section[loop.own(name)], f"{where}.{loop.own(name)}")
            for name in ("u_min_V", "u_max_V")
            if loop.own(name) in section
        },
    )


def _free_degree(value: Any, where: str) -> str:
    name = checks.text(value, where)
    if name not in FREE_DEGREES:
        known = ", ".join(repr(known) for known in FREE_DEGREES)
        raise BadInput("free degree", where, repr(name), f"one of {known}", "name the condition that fixes eq (26)")
    return name


def _observer_pole(value: Any, where: str) -> float:
    pole = checks.number(value, where)
    if not 0.0 <= pole < 1.0:
        raise BadInput("observer pole", where, repr(pole), "0 <= pole < 1, in z", "choose a stable pole such as 0.9")
    return pole


def read_poles(entries: Any, where: str) -> tuple[complex, ...]:
    """Poles in rad/s, real or [re, im]; raises BadInput unless they are two a state, stable and in conjugate pairs."""
    most = 2 * ORDERS[-1]
    if not isinstance(entries, list | tuple) or len(entries) not in range(2, most + 1, 2):
        got = f"{len(entries)} poles" if isinstance(entries, list | tuple) else repr(entries)[:60]
        expected = f"two poles for each state that the input moves and that moves the output, {most} at most"
        raise BadInput(
            "poles",
            where,
            got,
            expected,
            f"give plant and controller as many each; of more than {ORDERS[-1]} states leave the fastest out",
        )
    poles = tuple(_pole(entry, f"{where}[{index}]") for index, entry in enumerate(entries))
    for pole in poles:
        if pole.imag != 0.0 and poles.count(pole) != poles.count(pole.conjugate()):
            missing = f"its conjugate [{pole.real:g}, {-pole.imag:g}] as often"
            raise BadInput("poles", where, f"[{pole.real:g}, {pole.imag:g}] alone", missing, "write both of the pair")
    return poles


def _roll_off(value: Any, where: str) -> float:
    return _pole(value, where).real if checks.number(value, where) else 0.0


def _pole(entry: Any, where: str) -> complex:
    if isinstance(entry, list | tuple):
        pole = complex(*checks.numbers(entry, where, 2))
    else:
        pole = complex(checks.number(entry, where))
    if pole.real >= 0.0:
        raise BadInput(
            "pole",
            where,
            f"{pole.real:g}{pole.imag:+g}j rad/s, on or outside the unit circle in z",
            "a real part below 0",
            "check its sign: a stable pole is negative",
        )
    return pole


def _margins(design: Mapping[str, Any], where: str) -> MarginLimits:
    section = checks.table(design.get("margins", {}), where)
    checks.keys(section, where, (), tuple(MARGIN_DEFAULTS))
    values = {key: checks.number(_entry(section, key, MARGIN_DEFAULTS), f"{where}.{key}") for key in MARGIN_DEFAULTS}
    if values["max_sensitivity"] <= 1.0:
        got = repr(values["max_sensitivity"])
        raise BadInput("margin", f"{where}.max_sensitivity", got, "a number above 1", "2 is usual, 6 barely flies")
    return MarginLimits(**values)


def _names(settings: DesignSettings) -> list[str]:
    return [loop.axis for loop in settings.loops]


def _check_degrees(settings: DesignSettings, where: str) -> None:
    degrees = [degree for axis in _names(settings) for degree in asdict(settings.degrees(axis)).values()]
    needed = max(*degrees, settings.feedforward_degree) + 1
    if settings.schedule is None:
        if settings.operating_points != 1 or needed > 1:
            raise BadInput(
                "degrees", where, f"{settings.operating_points} operating points, fits of degree {needed - 1}",
                "one point and degrees of 0, as nothing is scheduled", "leave them out, or name the schedule's output",
            )  # fmt: skip
        return
    if settings.operating_points < max(needed, 2):
        raise BadInput(
            "operating points",
            f"{where}.operating_points",
            str(settings.operating_points),
            f"at least {max(needed, 2)} for fits of degree {needed - 1}",
            "add points or lower the degree",
        )


def _check_period(settings: DesignSettings, where: str) -> None:
    low_s, high_s = SAMPLE_PERIODS_S
    period_s = settings.sample_period_s
    whole = abs(period_s * 1e6 - round(period_s * 1e6)) < 1e-6
    if not (low_s <= period_s <= high_s and whole):
        expected = f"whole microseconds from {low_s:g} to {high_s:g} s"
        remedy = "choose one that the board's timer can count"
        raise BadInput("sample period", f"{where}.sample_period_s", f"{period_s:g} s", expected, remedy)


def _check_nyquist(settings: DesignSettings, axis: str, where: str) -> None:
    nyquist_rad_s = math.pi / settings.sample_period_s
    for pole in settings.axis(axis).placed_rad_s:
        if abs(pole.imag) >= nyquist_rad_s:
            raise BadInput(
                "pole",
                f"{where}.{axis}.poles_rad_s",
                f"[{pole.real:g}, {pole.imag:g}] rad/s",
                f"an imaginary part below the Nyquist frequency, {nyquist_rad_s:.4g} rad/s",
                "choose a slower pair or a shorter sample period",
            )
