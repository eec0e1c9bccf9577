"""Plants with effects added, changed or taken away: what the diagnosis tries out."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace

from records.errors import BadInput
from records.pages import page
from records.plant import Parameter
from sim.bind import BoundPlant, bind
from sim.composition.build import carried, model_with, paths_with
from sim.composition.table import checked, effects_section, find_effect, plain_values
from sim.effect import Effect, Values, coefficient, place_and_kind
from sim.effects import effects_for
from sim.model import Model
from sim.plants import MODELS

Sizes = Mapping[str, Values]  # by effect and symbol


def library(bound: BoundPlant) -> Mapping[str, Effect]:
    """Every effect that the plant can have, by name."""
    return effects_for(bound.nominal)


def every_effect() -> Iterator[Effect]:
    """The effects of every plant of the table, plant after plant."""
    return (effect for model in MODELS.values() for effect in effects_for(model()).values())


def redundant(bound: BoundPlant, effect: Effect, spreads: float) -> bool:
    """Whether a parameter of the plant itself, within so many of its stated spreads, does what the effect does at its reference size: the
    effect is then nothing but another value of it. Of a parameter that is known better the effect is a change of the rig."""
    entry = bound.plant.parameters.get(effect.same_as)
    return entry is not None and spreads * max(entry.sds) >= abs(effect.size.reference)


def with_effects(bound: BoundPlant, values: Sizes, *, sd: Sizes | None = None, source: str = "added") -> BoundPlant:
    """The plant with exactly these effects: {"azimuth.cable_spring": {"k": 0.003, "angle_0": 0.0}}.

    A symbol that is not given takes its `first` value: no size, a middling shape. `sd` are standard deviations, 0 where not given. The
    model is the same object for the same set of names, so its kernel is compiled once. Raises BadInput for an unknown effect or symbol
    and for a value beyond its bounds.
    """
    where = bound.plant.section("effects")
    nominal = bound.nominal
    entries = {
        name: _entries(find_effect(nominal, name, where), given, (sd or {}).get(name, {}), source, f"{where}.{name}")
        for name, given in values.items()
    }
    return bind(replace(bound.plant, effects=effects_section(entries)))


def without_effects(bound: BoundPlant) -> BoundPlant:
    """The nominal plant: its parameters come first. A plant that has no effects is the same object, whose kernel may be made already."""
    if not bound.effects:
        return bound
    nominal = bound.nominal
    count = len(nominal.parameter_symbols)
    return BoundPlant(replace(bound.plant, effects={}), nominal, bound.p[:count], bound.sd[:count])


def linear_part(bound: BoundPlant) -> BoundPlant:
    """The plant that a linear design sees: with the effects on its equations, without those that bring states or act on a signal's way.

    What delays, lags, hysteresis or a springy part cost in margin is left to the flight. Raises BadInput as bind does.
    """
    if not bound.effects:
        return bound
    nominal = bound.nominal
    kept = {name: entries for name, entries in bound.effects.items() if _is_plain(nominal, name)}
    return bind(replace(bound.plant, effects=effects_section(kept)))


def combined(bound: BoundPlant, names: Iterable[str]) -> BoundPlant:
    """The plant with all these effects present at next to no size: it moves as the nominal one, with derivatives by each size.

    Each size stands a billionth of its reference away from where the effect vanishes: there friction already has its direction, and a
    dead band its sides. with_values then gives single effects real sizes without compiling again. Raises BadInput for an unknown effect.
    """
    known = library(bound)
    where = bound.plant.section("effects")
    nominal = bound.nominal
    chosen = [known.get(name) or find_effect(nominal, name, where) for name in names]
    return with_effects(bound, {effect.name: {p.symbol: p.touched for p in effect.parameters} for effect in chosen})


def with_values(bound: BoundPlant, values: Sizes) -> BoundPlant:
    """The same equations with other values of effects that `bound` already has; nothing is compiled.

    Raises BadInput for an effect or symbol that it does not have, and for a value beyond its bounds.
    """
    where = bound.plant.section("effects")
    nominal = bound.nominal
    changed = {name: dict(entries) for name, entries in bound.effects.items()}
    on_equations = carried(nominal, changed)
    p = bound.p.copy()
    for name, given in values.items():
        effect = find_effect(nominal, name, where)
        if name not in changed:
            raise BadInput(f"effect {name!r}", where, "not among those added", ", ".join(changed), "add it first")
        for symbol, value in given.items():
            _check_symbol(effect, symbol, f"{where}.{name}")
            value = checked(effect, symbol, float(value), f"{where}.{name}")
            changed[name][symbol] = replace(changed[name][symbol], value=value)
            if name in on_equations:
                p[coefficient_index(bound, name, symbol)] = value
    inputs, outputs = paths_with(nominal, plain_values(changed))
    plant = replace(bound.plant, effects=effects_section(changed))
    return replace(bound, plant=plant, p=p, effects=changed, input_path=inputs, output_path=outputs)


def coefficient_index(bound: BoundPlant, effect: str, symbol: str) -> int:
    """The place in `p` of a parameter of an effect on the equations; its column's name is coefficient(effect, symbol)."""
    names = [str(entry) for entry in bound.model.parameter_symbols]
    return names.index(coefficient(effect, symbol))


def _is_plain(nominal: Model, name: str) -> bool:
    on_sensor = place_and_kind(name)[0] in nominal.places.sensors
    return not on_sensor and bool(carried(nominal, (name,))) and not model_with(nominal, (name,)).starts


def _entries(effect: Effect, given: Values, sd: Values, source: str, where: str) -> Mapping[str, Parameter]:
    for symbol in (*given, *sd):
        _check_symbol(effect, symbol, where)
    return {
        parameter.symbol: Parameter(
            value=checked(effect, parameter.symbol, float(given.get(parameter.symbol, parameter.first)), where),
            sd=float(sd.get(parameter.symbol, 0.0)),
            unit=parameter.unit,
            source=source,
        )
        for parameter in effect.parameters
    }


def _check_symbol(effect: Effect, symbol: str, where: str) -> None:
    if symbol not in effect.parameter:
        known = ", ".join(effect.parameter)
        raise BadInput(
            f"parameter {symbol!r}", where, "an unknown name", f"one of {known}", f"see {page('effects.md')}"
        )
