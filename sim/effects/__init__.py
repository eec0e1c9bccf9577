"""A plant's nominal model in; the library of effects out: physics that a rig may have and its model lacks, one file an effect or family."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from functools import lru_cache

from sim.effect import Effect
from sim.effects import (
    axial_inflow,
    backlash,
    bristles,
    cable_spring,
    coulomb,
    creep,
    deadzone,
    delay,
    disturbance,
    downwash,
    driver_asymmetry,
    dropped_frames,
    end_stop,
    flexible_mode,
    friction_asymmetry,
    gain_and_offset,
    gravity,
    ground_effect,
    gust,
    gyroscopic,
    hysteresis,
    imbalance,
    inertia,
    lag,
    level_axis,
    load_friction,
    missed_counts,
    quadratic_drag,
    quantization,
    reaction,
    reverse_asymmetry,
    reverse_drag,
    rotor_dry_friction,
    saturation,
    sensor_map,
    slew_limit,
    stribeck,
    supply_sag,
    thrust_law,
    warmup,
    waves,
)
from sim.model import Model

# The only place that names them all. Effects are added to a model in this order, the innermost first: what changes an input comes last, so
# that a changed rotor is driven by the changed input. Stages on the way of a signal know their own order.
FAMILIES: tuple[Callable[[Model], Iterable[Effect]], ...] = (
    sensor_map.effects,
    flexible_mode.effects,
    missed_counts.effects,
    imbalance.effects,
    coulomb.effects,
    stribeck.effects,
    load_friction.effects,
    friction_asymmetry.effects,
    creep.effects,
    bristles.effects,
    hysteresis.effects,
    quadratic_drag.effects,
    cable_spring.effects,
    gravity.effects,
    level_axis.effects,
    end_stop.effects,
    disturbance.effects,
    gust.effects,
    waves.effects,
    inertia.effects,
    gyroscopic.effects,
    axial_inflow.effects,
    ground_effect.effects,
    reverse_asymmetry.effects,
    reverse_drag.effects,
    downwash.effects,
    thrust_law.effects,
    warmup.effects,
    rotor_dry_friction.effects,
    reaction.effects,
    deadzone.effects,
    saturation.effects,
    supply_sag.effects,
    driver_asymmetry.effects,
    gain_and_offset.effects,
    slew_limit.effects,
    lag.effects,
    quantization.effects,
    delay.effects,
    dropped_frames.effects,
    backlash.effects,
)


@lru_cache(maxsize=64)
def effects_for(model: Model) -> Mapping[str, Effect]:
    """Every effect whose place exists in `model`, the nominal one of a plant, by name; in the order in which they are added."""
    effects = {effect.name: effect for family in FAMILIES for effect in family(model)}
    return {name: replace(effect, twins=_present(effect.twins, effects)) for name, effect in effects.items()}


def _present(twins: Mapping[str, str], effects: Mapping[str, Effect]) -> Mapping[str, str]:
    """Those twins that this plant has too; "parameters" are the plant's own."""
    return {name: reason for name, reason in twins.items() if name in effects or name.startswith("parameters")}
