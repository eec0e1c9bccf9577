"""What the controller shall be: the [design] section of a plant file, read, completed with defaults and checked.

[design]                             every key may be left out; the defaults are DEFAULTS below
sample_period_s = 0.01
psi_min_rad = -0.698                 the schedule's range of elevation, within the hard stops
psi_max_rad = 0.698
operating_points = 17                spread evenly over that range
coefficient_degree = 3               of the fits of q_i and p_i in Psi
feedforward_degree = 2               of the fits of u_M0 and u_T0

[design.elevation]                   and [design.azimuth]
poles_rad_s = [-3.0, [-2.5, 1.5], [-2.5, -1.5], ...]     six, real or [re, im]
free_degree = "integral"             a name of design.pole_placement.FREE_DEGREES
prefilter_time_constant_s = 0.4      0 = none
observer_pole = 0.9                  triple pole in z of the anti-windup observer
reference_min_rad = -0.698           references outside are clamped
reference_max_rad = 0.698

[design.margins]                     a table that falls below them anywhere in the range is refused
max_sensitivity = 6.0
min_phase_margin_rad = 0.175
min_delay_margin_s = 0.02
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from design.pole_placement import FREE_DEGREES, ORDER
from design.structure import demand_helicopter
from records.errors import BadInput
from records.table import AXES, BothAxes
from records.text import checks
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

# Distinct poles, which the fit hardly moves, and integral action on both axes. On the CE150 with dry friction and encoder
# steps they track within 2 % overshoot and 0.05 deg; plants/ce150.toml states the same.
AXIS_DEFAULTS: Mapping[str, Mapping[str, Any]] = {
    "elevation": {
        "poles_rad_s": (-4.0, -5.0, -8.0, -14.0, -18.0, -24.0),
        "free_degree": "integral",
        "prefilter_time_constant_s": 0.4,
        "observer_pole": 0.9,
    },
    "azimuth": {
        "poles_rad_s": (-4.0, -5.0, -6.0, -8.0, -10.0, -12.0),
        "free_degree": "integral",
        "prefilter_time_constant_s": 0.5,
        "observer_pole": 0.9,
    },
}

# The limits refuse tables that do not fly, not tables that fly badly: taste in margins belongs to the plant file.
# Six times the sensitivity or 10 deg leave no room for the parameters' spread; two samples cover a serial link's delay.
MARGIN_DEFAULTS: Mapping[str, float] = {
    "max_sensitivity": 6.0,
    "min_phase_margin_rad": 0.175,
    "min_delay_margin_s": 0.02,
}

# Share of the hard stops that the defaults use, so that neither schedule nor reference ends on a stop.
_ELEVATION_SHARE = 8.0 / 9.0
_AZIMUTH_SHARE = 12.0 / 13.0


@dataclass(frozen=True)
class AxisSettings:
    """Wishes for the law of one axis; poles in rad/s of the continuous plane, `observer_pole` in z."""

    poles_rad_s: tuple[complex, ...]
    free_degree: str
    prefilter_time_constant_s: float
    observer_pole: float
    reference_min_rad: float
    reference_max_rad: float


@dataclass(frozen=True)
class MarginLimits:
    """What every operating point must hold: max|1/(1 + L)|, phase margin and extra loop delay."""

    max_sensitivity: float
    min_phase_margin_rad: float
    min_delay_margin_s: float


@dataclass(frozen=True)
class DesignSettings(BothAxes[AxisSettings]):
    """Wishes for the whole table."""

    sample_period_s: float
    psi_min_rad: float
    psi_max_rad: float
    operating_points: int
    coefficient_degree: int
    feedforward_degree: int
    elevation: AxisSettings
    azimuth: AxisSettings
    margins: MarginLimits


def read_settings(bound: BoundPlant) -> DesignSettings:
    """The settings in the plant's [design] section; raises BadInput naming key, range or pole that cannot be used."""
    section, where = bound.plant.design, f"plant {bound.plant.name!r}: design"
    demand_helicopter(bound)
    checks.keys(section, where, (), (*DEFAULTS, "psi_min_rad", "psi_max_rad", *AXES, "margins"))
    psi_limit = bound.parameter("Psi_lim")
    psi_min, psi_max = _psi_range(section, where, psi_limit)
    settings = DesignSettings(
        sample_period_s=checks.positive(_entry(section, "sample_period_s", DEFAULTS), f"{where}.sample_period_s"),
        psi_min_rad=psi_min,
        psi_max_rad=psi_max,
        operating_points=_count(section, "operating_points", where),
        coefficient_degree=_count(section, "coefficient_degree", where),
        feedforward_degree=_count(section, "feedforward_degree", where),
        elevation=_axis(section, "elevation", where, (psi_min, psi_max), psi_limit),
        azimuth=_axis(section, "azimuth", where, *_azimuth_range(bound)),
        margins=_margins(section, f"{where}.margins"),
    )
    _check_period(settings, where)
    _check_degrees(settings, where)
    for axis in AXES:
        _check_nyquist(settings, axis, where)
    return settings


