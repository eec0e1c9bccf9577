"""A plant's equations with effects added to them, and the stages on the way of its signals."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from functools import lru_cache, reduce

import numpy as np
import sympy

from sim.composition.switch import switched
from sim.edits import with_input
from sim.effect import Effect, Values
from sim.effects import effects_for
from sim.model import Model
from sim.paths.input_stages import Memoryless
from sim.paths.path import Array, InputStage, OutputStage


@lru_cache(maxsize=256)
def model_with(nominal: Model, effects: tuple[str, ...]) -> Model:
    """The `nominal` model with the equations of `effects`, one object for each set: kernels and Jacobians are derived once.

    The order of the names does not matter. Effects that act on the way of a signal are left out.
    """
    library = effects_for(nominal)
    ordered = tuple(effect for effect in library if effect in carried(nominal, effects))
    if ordered != effects:
        return model_with(nominal, ordered)
    return reduce(_added, (library[effect] for effect in ordered), nominal)


@lru_cache(maxsize=16)
def switched_model(nominal: Model, effects: tuple[str, ...]) -> Model:
    """The same with a switch for each effect, so that those that are off take no time (switch.py)."""
    chosen = carried(nominal, effects)
    return switched(nominal, (effect for effect in effects_for(nominal).values() if effect.name in chosen))


def carried(nominal: Model, effects: Iterable[str]) -> tuple[str, ...]:
    """Those of `effects` that the equations carry: all but the stages, and but what stands before a lag or slew limit of the inputs."""
    library = effects_for(nominal)
    chosen = [library[name] for name in effects]
    late = any(_follows_equations(effect) for effect in chosen)
    return tuple(effect.name for effect in chosen if effect.on_equations and not (late and effect.applied is not None))


def paths_with(nominal: Model, values: Mapping[str, Values]) -> tuple[tuple[InputStage, ...], tuple[OutputStage, ...]]:
    """The stages that the inputs and the outputs pass with these effects, each in order."""
    library = effects_for(nominal)
    on_equations = carried(nominal, values)
    inputs: list[InputStage] = []
    outputs: list[OutputStage] = []
    chosen = [library[name] for name in reversed(list(library)) if name in values and name not in on_equations]
    for effect in chosen:
        given = values[effect.name]
        if effect.applied is not None:
            inputs.append(memoryless(nominal, effect, given))
        if effect.on_input is not None:
            inputs.append(effect.on_input(given))
        if effect.on_output is not None:
            outputs.append(effect.on_output(given))
    return tuple(sorted(inputs, key=lambda stage: stage.order)), tuple(sorted(outputs, key=lambda stage: stage.order))


def _follows_equations(effect: Effect) -> bool:
    """Whether an effect is a stage behind those that change an input without memory."""
    return effect.on_input is not None and effect.on_input(effect.absent).order > Memoryless.order


def _added(model: Model, effect: Effect) -> Model:
    model = replace(model, parameters=(*model.parameters, *effect.specs))
    if effect.applied is not None:
        return with_input(model, effect.applied(*effect.symbols))
    assert effect.edit is not None
    return effect.edit(model, *effect.symbols)


def memoryless(nominal: Model, effect: Effect, values: Values) -> Memoryless:
    """The stage that an effect without memory is on the way of the inputs."""
    assert effect.applied is not None
    function = _applied(nominal, effect.name)
    numbers = [values[parameter.symbol] for parameter in effect.parameters]

    def applied(u: Array) -> Array:
        columns = function(*u.T, *numbers)
        return np.column_stack([np.broadcast_to(np.asarray(column, dtype=float), len(u)) for column in columns])

    return Memoryless(applied)


@lru_cache(maxsize=256)
def _applied(nominal: Model, name: str) -> Callable[..., list[Array]]:
    effect = effects_for(nominal)[name]
    assert effect.applied is not None
    arrives = effect.applied(*effect.symbols)
    expressions = [arrives.get(variable, variable) for variable in nominal.inputs]
    # A step as NumPy has it: written as cases, each condition would first be simplified, which takes half a second.
    steps = {"Heaviside": np.heaviside}
    result: Callable[..., list[Array]] = sympy.lambdify(
        [*nominal.inputs, *effect.symbols], expressions, modules=[steps, "numpy"], cse=True
    )
    return result
