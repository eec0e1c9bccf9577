"""The units of other tools: one table, by which a signal converts to the SI unit of its column."""

import re
import unicodedata
from collections.abc import Mapping
from dataclasses import dataclass
from math import nan, pi

from records.text.units import dimension

# As MATLAB, Simulink, loggers and spreadsheets call it, in small letters and without its unit.
TIME_NAMES = frozenset(
    "t ts time times tout epoch timestamp timestamps time_stamp stamp elapsed elapsed_time datenum zeit temps tiempo tempo tid".split()  # noqa: SIM905
) | {"zeitstempel", "uhrzeit", "horodatage"}
DATE_NAMES = frozenset(("date", "datetime", "date_time", "datum", "fecha"))  # a clock where nothing else is one


@dataclass(frozen=True)
class Unit:
    """A unit: what it measures, as the SI unit that a column bears, how much of that it is, and its spellings.

    `words` are spellings in full, without accents: in any case, and at the end of a name too (psi_degrees). Of its `symbols` only
    `suffixes`, and those with letters beyond ASCII, end a name (psi_deg, t_µs): fewer, as u_in is no length in inches and x_min no
    minutes. `per_turn` marks a count of an encoder, whose factor is 2 pi over the counts of a turn. A unit of several meanings says them
    in `either`, and has no factor. `zero` is where it counts from, in the SI unit: what is one of it over a time counts from 0.
    """

    si: str
    factor: float
    symbols: tuple[str, ...]
    suffixes: tuple[str, ...] = ()
    words: tuple[str, ...] = ()
    per_turn: bool = False
    either: str = ""
    zero: float = 0.0


def _words(text: str) -> tuple[str, ...]:
    return tuple(text.split())


