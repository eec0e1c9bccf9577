"""A column's heading as name and unit: `psi [deg]`, `Time(s)`, `U / V`, `angle, deg`, `angle in deg`."""

import re

from recordings.units import known

_BRACKETED = re.compile(r"(?P<name>.*?)\s*[\[({](?P<unit>[^\[\](){}]*)[\])}]\s*")
_BARE = re.compile(r"(?P<name>.*?)\s*(?:,|/|:|\bin\b)\s*(?P<unit>[^\s,/:].*)")


def name_and_unit(heading: str) -> tuple[str, str]:
    """The name without its unit, and the unit; a text in round brackets or behind a sign is a unit only where it is a known one."""
    match = _BRACKETED.fullmatch(heading)
    if match and match["name"] and (known(match["unit"]) or re.search(r"\[[^\]]+\]\s*$", heading)):
        return match["name"], match["unit"].strip()
    match = _BARE.fullmatch(heading)
    if match and match["name"] and known(match["unit"]):
        return match["name"], match["unit"].strip()
    return heading, ""
