"""The section [effects] of a plant file: [effects.PLACE.NAME.SYMBOL] with value, sd, unit and source."""

import difflib
from collections.abc import Mapping
from typing import Any

from records.errors import BadInput
from records.pages import page
from records.plant import Parameter, parameter_entry
from records.text import checks
from records.text.units import dimensions
from sim.effect import Effect, EffectParameter, place_and_kind
from sim.effects import effects_for
from sim.model import Model

Entries = Mapping[str, Mapping[str, Parameter]]  # by effect and symbol


def read_effects(section: Mapping[str, Any], model: Model, where: str) -> Entries:
    """The effects of a plant file, checked against the library of its nominal `model`.

    Raises BadInput for a place or an effect that the plant does not have, for a missing or unknown parameter, for a wrong unit, and
    for a value beyond its bounds.
    """
    found: dict[str, Mapping[str, Parameter]] = {}
    for place, kinds in section.items():
        _check_place(place, model, where)
        for kind, parameters in checks.table(kinds, f"{where}.{place}").items():
            effect = find_effect(model, f"{place}.{kind}", where)
            found[effect.name] = _read(effect, parameters, f"{where}.{effect.name}")
    return found


def find_effect(model: Model, name: str, where: str) -> Effect:
    """The effect `name` of the library for `model`; raises BadInput with the nearest names when there is none."""
    library = effects_for(model)
    if name in library:
        return library[name]
    place = place_and_kind(name)[0]
    _check_place(place, model, where)
    near = difflib.get_close_matches(name, library, 4, 0.5) or [other for other in library if other.startswith(place)]
    raise BadInput(
        f"effect {name!r}", where, "no effect of the library", f"such as {', '.join(near)}", f"see {page('effects.md')}"
    )


def effects_section(entries: Entries) -> dict[str, Any]:
    """The section of a plant file that read_effects reads back."""
    section: dict[str, dict[str, Any]] = {}
    for name, parameters in entries.items():
        place, kind = place_and_kind(name)
        section.setdefault(place, {})[kind] = {
            symbol: {"value": entry.value, "sd": entry.sd, "unit": entry.unit, "source": entry.source}
            for symbol, entry in parameters.items()
        }
    return section


def plain_values(entries: Entries) -> dict[str, dict[str, float]]:
    """The values alone, by effect and symbol."""
    return {name: {symbol: entry.values[0] for symbol, entry in given.items()} for name, given in entries.items()}


def checked(effect: Effect, symbol: str, value: float, where: str) -> float:
    """`value` of one parameter; raises BadInput when it lies beyond its bounds."""
    bounds = effect.parameter[symbol]
    if not bounds.lower <= value <= bounds.upper:
        expected = f"{bounds.lower:g} to {bounds.upper:g} {bounds.unit}"
        raise BadInput("value", f"{where}.{symbol}", repr(value), expected, "check the value and its unit")
    return value


def _check_place(place: str, model: Model, where: str) -> None:
    if place not in model.places.names:
        places = ", ".join(model.places.names)
        raise BadInput(
            f"place {place!r}", where, f"no place of model {model.name!r}", f"one of {places}", "put it where it acts"
        )


def _read(effect: Effect, section: Any, where: str) -> Mapping[str, Parameter]:
    table = checks.table(section, where)
    refining = [parameter.symbol for parameter in effect.parameters if parameter.refining]
    checks.keys(table, where, [symbol for symbol in effect.parameter if symbol not in refining], refining)
    entries = {}
    for parameter in effect.parameters:
        if parameter.symbol not in table:
            entries[parameter.symbol] = Parameter(0.0, 0.0, parameter.unit, "the plain formula")
            continue
        entry = parameter_entry(table[parameter.symbol], f"{where}.{parameter.symbol}")
        _check(effect, parameter, entry, where)
        entries[parameter.symbol] = entry
    return entries


def _check(effect: Effect, parameter: EffectParameter, entry: Parameter, where: str) -> None:
    at = f"{where}.{parameter.symbol}"
    if isinstance(entry.value, tuple):
        raise BadInput("value", at, f"{len(entry.value)} coefficients", "one number", "write a plain number")
    if dimensions(entry.unit) != dimensions(parameter.unit):
        raise BadInput("unit", at, repr(entry.unit), repr(parameter.unit), "convert the value to that unit")
    checked(effect, parameter.symbol, entry.value, where)
