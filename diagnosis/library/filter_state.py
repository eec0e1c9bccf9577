"""Effects that a filter carries as states of the equations where a simulation has a stage or a draw: a sensor's lag, a gust."""

from dataclasses import replace

from sim.composition.switch import sleeping, switch_name
from sim.effect import Effect
from sim.model import Model, ParameterSpec


def with_filter_state(model: Model, effect: Effect) -> Model:
    """The model with an effect's `filter_state`, which moves and is felt while the effect's switch is 1."""
    assert effect.filter_state is not None
    on = ParameterSpec(switch_name(effect), 1, "1")
    switch = on.symbols[0]
    model = replace(model, parameters=(*model.parameters, *effect.specs, on), switches=(*model.switches, switch))
    return sleeping(model, effect.filter_state.edit(model, switch, *effect.symbols), switch)
