"""The words of a diagnosis: names, numbers and probabilities as a person who knows only the rig reads them."""

import math
from collections.abc import Mapping, Sequence

# By the unit at the end of a name: how a person reads it.
_SHOWN = {
    "_rad": ("deg", 180.0 / math.pi),
    "_rad_s": ("deg/s", 180.0 / math.pi),
    "_m": ("mm", 1e3),
    "_m_s": ("mm/s", 1e3),
    "_V": ("V", 1.0),
}
_KINDS = {"coulomb": "Coulomb friction", "stribeck": "Stribeck friction", "coriolis": "Coriolis torque"}
LISTED = 3  # names in one cell
LEAST_CHANCE = 1e-6  # smaller ones are said to be below it: no model of noise is good for more


def plain_text(value: object) -> str:
    """What a record holds under a key, in one line."""
    if isinstance(value, Mapping):
        return "; ".join(f"{name}: {plain_text(entry)}" for name, entry in value.items())
    if isinstance(value, list | tuple):
        return ", ".join(plain_text(entry) for entry in value)
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def words(name: str) -> str:
    """ "azimuth.cable_spring" as "cable spring of the azimuth", several with "and"."""
    parts = [part.replace("_", " ").partition(".") for part in name.split(" + ")]
    parts = [(place, dot, _KINDS.get(effect, effect)) for place, dot, effect in parts]
    return " and ".join(f"{effect} of the {place}" if effect else f"the {place}" for place, _, effect in parts)


def listed(names: Sequence[str]) -> str:
    """The first few of the names, and how many more."""
    more = f" and {len(names) - LISTED} more" if len(names) > LISTED else ""
    return "; ".join(names[:LISTED]) + more


def chance(p: float) -> str:
    """A probability that may be very small."""
    return f"{p:.2g}" if p >= LEAST_CHANCE else f"below {LEAST_CHANCE:g}"


def percent(share: float) -> str:
    """A share, certain ones as close to it as one may say."""
    if 0.9995 < share < 1.0:
        return "> 99.9 %"
    return f"{100 * share:.1f} %" if share >= 0.001 or share == 0.0 else "< 0.1 %"


def shown(name: str) -> tuple[str, str, float]:
    """Name without its unit, the unit a person reads, and the factor to it."""
    for suffix, (unit, scale) in _SHOWN.items():
        if name.endswith(suffix):
            return name.removesuffix(suffix), f"[{unit}]", scale
    return name, "", 1.0
