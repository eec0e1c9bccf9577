"""The [design] section of a plant file, read, completed with defaults and checked.

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
min_delay_margin_s = 0.02            two samples where these are shorter
min_relative_gain = 0.5

[design.tuned]                       what other controllers than this leave open: controllers/equations/tuned.py
"""

from collections.abc import Mapping
from typing import Any

from design.settings.axis import read_axis
from design.settings.entries import count, entry
from design.settings.ranges import read_schedule, scheduling_loop
from design.settings.together import check_degrees, check_nyquist, check_period
from design.settings.wishes import LEAST_RELATIVE_GAIN, DesignSettings, MarginLimits
from design.structure import loops_of
from records.errors import BadInput
from records.loops import LOOPS
from records.table import range_keys
from records.text import checks
from sim.bind import BoundPlant

DEFAULTS: Mapping[str, float] = {
    "sample_period_s": 0.01,
    "operating_points": 17,
    "coefficient_degree": 3,
    "feedforward_degree": 2,
}

# Without a schedule there is one operating point, and every coefficient is a constant.
UNSCHEDULED: Mapping[str, float] = {"operating_points": 1, "coefficient_degree": 0, "feedforward_degree": 0}

# The limits refuse tables that do not fly, not tables that fly badly: taste in margins belongs to the plant file.
# Six times the sensitivity or 10 deg leave no room for the parameters' spread.
MARGIN_DEFAULTS: Mapping[str, float] = {
    "max_sensitivity": 6.0,
    "min_phase_margin_rad": 0.175,
    "min_relative_gain": LEAST_RELATIVE_GAIN,
}

# The least delay margin: two samples, [samples], cover a serial link's delay, which is never as long as 20 ms, [s]. A rig that needs 1 kHz
# stands no 20 ms: a ball under a magnet of 45 rad/s falls by e in that time.
DELAY_MARGIN_SAMPLES, DELAY_MARGIN_S = 2, 0.02


def read_settings(bound: BoundPlant) -> DesignSettings:
    """The settings in the plant's [design] section; raises BadInput naming key, range or pole that cannot be used."""
    section, where = bound.plant.design, bound.plant.section("design")
    loops = loops_of(bound)
    scheduling = scheduling_loop(section, loops, where)
    ranges = () if scheduling is None else range_keys(scheduling)
    names = [loop.axis for loop in loops]
    tuned = ("tuned",) if loops == LOOPS else ()  # the papers' controllers are the helicopter's
    checks.keys(section, where, (), (*DEFAULTS, "recursion_degree", "schedule", *ranges, *names, "margins", *tuned))
    schedule = None if scheduling is None else read_schedule(bound, section, scheduling, where)
    counts = DEFAULTS if schedule else {**DEFAULTS, **UNSCHEDULED}
    coefficient_degree = count(section, "coefficient_degree", where, counts)
    sample_period_s = checks.positive(entry(section, "sample_period_s", DEFAULTS), f"{where}.sample_period_s")
    settings = DesignSettings(
        sample_period_s=sample_period_s,
        schedule=schedule,
        operating_points=count(section, "operating_points", where, counts),
        coefficient_degree=coefficient_degree,
        recursion_degree=count(section, "recursion_degree", where, {"recursion_degree": coefficient_degree}),
        feedforward_degree=count(section, "feedforward_degree", where, counts),
        axes=tuple(read_axis(bound, section, loop, where, schedule) for loop in loops),
        margins=_margins(section, sample_period_s, f"{where}.margins"),
        loops=loops,
    )
    check_period(settings, where)
    check_degrees(settings, where)
    for name in names:
        check_nyquist(settings, name, where)
    return settings


def _margins(design: Mapping[str, Any], sample_period_s: float, where: str) -> MarginLimits:
    section = checks.table(design.get("margins", {}), where)
    defaults = {**MARGIN_DEFAULTS, "min_delay_margin_s": min(DELAY_MARGIN_SAMPLES * sample_period_s, DELAY_MARGIN_S)}
    checks.keys(section, where, (), tuple(defaults))
    values = {key: checks.number(entry(section, key, defaults), f"{where}.{key}") for key in defaults}
    if values["max_sensitivity"] <= 1.0:
        got = repr(values["max_sensitivity"])
        raise BadInput("margin", f"{where}.max_sensitivity", got, "a number above 1", "2 is usual, 6 barely flies")
    return MarginLimits(**values)