def _entry(section: Mapping[str, Any], key: str, defaults: Mapping[str, Any]) -> Any:
    return section.get(key, defaults[key])


def _count(section: Mapping[str, Any], key: str, where: str) -> int:
    value = _entry(section, key, DEFAULTS)
    if isinstance(value, bool) or not isinstance(value, int) or value < 0:
        raise BadInput(
            "count", f"{where}.{key}", repr(value), "a whole number of 0 or more", "write it without a point"
        )
    return value


def _psi_range(section: Mapping[str, Any], where: str, limit_rad: float) -> tuple[float, float]:
    default = _ELEVATION_SHARE * limit_rad
    low = checks.number(section.get("psi_min_rad", -default), f"{where}.psi_min_rad")
    high = checks.number(section.get("psi_max_rad", default), f"{where}.psi_max_rad")
    _check_range(f"{where}: psi_min_rad, psi_max_rad", low, high, limit_rad, "operating range")
    return low, high


def _check_range(where: str, low: float, high: float, limit_rad: float, what: str) -> None:
    got = f"{low:g} .. {high:g} rad"
    if low >= high:
        raise BadInput(what, where, f"{got}, which is empty", "min < max", "widen the range")
    if low < -limit_rad or high > limit_rad:
        expected = f"a range within the hard stops at +-{limit_rad:g} rad"
        raise BadInput(what, where, got, expected, "narrow the range")


def _azimuth_range(bound: BoundPlant) -> tuple[tuple[float, float], float]:
    limit = bound.parameter("Phi_lim")
    return (-_AZIMUTH_SHARE * limit, _AZIMUTH_SHARE * limit), limit


def _axis(
    design: Mapping[str, Any], axis: str, design_where: str, reference_rad: tuple[float, float], limit_rad: float
) -> AxisSettings:
    where = f"{design_where}.{axis}"
    section = checks.table(design.get(axis, {}), where)
    checks.keys(section, where, (), tuple(AxisSettings.__dataclass_fields__))
    defaults = AXIS_DEFAULTS[axis]
    filter_s = checks.number(
        _entry(section, "prefilter_time_constant_s", defaults), f"{where}.prefilter_time_constant_s"
    )
    if filter_s < 0.0:
        raise BadInput(
            "time constant", f"{where}.prefilter_time_constant_s", repr(filter_s), "0 or more", "write 0 for no filter"
        )
    low = checks.number(section.get("reference_min_rad", reference_rad[0]), f"{where}.reference_min_rad")
    high = checks.number(section.get("reference_max_rad", reference_rad[1]), f"{where}.reference_max_rad")
    _check_range(f"{where}: reference_min_rad, reference_max_rad", low, high, limit_rad, "reference range")
    return AxisSettings(
        poles_rad_s=read_poles(_entry(section, "poles_rad_s", defaults), f"{where}.poles_rad_s"),
        free_degree=_free_degree(_entry(section, "free_degree", defaults), f"{where}.free_degree"),
        prefilter_time_constant_s=filter_s,
        observer_pole=_observer_pole(_entry(section, "observer_pole", defaults), f"{where}.observer_pole"),
        reference_min_rad=low,
        reference_max_rad=high,
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
    """Poles in rad/s, real or [re, im]; raises BadInput unless they are 2 x ORDER, stable and in conjugate pairs."""
    if not isinstance(entries, list | tuple) or len(entries) != 2 * ORDER:
        got = f"{len(entries)} poles" if isinstance(entries, list | tuple) else repr(entries)[:60]
        raise BadInput("poles", where, got, f"{2 * ORDER} poles", "give plant and controller three poles each")
    poles = tuple(_pole(entry, f"{where}[{index}]") for index, entry in enumerate(entries))
    for pole in poles:
        if pole.imag != 0.0 and poles.count(pole) != poles.count(pole.conjugate()):
            missing = f"its conjugate [{pole.real:g}, {-pole.imag:g}] as often"
            raise BadInput("poles", where, f"[{pole.real:g}, {pole.imag:g}] alone", missing, "write both of the pair")
    return poles


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


def _check_degrees(settings: DesignSettings, where: str) -> None:
    needed = max(settings.coefficient_degree, settings.feedforward_degree) + 1
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
    for pole in settings.axis(axis).poles_rad_s:
        if abs(pole.imag) >= nyquist_rad_s:
            raise BadInput(
                "pole",
                f"{where}.{axis}.poles_rad_s",
                f"[{pole.real:g}, {pole.imag:g}] rad/s",
                f"an imaginary part below the Nyquist frequency, {nyquist_rad_s:.4g} rad/s",
                "choose a slower pair or a shorter sample period",
            )
