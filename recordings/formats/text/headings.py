"""A column's heading as name and unit: `psi [deg]`, `Time(s)`, `U / V`, `angle, deg`, `angle - deg`, `angle in deg`."""

import re

from recordings.units import known

_BRACKETED = re.compile(r"(?P<name>.*?)\s*[\[({<](?P<unit>[^\[\](){}<>]*)[\])}>]\s*")
_BEFORE_BRACKET = re.compile(r"(?:[\s_:,/]|\s(?:in|en))+$")
# In front of a unit that stands without brackets; an underscore only where the unit is no word, as in q_deg/s.
_SIGN = re.compile(r"\s*(?:,|/|:|\b(?:in|en|i)\b| - |_(?=\w*\W))\s*(?=[^\s,/:])")
TIME = "time"  # the name of a heading that is a unit of time and nothing else, `in s`


def name_and_unit(heading: str) -> tuple[str, str]:
    """The name without its unit, and the unit; a text in round brackets or behind a sign is a unit only where it is a known one."""
    match = _BRACKETED.fullmatch(heading)
    if match and match["name"] and (known(match["unit"]) or re.search(r"\[[^\]]+\]\s*$", heading)):
        return _BEFORE_BRACKET.sub("", match["name"]) or match["name"], match["unit"].strip()
    for sign in _SIGN.finditer(heading):
        name, unit = heading[: sign.start()], heading[sign.end() :].strip()
        found = known(unit)
        if found and (name or found.si == "s"):
            return name or TIME, unit
    return heading, ""
