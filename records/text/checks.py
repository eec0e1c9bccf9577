"""Checks that every record shares when it is read from a file: kinds, keys, finite numbers; each failure is one BadInput."""

import math
from collections.abc import Iterable, Mapping
from typing import Any

from records.errors import BadInput


def table(value: Any, where: str) -> Mapping[str, Any]:
    """`value` as a mapping; raises BadInput otherwise."""
    if not isinstance(value, Mapping):
        raise BadInput("a table", where, _shown(value), "key = value pairs", "write it as a section of the file")
    return value


def keys(section: Mapping[str, Any], where: str, required: Iterable[str], optional: Iterable[str] = ()) -> None:
    """Refuse a missing or an unknown key of `section`; raises BadInput that names it."""
    required, optional = tuple(required), tuple(optional)
    for key in required:
        if key not in section:
            raise BadInput(f"key {key!r}", where, "nothing", "a value", f"add {key!r}")
    for key in section:
        if key not in required and key not in optional:
            known = ", ".join(repr(name) for name in dict.fromkeys((*required, *optional)))
            raise BadInput(
                f"key {_shown(key)}", where, "an unknown key", f"one of {known}", f"remove or rename {_shown(key)}"
            )


def text(value: Any, where: str) -> str:
    """`value` as a non-empty string; raises BadInput otherwise."""
    if not isinstance(value, str) or not value.strip():
        raise BadInput("text", where, _shown(value), "a non-empty string", "write it in quotes")
    return value


def number(value: Any, where: str) -> float:
    """`value` as a finite float; raises BadInput otherwise."""
    try:
        result = math.nan if isinstance(value, bool) or not isinstance(value, int | float) else float(value)
    except OverflowError:  # a whole number beyond the largest float
        result = math.inf
    if not math.isfinite(result):
        raise BadInput("number", where, _shown(value), "a finite number", "write a plain decimal number in SI units")
    return result


def positive(value: Any, where: str) -> float:
    """`value` as a finite float above zero; raises BadInput otherwise."""
    result = number(value, where)
    if result <= 0.0:
        raise BadInput("number", where, _shown(value), "a number above 0", "check its sign and unit")
    return result


def numbers(value: Any, where: str, length: int | None = None) -> tuple[float, ...]:
    """`value` as a tuple of finite floats, of the given length if one is given; raises BadInput otherwise."""
    if not isinstance(value, list | tuple):
        raise BadInput("list of numbers", where, _shown(value), "a list", "write [a, b, ...]")
    if length is not None and len(value) != length:
        raise BadInput("list of numbers", where, f"{len(value)} entries", f"{length} entries", "check the degree")
    return tuple(number(entry, f"{where}[{index}]") for index, entry in enumerate(value))


def schema(section: Mapping[str, Any], where: str, expected: str) -> None:
    """Refuse a file of another kind or version; raises BadInput."""
    found = section.get("schema")
    if found != expected:
        got = _shown(found) if "schema" in section else "nothing"
        raise BadInput("schema", where, got, repr(expected), "give a file of this kind and version")


def _shown(value: Any) -> str:
    try:
        shown = repr(value)
    except (
        ValueError,
        RecursionError,
    ):  # Python writes no whole number of more than 4300 digits, nor endless lists in lists
        return "more than can be shown"
    return shown if len(shown) <= 60 else f"{shown[:57]}..."
