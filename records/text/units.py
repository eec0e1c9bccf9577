"""Units as text: enough to tell that "N m s^2" is "kg m^2" and that "kg m" is not."""

import math
import re
from collections.abc import Iterable, Mapping
from fractions import Fraction

Power = int | Fraction  # a valve's flow goes by the root of a pressure
Dimension = tuple[Power, Power, Power, Power, Power]  # of kg, m, s, V, K

_SYMBOLS: Mapping[str, Dimension] = {
    "kg": (1, 0, 0, 0, 0),
    "m": (0, 1, 0, 0, 0),
    "s": (0, 0, 1, 0, 0),
    "V": (0, 0, 0, 1, 0),
    "K": (0, 0, 0, 0, 1),
    "N": (1, 1, -2, 0, 0),
    "Pa": (1, -1, -2, 0, 0),
    "J": (1, 2, -2, 0, 0),
    "W": (1, 2, -3, 0, 0),
    "A": (1, 2, -3, -1, 0),  # W/V
    "Ohm": (-1, -2, 3, 2, 0),
    "H": (-1, -2, 4, 2, 0),
    "F": (1, 2, -2, -2, 0),
    "Hz": (0, 0, -1, 0, 0),
    "rad": (0, 0, 0, 0, 0),
    "1": (0, 0, 0, 0, 0),
    "-": (0, 0, 0, 0, 0),
}
# A longer one before its own ending: K_s is a rate of K, no time.
_PLAIN = ("rad", "Nm", "m3", "kg", "Pa", "m", "V", "A", "N", "K", "W")
_SUFFIXES = (*(f"{unit}{over}" for over in ("_s2", "_s", "") for unit in _PLAIN), "s")
_SAID = {"-": "", "1": "", "rad rad^-1": "per rad", "m m^-1": "per m"}
_FACTOR = re.compile(r"^([A-Za-z]+|1|-)(?:\^(-?\d+(?:\.5)?))?$")


def dimension(unit: str) -> Dimension:
    """Powers of (kg, m, s, V, K), whole or halves, of a product such as "rad s^-2 V^-1" or "m^3 s^-1 Pa^-0.5".

    A remark in parentheses is passed over. Only coherent SI symbols are known, so equal dimensions mean equal scale. Raises ValueError
    naming the symbol that is not known.
    """
    total: list[Power] = [0, 0, 0, 0, 0]
    for sign, part in _parts(re.sub(r"\([^)]*\)", " ", unit)):
        match = _FACTOR.match(part)
        if match is None or match[1] not in _SYMBOLS:
            raise ValueError(f"unit symbol {part!r} is not one of {', '.join(_SYMBOLS)}")
        power = sign * Fraction(match[2] or 1)
        for axis, exponent in enumerate(_SYMBOLS[match[1]]):
            total[axis] += power * exponent
    return total[0], total[1], total[2], total[3], total[4]


def dimensions(unit: str) -> tuple[Dimension, ...]:
    """Dimensions of a unit, or of each entry of a list of units "[N, N s]"."""
    text = unit.strip()
    if text.startswith("[") and text.endswith("]"):
        return tuple(dimension(entry) for entry in text[1:-1].split(","))
    return (dimension(text),)


def unit_suffix(name: str) -> str:
    """The unit that a name ends with: "rad" of psi_rad, "rad_s" of q_rad_s, "" of M, which has none."""
    return next((unit for unit in _SUFFIXES if name.endswith(f"_{unit}")), "")


def coherent(suffix: str) -> str:
    """A name's ending as a unit whose `dimension` can be told: "rad s^-2" of rad_s2, "N m" of Nm, "m^3" of m3."""
    whole, _, over = suffix.partition("_")
    return f"{whole.replace('Nm', 'N m').replace('m3', 'm^3')}{over and f' {over[0]}^-{over[1:] or 1}'}"


def unit_of(name: str) -> str:
    """The unit that a column's name ends in, as a person writes it; empty where it states none."""
    return unit_suffix(name).replace("_s2", "/s^2").replace("_s", "/s").replace("Nm", "N m")


def units_of(names: Iterable[str]) -> str:
    """The units of several columns, each once, as a person writes them: V, or W and N m; 1 where one states none."""
    return " and ".join(dict.fromkeys(unit_of(name) or "1" for name in names))


def plain_unit(unit: str) -> str:
    """A unit as one says it behind a number: nothing where that has none, "s^-1" of a rate "1 s^-1" of such a number."""
    return _SAID.get(unit, unit.removeprefix("1 "))


def said(name: str, value: float) -> str:
    """A value of this column as a person reads it: an angle in degrees, anything else in its unit."""
    if unit_suffix(name) == "rad":
        return f"{math.degrees(value):.1f} deg"
    return f"{value:.4g} {unit_of(name)}".rstrip()


def digits(value: float) -> str:
    """A number as a table shows it: two decimals, and three digits at least."""
    return f"{value:.2f}" if abs(value) >= 1.0 else f"{value:#.3g}"


def shown(name: str) -> tuple[str, float]:
    """The unit in which a person reads a column, degrees for an angle, and what one of its own is in that."""
    return ("deg", math.degrees(1.0)) if unit_suffix(name) == "rad" else (unit_of(name) or "1", 1.0)


def stem(name: str) -> str:
    """A column's name without its unit: "a_y" of a_y_m_s2."""
    suffix = unit_suffix(name)
    return name.removesuffix(f"_{suffix}") if suffix else name


def label(name: str) -> str:
    """A column's name as an axis shows it: "a_y [m/s^2]" of a_y_m_s2; one without a unit stays as it is."""
    return f"{stem(name)} [{unit_of(name)}]" if unit_suffix(name) else name


def _parts(unit: str) -> list[tuple[int, str]]:
    """Factors with +1 before the first "/" and -1 after it: "kg m^2/s" is kg m^2 s^-1."""
    upper, *lower = unit.replace("*", " ").split("/")
    return [(1, part) for part in upper.split()] + [(-1, part) for text in lower for part in text.split()]
