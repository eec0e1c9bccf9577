"""Initial states that a person types in, flight by flight, to try them by hand (seed 003, 2.3.3.1): a file of TOML sections.

    schema = "starts/1"
    [HA6000ft-50kts-level-longitudinal-0]
    q_rad_s = 0.012
    theta_rad = 0.031

A section is named as a flight, a key as a column of its record, in its unit; the value is that of the flight's first row, trim and all.
What is not named stays as measured.
"""

from collections.abc import Mapping, Sequence
from difflib import get_close_matches
from pathlib import Path
from types import MappingProxyType
from typing import Any

from identification.envelope.flights.flight import STATES, Flight
from identification.margins import MARGINS
from records.errors import BadInput
from records.text import checks
from records.text.reading import read_toml

SCHEMA = "starts/1"
Starts = Mapping[str, Mapping[str, float]]  # value by state, by flight
NONE: Starts = MappingProxyType({})


def load_starts(path: Path, flights: Sequence[Flight]) -> Starts:
    """Read the starts of some of `flights`.

    Raises BadInput for an unknown flight or state, for what is no number, and for a start more than a margin of Table 1.1 away from the
    measured one: its run would begin outside, so its unit or its flight is wrong.
    """
    content, where = read_toml(path, "starts"), str(path)
    checks.schema(content, where, SCHEMA)
    sections = {name: section for name, section in content.items() if name != "schema"}
    if not sections:
        raise BadInput("starts", where, "no flight", "a section [FLIGHT] with STATE = VALUE", "add one for each flight")
    known = {flight.name: flight for flight in flights}
    return {
        name: _starts(section, f"{where}: [{name}]", _flight(name, known, where)) for name, section in sections.items()
    }


def _flight(name: str, known: Mapping[str, Flight], where: str) -> Flight:
    if name not in known:
        near = (get_close_matches(name, known, 1, 0.0) or ["no flights at all"])[0]
        raise BadInput(
            f"flight {name!r}", where, "an unknown name", f"one of {len(known)} flights, say {near!r}", "correct it"
        )
    return known[name]


def _starts(section: Any, where: str, flight: Flight) -> Mapping[str, float]:
    table = checks.table(section, where)
    checks.keys(table, where, (), STATES)
    if not table:
        raise BadInput(
            "starts", where, "no state", f"one of {', '.join(STATES)}", "type one in, or take the section out"
        )
    found = {}
    for name, value in table.items():
        found[name] = checks.number(value, f"{where}: {name}")
        measured, margin = float(flight.x[0, STATES.index(name)]), MARGINS[flight.mission][name]
        if abs(found[name] - measured) > margin:
            raise BadInput(
                "start", f"{where}: {name}", f"{found[name]:g}",
                f"{measured - margin:.4g} to {measured + margin:.4g}, a margin to either side of the measured {measured:.4g}",
                "check its unit and its sign",
            )  # fmt: skip
    return found