# One row a unit; words in English, German, French, Spanish and Swedish. A spelling is compared without blanks; letters count as they
# stand where another unit differs by them alone (mN, MN). What is one of these over a time has no row: deg/s, ticks/ms, mm/s^2.
UNITS = (
    Unit("rad", 1.0, ("rad",), ("rad",), _words("radian radians radiant radianes radianer bogenmass bogenmaß radiane")),
    Unit("rad", 1e-3, ("mrad",), ("mrad",), _words("milliradian milliradians milliradiant")),
    Unit("rad", 1e-6, ("urad", "µrad", "μrad"), ("urad",), _words("microradian microradians mikroradiant")),
    Unit(
        "rad",
        pi / 180.0,
        ("deg", "degs", "°", "º", "Grad", "Gr."),
        ("deg", "Grad"),
        _words("degree degrees degre degres grado grados grader altgrad winkelgrad"),
    ),
    Unit("rad", pi / 1.8e3, ("ddeg",), ("ddeg",), _words("decidegree decidegrees")),
    Unit("rad", pi / 1.8e4, ("cdeg",), ("cdeg",), _words("centidegree centidegrees")),
    Unit("rad", pi / 1.8e5, ("mdeg", "m°"), ("mdeg",), _words("millidegree millidegrees milligrad millideg")),
    Unit("rad", pi / 10800.0, ("arcmin",), ("arcmin",), _words("arcminute arcminutes winkelminuten")),
    Unit("rad", pi / 648000.0, ("arcsec",), ("arcsec",), _words("arcsecond arcseconds winkelsekunden")),
    Unit("rad", pi / 200.0, ("gon",), ("gon",), _words("gradian gradians neugrad")),
    Unit("rad", nan, ("grad",), ("grad",), either="degrees in some languages, 400 to a turn in others"),
    Unit(
        "rad",
        2.0 * pi,
        ("rev", "revs", "turn", "tour", "Umdr"),
        ("rev", "revs"),
        _words("turns revolution revolutions umdrehung umdrehungen tours vueltas revoluciones varv"),
    ),
    Unit(
        "rad",
        2.0 * pi,
        ("cnt", "cnts", "tick", "inc", "incs", "LSB", "lsb", "Ink"),
        ("cnt", "cnts", "lsb", "LSB"),
        _words(
            "count counts ticks increments codes digits inkremente impulse impulsions cuentas pulsos "
            "impulsos pulses pulser inkrement"
        ),
        per_turn=True,
    ),
    Unit("rad/s", 1.0, (), ("rad_s", "radps", "rads")),
    Unit("rad/s", pi / 180.0, ("dps",), ("dps", "degps")),
    Unit("rad/s", pi / 1.8e5, ("mdps",), ("mdps",)),
    Unit(
        "rad/s",
        pi / 30.0,
        ("rpm", "RPM", "1/min", "min^-1", "min-1", "upm", "Upm", "UPM", "U/min", "tr/min", "r/min", "o/min", "/min"),
        ("rpm", "upm"),
    ),
    Unit("rad/s", 1e3 * pi / 30.0, ("krpm", "kRPM", "kU/min"), ("krpm",)),
    Unit("rad/s", 2.0 * pi, ("rps", "Hz", "hz", "U/s", "r/s", "cps"), ("rps", "Hz", "hz"), _words("hertz")),
    Unit("rad/s", 2e3 * pi, ("kHz", "khz"), ("kHz",), _words("kilohertz")),
    Unit("rad/s", nan, ("1/s", "s^-1", "s-1", "/s"), either="radians a second or turns a second"),
    Unit("rad/s^2", 1.0, (), ("rad_s2",)),
    Unit("m", 1.0, ("m",), ("m",), _words("meter meters metre metres metro metros")),
    Unit("m", 1e-1, ("dm",), ("dm",)),
    Unit("m", 1e-2, ("cm",), ("cm",), _words("centimeter centimeters centimetre centimetres zentimeter centimetros")),
    Unit("m", 1e-3, ("mm",), ("mm",), _words("millimeter millimeters millimetre millimetres milimetros")),
    Unit("m", 1e-6, ("um", "µm", "μm"), ("um",), _words("micrometer micrometers micrometre micrometres mikrometer")),
    Unit("m", 1e3, ("km",), ("km",)),
    Unit("m", 0.0254, ("inch", "inches", '"'), ("inch", "inches")),
    Unit("m", 0.3048, ("ft",), ("ft",)),
    Unit("m/s", 1.0, ("ms^-1",), ("m_s", "mps")),
    Unit("m/s", 1.0 / 3.6, ("kph", "kmh"), ("kmh", "kph")),
    Unit("m/s", 1852.0 / 3600.0, ("kn", "kt", "kts"), ("kts",), _words("knots")),
    Unit("m/s^2", 1.0, (), ("m_s2",)),
    Unit("m/s^2", 9.80665, ("g", "g0", "gn")),
    Unit("m/s^2", 9.80665e-3, ("mg",)),
    Unit("V", 1.0, ("V",), ("V",), _words("volt volts voltio voltios")),
    Unit("V", 1e-3, ("mV",), ("mV",), _words("millivolt millivolts milivoltios")),
    Unit("V", 1e-6, ("uV", "µV", "μV"), ("uV",), _words("microvolt microvolts mikrovolt")),
    Unit("V", 1e3, ("kV",), ("kV",), _words("kilovolt kilovolts")),
    Unit("A", 1.0, ("A", "amp"), ("A",), _words("amps ampere amperes amperio amperios")),
    Unit("A", 1e-3, ("mA",), ("mA",), _words("milliamp milliamps milliampere milliamperes miliamperios")),
    Unit("A", 1e-6, ("uA", "µA", "μA"), ("uA",), _words("microampere microamperes mikroampere")),
    Unit("N", 1.0, ("N",), ("N",), _words("newton newtons")),
    Unit("N", 1e-3, ("mN",), ("mN",), _words("millinewton millinewtons")),
    Unit("N", 1e3, ("kN",), ("kN",)),
    Unit("N m", 1.0, ("Nm", "N*m", "N.m"), ("Nm",), _words("newtonmeter newtonmeters newtonmetre")),
    Unit("N m", 1e-3, ("mNm", "mN*m", "mN.m", "Nmm", "N*mm"), ("mNm", "Nmm"), _words("millinewtonmeter")),
    Unit("N m", 1e-2, ("Ncm", "N*cm", "N.cm"), ("Ncm",)),
    Unit("K", 1.0, ("K",), ("K",), _words("kelvin kelvins")),
    Unit("K", 1e-3, ("mK",), ("mK",), _words("millikelvin")),
    Unit("K", 1.0, ("degC", "°C", "ºC", "℃", "C"), ("degC",), _words("celsius centigrade gradcelsius"), zero=273.15),
    Unit("K", 5.0 / 9.0, ("degF", "°F", "ºF", "℉"), ("degF",), _words("fahrenheit"), zero=273.15 - 32.0 * 5.0 / 9.0),
    Unit("W", 1.0, ("W",), ("W",), _words("watt watts")),
    Unit("W", 1e-3, ("mW",), ("mW",), _words("milliwatt milliwatts")),
    Unit("W", 1e3, ("kW",), ("kW",), _words("kilowatt kilowatts")),
    Unit(
        "s",
        1.0,
        ("s", "sec", "secs", "sek", "seg", "second"),
        ("s", "sec", "secs", "sek"),
        _words("seconds sekunde sekunden seconde secondes segundo segundos sekund sekunder"),
    ),
    Unit(
        "s",
        1e-3,
        ("ms", "msec", "msek"),
        ("ms", "msec"),
        _words(
            "millis millisecond milliseconds millisekunde millisekunden milliseconde millisecondes milisegundo milisegundos "
            "millisekund millisekunder"
        ),
    ),
    Unit(
        "s",
        1e-6,
        ("us", "µs", "μs", "usec", "µsec", "μsec"),
        ("us", "usec"),
        _words(
            "micros microsecond microseconds mikrosekunde mikrosekunden microseconde microsecondes microsegundo microsegundos "
            "mikrosekund mikrosekunder"
        ),
    ),
    Unit(
        "s",
        1e-9,
        ("ns", "nsec"),
        ("ns", "nsec"),
        _words(
            "nanos nanosecond nanoseconds nanosekunde nanosekunden nanoseconde nanosecondes nanosegundos nanosekunder"
        ),
    ),
    Unit("s", 60.0, ("min", "mins", "minute"), (), _words("minutes minuten minutos minuter")),
    Unit("s", 3600.0, ("h", "hr", "hrs", "hour", "Std"), (), _words("hours stunden heures horas timmar")),
    Unit("s", 86400.0, ("d", "day"), (), _words("days tage jours dias dagar")),
    Unit("1", 1.0, ("1", "-", "none", "dimensionless", "n/a"), ()),
    Unit("1", 1e-2, ("%", "pct"), ("pct",), _words("percent prozent pourcent porcentaje procent")),
    Unit("1", 1e-3, ("‰",), (), _words("permille permil promille")),
    Unit("1", 1e-6, ("ppm",), ("ppm",)),
)
# What each is over a second.
_RATES = {unit: f"{unit}/s" for unit in ("rad", "m", "V", "A", "N", "N m", "K", "W")} | {
    "rad/s": "rad/s^2",
    "m/s": "m/s^2",
}
_BY_SPELLING: Mapping[str, Unit] = {spelling: unit for unit in UNITS for spelling in (*unit.symbols, *unit.words)}
_BY_SUFFIX: Mapping[str, Unit] = {
    suffix: unit
    for unit in UNITS
    for suffix in (*unit.suffixes, *unit.words, *(s for s in unit.symbols if not s.isascii()))
}
_OVER = re.compile(r"(.+)(?:/|per|pro|par|por)([^/^\d]+)(?:\^?([12]))?")  # deg/s^2, deg/s/s, Grad pro Sekunde
_ENDING_OVER = re.compile(r"(.+?)_((?:per|pro)_)?([A-Za-z]+)([2]?)")  # deg_s, Grad_pro_s, mm_s2
_TIMES_INVERSE = re.compile(r"(.+?)\*?(ms|s|sec|min|h)\^?-([12])")  # rad*s^-1, and rad s-1 without its blank
_SUPERSCRIPTS = str.maketrans({"⁻": "-", "¹": "1", "²": "2", "·": "*", "⋅": "*"})


