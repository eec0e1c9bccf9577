"""A plant's equations with effects added to them."""

from dataclasses import replace
from functools import lru_cache

from sim.effects import effects_for
from sim.effects.edits import with_input
from sim.effects.effect import Effect
from sim.model import Model
from sim.plants import MODELS


@lru_cache(maxsize=256)
def model_with(name: str, effects: tuple[str, ...]) -> Model:
    """The model `name` with the equations of `effects`, one object for each set: kernels and Jacobians are derived once.

    The order of the names does not matter. Effects that act on the way of a signal are left out.
    """
    nominal = MODELS[name]()
    library = effects_for(nominal)
    ordered = tuple(effect for effect in library if effect in effects and library[effect].on_equations)
    if ordered != effects:
        return model_with(name, ordered)
    model = nominal
    for effect in ordered:
        model = _added(model, library[effect])
    return model


def _added(model: Model, effect: Effect) -> Model:
    model = replace(model, parameters=(*model.parameters, *effect.specs))
    if effect.applied is not None:
        return with_input(model, effect.applied(*effect.symbols))
    assert effect.edit is not None
    return effect.edit(model, *effect.symbols)
