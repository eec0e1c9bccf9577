"""Single entries of the section, as stated or as their defaults say."""

from collections.abc import Mapping
from typing import Any

from records.errors import BadInput


def entry(section: Mapping[str, Any], key: str, defaults: Mapping[str, Any]) -> Any:
    """As the section states it, or by default."""
    return section[key] if key in section else defaults[key]


def count(section: Mapping[str, Any], key: str, where: str, defaults: Mapping[str, float]) -> int:
    """A whole number of 0 or more."""
    value = entry(section, key, defaults)
    if isinstance(value, bool) or not isinstance(value, int) or value < 0:
        raise BadInput(
            "count", f"{where}.{key}", repr(value), "a whole number of 0 or more", "write it without a point"
        )
    return value
