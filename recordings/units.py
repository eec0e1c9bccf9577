"""The units of other tools: one table, by which a signal converts to the SI unit of its column."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from math import pi

from records.text.units import dimension

# As MATLAB, Simulink, loggers and spreadsheets call it, in small letters and without its unit.
TIME_NAMES = frozenset(
    "t ts time times tout epoch timestamp timestamps time_stamp stamp elapsed elapsed_time datenum zeit temps tiempo tempo".split()  # noqa: SIM905
) | {"zeitstempel", "uhrzeit", "horodatage"}
DATE_NAMES = frozenset(("date", "datetime", "date_time", "datum", "fecha"))  # a clock where nothing else is one


@dataclass(frozen=True)
class Unit:
    """A unit: what it measures, as the SI unit that a column bears, how much of that it is, and its spellings.

    `suffixes` are those of its spellings that also end a name (psi_deg); fewer, as u_in is no length in inches and x_min no minutes.
    `per_turn` marks a count of an encoder, whose factor is 2 pi over the counts of a turn.
    """

    si: str
    factor: float
    spellings: tuple[str, ...]
    suffixes: tuple[str, ...] = ()
    per_turn: bool = False


# One row a unit. A spelling is compared without blanks; letters count as they stand where another unit differs by them alone (mN, MN).
UNITS = (
    Unit("rad", 1.0, ("rad", "radian", "radians"), ("rad",)),
    Unit("rad", 1e-3, ("mrad",), ("mrad",)),
    Unit("rad", pi / 180.0, ("deg", "degree", "degrees", "°", "º"), ("deg", "degree", "degrees", "°")),
    Unit("rad", pi / 10800.0, ("arcmin",), ("arcmin",)),
    Unit("rad", 2.0 * pi, ("rev", "revs", "turn", "turns", "revolution", "revolutions"), ("rev", "revs", "turns")),
    Unit(
        "rad",
        2.0 * pi,
        ("count", "counts", "cnt", "cnts", "tick", "ticks", "inc", "increments"),
        ("count", "counts", "cnt", "ticks"),
        per_turn=True,
    ),
    Unit("rad/s", 1.0, ("rad/s", "rad/sec", "rads^-1", "rad*s^-1", "radians/s"), ("rad_s", "radps")),
    Unit("rad/s", 1e-3, ("mrad/s",), ("mrad_s",)),
    Unit("rad/s", pi / 180.0, ("deg/s", "deg/sec", "°/s", "º/s", "dps", "degrees/s"), ("deg_s", "dps", "degps")),
    Unit("rad/s", pi / 30.0, ("rpm", "RPM", "1/min", "U/min", "min^-1", "r/min", "rev/min"), ("rpm", "RPM")),
    Unit("rad/s", 2.0 * pi, ("rev/s", "rps", "turns/s"), ("rps",)),
    Unit("rad/s", 2.0 * pi, ("counts/s", "cnt/s", "ticks/s"), ("counts_s", "ticks_s"), per_turn=True),
    Unit("rad/s^2", 1.0, ("rad/s^2", "rad/s²", "rad/s2", "rad/s/s"), ("rad_s2",)),
    Unit("rad/s^2", pi / 180.0, ("deg/s^2", "deg/s²", "deg/s2", "°/s^2", "°/s²", "deg/s/s"), ("deg_s2",)),
    Unit("m", 1.0, ("m", "meter", "meters", "metre", "metres"), ("m",)),
    Unit("m", 1e-2, ("cm",), ("cm",)),
    Unit("m", 1e-3, ("mm",), ("mm",)),
    Unit("m", 1e-6, ("um", "µm", "μm"), ("um",)),
    Unit("m", 1e3, ("km",), ("km",)),
    Unit("m", 0.3048, ("ft",), ("ft",)),
    Unit("m/s", 1.0, ("m/s", "m/sec", "m*s^-1", "ms^-1"), ("m_s", "mps")),
    Unit("m/s", 1e-3, ("mm/s",), ("mm_s",)),
    Unit("m/s", 1e-2, ("cm/s",), ("cm_s",)),
    Unit("m/s", 1.0 / 3.6, ("km/h", "kph", "kmh"), ("kmh", "kph")),
    Unit("m/s", 0.3048, ("ft/s",), ("ft_s",)),
    Unit("m/s", 1852.0 / 3600.0, ("kn", "kt", "kts", "knots"), ("kts", "knots")),
    Unit("m/s^2", 1.0, ("m/s^2", "m/s²", "m/s2", "m/s/s"), ("m_s2",)),
    Unit("m/s^2", 9.80665, ("g", "g0", "gn")),
    Unit("m/s^2", 9.80665e-3, ("mg",)),
    Unit("V", 1.0, ("V", "volt", "volts", "Volt", "Volts"), ("V", "volt", "volts")),
    Unit("V", 1e-3, ("mV", "millivolt", "millivolts"), ("mV",)),
    Unit("V", 1e-6, ("uV", "µV", "μV"), ("uV",)),
    Unit("V", 1e3, ("kV",), ("kV",)),
    Unit("A", 1.0, ("A", "amp", "amps", "ampere", "Ampere"), ("A", "amps")),
    Unit("A", 1e-3, ("mA",), ("mA",)),
    Unit("A", 1e-6, ("uA", "µA", "μA"), ("uA",)),
    Unit("N", 1.0, ("N", "newton", "Newton"), ("N",)),
    Unit("N", 1e-3, ("mN",), ("mN",)),
    Unit("N", 1e3, ("kN",), ("kN",)),
    Unit("N m", 1.0, ("Nm", "N*m", "N·m", "N.m"), ("Nm",)),
    Unit("N m", 1e-3, ("mNm", "mN*m", "mN·m", "Nmm", "N*mm"), ("mNm", "Nmm")),
    Unit("N m", 1e-2, ("Ncm", "N*cm", "N·cm"), ("Ncm",)),
    Unit("s", 1.0, ("s", "sec", "secs", "second", "seconds", "Sec"), ("s", "sec", "secs", "seconds")),
    Unit("s", 1e-3, ("ms", "msec", "millis", "millisecond", "milliseconds"), ("ms", "msec", "millis")),
    Unit("s", 1e-6, ("us", "µs", "μs", "usec", "micros", "microsecond", "microseconds"), ("us", "usec", "micros")),
    Unit("s", 1e-9, ("ns", "nsec", "nanos", "nanosecond", "nanoseconds"), ("ns", "nsec", "nanos")),
    Unit("s", 60.0, ("min", "mins", "minute", "minutes"), ("minutes",)),
    Unit("s", 3600.0, ("h", "hr", "hrs", "hour", "hours"), ("hours",)),
    Unit("s", 86400.0, ("day", "days"), ("days",)),
    Unit("1", 1.0, ("1", "-", "none", "dimensionless", "n/a"), ()),
    Unit("1", 1e-2, ("%", "percent", "pct"), ("percent", "pct")),
)
_BY_SPELLING: Mapping[str, Unit] = {spelling: unit for unit in UNITS for spelling in unit.spellings}
_BY_SUFFIX: Mapping[str, Unit] = {suffix: unit for unit in UNITS for suffix in unit.suffixes}


def known(spelling: str) -> Unit | None:
    """The unit of a spelling such as "deg", "mV" or "deg / s"; None for a text that the table does not have."""
    text = re.sub(r"\s+", "", spelling)
    return _BY_SPELLING.get(text) or _BY_SPELLING.get(text.lower())


def suffix_of(name: str) -> str:
    """The unit that a name ends in: "deg" of run1.psi_deg, psiDeg and psi.deg, "deg_s" of q_deg_s, empty where it ends in none."""
    return _parted(name)[1]


def without_suffix(name: str) -> str:
    """The last part of a name without the unit that it ends in: "psi" of run1.psi_deg and psiDeg."""
    return _parted(name)[0]


def _parted(name: str) -> tuple[str, str]:
    """The last part of a name without its unit, and that unit."""
    *path, last = re.split(r"[./\\]", name)
    last = re.sub(r"[\[(]\d+[\])]$", "", last)
    tokens = last.split("_")
    for count in (2, 1):
        suffix = "_".join(tokens[-count:])
        if len(tokens) > count and suffix in _BY_SUFFIX:
            return "_".join(tokens[:-count]), suffix
    if path and len(last) > 2 and last in _BY_SUFFIX:  # {"psi": {"deg": 11.5}}; log.um is a name
        return last, last
    humped = re.fullmatch(r"(.*[a-z0-9])([A-Z][a-z]+)", last)
    if humped and humped[2].lower() in _BY_SUFFIX:
        return humped[1], humped[2].lower()
    return last, ""


def unit_of_clock(name: str) -> str:
    """The unit of a clock's name: "millis" of run1.millis, "h" of time_h, empty where it is none; one letter alone may be anything."""
    last = re.split(r"[./\\]", name)[-1]
    stem, _, ending = last.rpartition("_")
    if stem.lower() in TIME_NAMES and ending in _BY_SPELLING and _BY_SPELLING[ending].si == "s":
        return ending
    return last if len(last) > 1 and last in _BY_SUFFIX and _BY_SUFFIX[last].si == "s" else ""


def unit_of_suffix(suffix: str) -> Unit:
    """The unit that a name's ending stands for; raises KeyError for another text."""
    return _BY_SUFFIX[suffix]


def factor_to(si: str, spelling: str, per_turn: float | None) -> float:
    """How many of the SI unit `si` one of `spelling` is; raises ValueError with what is missing, in a few words."""
    unit = known(spelling) or _BY_SUFFIX.get(spelling)
    if unit is None:
        return _coherent(si, spelling)
    if unit.si != si:
        raise ValueError(f"no factor from {spelling} to {si}")
    if not unit.per_turn:
        return unit.factor
    if per_turn is None:
        raise ValueError("the counts of one turn are not known: give them with --per-turn N")
    return unit.factor / per_turn


def _coherent(si: str, spelling: str) -> float:
    """1 for another spelling of the same SI unit, "kg m^2/s^2" for "N m"."""
    try:
        if dimension(spelling) == dimension(si):
            return 1.0
    except ValueError:
        pass
    raise ValueError(f"no factor from {spelling} to {si}")