def known(spelling: str) -> Unit | None:
    """The unit of a spelling such as "deg", "mV", "deg / s" or "Grad pro Sekunde"; None for a text that the table does not have."""
    text = _plain(spelling)
    return _spelt(text) or _over_time(text)


def _plain(spelling: str) -> str:
    """A spelling without blanks, an abbreviation's point, superscripts and, in a word, accents."""
    text = re.sub(r"\s+", "", spelling).translate(_SUPERSCRIPTS)
    text = text.rstrip(".") if len(text) > 2 else text
    marks = unicodedata.normalize("NFD", text)
    return "".join(c for c in marks if not unicodedata.combining(c)) if len(text) > 3 else text


def _spelt(text: str) -> Unit | None:
    return _BY_SPELLING.get(text) or _BY_SPELLING.get(text.lower())


def _over_time(text: str) -> Unit | None:
    """The unit that is another over a time, or over its square."""
    match = _OVER.fullmatch(text) or _TIMES_INVERSE.fullmatch(text)
    if match is None:
        return None
    upper, lower = known(match[1]), _spelt(match[2])
    return _rate(upper, lower, int(match[3] or 1)) if upper and lower else None


def _rate(upper: Unit, lower: Unit, power: int) -> Unit | None:
    """`upper` over a time `lower`, so many times; None for what is no rate."""
    if lower.si != "s" or upper.si not in _RATES:
        return None
    over = Unit(_RATES[upper.si], upper.factor / lower.factor, (), per_turn=upper.per_turn, either=upper.either)
    return over if power == 1 else _rate(over, lower, power - 1)


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
    for count in (3, 2, 1):
        suffix = "_".join(tokens[-count:])
        if len(tokens) > count and _ending(suffix):
            return "_".join(tokens[:-count]), suffix
    if path and len(last) > 2 and _ending(last):  # {"psi": {"deg": 11.5}}; log.um is a name
        return last, last
    humped = re.fullmatch(r"(.*[a-z0-9])([A-Z][a-z]+)", last)
    if humped and _ending(humped[2]):
        return humped[1], humped[2] if humped[2] in _BY_SUFFIX else humped[2].lower()
    return last, ""


