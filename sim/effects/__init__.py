"""A plant's nominal model in; the library of effects out: physics that a rig may have and its model lacks, one file an effect or family."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from functools import lru_cache
from importlib import import_module
from pkgutil import iter_modules

from sim.effect import Effect
from sim.model import Model

# The files whose effects are added to a model in an order, the innermost first: what changes an input comes last, so that a changed rotor
# is driven by the changed input. Files that neither names come between. Stages on the way of a signal know their own order.
INNER = (
    "sensor_map",
    "flexible_mode",
    "missed_counts",
    "imbalance",
    "coulomb",
    "stribeck",
    "load_friction",
    "friction_asymmetry",
    "creep",
    "bristles",
    "hysteresis",
    "quadratic_drag",
    "cable_spring",
    "gravity",
    "level_axis",
    "end_stop",
    "disturbance",
    "gust",
    "waves",
    "inertia",
    "gyroscopic",
    "axial_inflow",
    "ground_effect",
    "reverse_asymmetry",
    "reverse_drag",
    "downwash",
    "thrust_law",
    "warmup",
    "rotor_dry_friction",
    "reaction",
)
OUTER = (
    "deadzone",
    "saturation",
    "supply_sag",
    "driver_asymmetry",
    "gain_and_offset",
    "slew_limit",
    "lag",
    "quantization",
    "delay",
    "dropped_frames",
    "backlash",
)


def _families() -> Iterator[Callable[[Model], Iterable[Effect]]]:
    """What each file of this folder makes of a plant, in the order in which effects are added."""
    others = {entry.name for entry in iter_modules(__path__)} - {*INNER, *OUTER}
    for name in (*INNER, *sorted(others), *OUTER):
        yield import_module(f"{__name__}.{name}").effects


FAMILIES = tuple(_families())


@lru_cache(maxsize=64)
def effects_for(model: Model) -> Mapping[str, Effect]:
    """Every effect whose place exists in `model`, the nominal one of a plant, by name; in the order in which they are added."""
    effects = {effect.name: _at_pace(effect, model.second_s) for family in FAMILIES for effect in family(model)}
    return {name: replace(effect, twins=_present(effect.twins, effects)) for name, effect in effects.items()}


def _at_pace(effect: Effect, second_s: float) -> Effect:
    """The effect with bounds, references and starts of its times for a plant that takes so long for what others do in a second."""
    return (
        effect if second_s == 1.0 else replace(effect, parameters=tuple(p.at_pace(second_s) for p in effect.parameters))
    )


def _present(twins: Mapping[str, str], effects: Mapping[str, Effect]) -> Mapping[str, str]:
    """Those twins that this plant has too; "parameters" are the plant's own."""
    return {name: reason for name, reason in twins.items() if name in effects or name.startswith("parameters")}