def _ending(suffix: str) -> Unit | None:
    """The unit that a name's ending stands for, in capitals too unless it is one letter; `deg_s`, `deg_per_s`, `mm_s2` over a time."""
    plain = _plain(suffix)
    found = _BY_SUFFIX.get(plain) or (_BY_SUFFIX.get(plain.lower()) if len(plain) > 1 else None)
    match = None if found else _ENDING_OVER.fullmatch(plain)
    if match is None:
        return found
    upper, lower = _ending(match[1]), _spelt(match[3]) if match[2] else _ending(match[3])  # `per_min` is no least value
    return _rate(upper, lower, int(match[4] or 1)) if upper and lower else None


def unit_of_clock(name: str) -> str:
    """The unit of a clock's name: "millis" of run1.millis, "h" of time_h, empty where it is none; one letter alone may be anything."""
    last = re.split(r"[./\\]", name)[-1]
    stem, _, ending = last.rpartition("_")
    behind, alone = known(ending) if ending else None, _ending(last) if len(last) > 1 else None
    if stem.lower() in TIME_NAMES and behind and behind.si == "s":
        return ending
    return last if alone and alone.si == "s" else ""


def unit_of_suffix(suffix: str) -> Unit:
    """The unit that a name's ending stands for; raises KeyError for another text."""
    unit = _ending(suffix)
    if unit is None:
        raise KeyError(suffix)
    return unit


def with_own_zero(spelling: str) -> Unit | None:
    """The unit of a spelling that counts from elsewhere than 0 of its SI unit, as degC does; None for any other."""
    unit = known(spelling) or _ending(spelling)
    return unit if unit and unit.zero else None


class CountsUnknown(ValueError):
    """A count of an encoder has no factor, as nobody said how many are one turn."""


def factor_to(si: str, spelling: str, per_turn: float | None) -> float:
    """How many of the SI unit `si` one of `spelling` is; raises ValueError with what is missing, in a few words."""
    unit = known(spelling) or _ending(spelling)
    if unit is None:
        return _coherent(si, spelling)
    if unit.si != si:
        raise ValueError(f"no factor from {spelling} to {si}")
    if unit.either:
        raise ValueError(f"{spelling} may be {unit.either}")
    if unit.zero:
        raise ValueError(
            f"{spelling} counts from {unit.zero:.6g} {si}, the column from 0 {si} or from a temperature of its own"
        )
    if not unit.per_turn:
        return unit.factor
    if per_turn is None:
        raise CountsUnknown("the counts of one turn are not known: give them with --per-turn N")
    return unit.factor / per_turn


def _coherent(si: str, spelling: str) -> float:
    """1 for another spelling of the same SI unit, "kg m^2/s^2" for "N m"."""
    try:
        if dimension(spelling) == dimension(si):
            return 1.0
    except ValueError:
        pass
    raise ValueError(f"no factor from {spelling} to {si}")
