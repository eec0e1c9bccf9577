"""A plant's equations with its whole library of effects in compiled filters, kept on disk by content.

Building the equations takes seconds, so what the rest needs of them (names, places in the parameter vector) is kept beside each
compiled library: a second diagnosis of the same kind of plant starts at once.
"""

import hashlib
import json
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cache, cached_property
from pathlib import Path
from threading import Lock
from typing import Any

import numpy as np
import sympy
from numpy.typing import NDArray

import sim
from diagnosis import decisions
from diagnosis.filter.build import build_filter, equations_text, open_filter
from diagnosis.filter.kalman import Filter
from diagnosis.library.filter_state import with_filter_state
from diagnosis.library.reading_noise import switch_of, with_reading_noise
from diagnosis.library.subprocess import NotDone, in_subprocess
from jobs.thread_map import begin
from records.errors import BadInput
from records.files import write_atomic
from records.plant import Plant
from records.text.reading import read_text
from sim.added_effects import combined, redundant
from sim.added_effects import library as all_effects
from sim.bind import BoundPlant, bind, named_values
from sim.composition.build import switched_model
from sim.composition.switch import switch_name
from sim.effect import Effect, FilterState, coefficient
from sim.model import Model
from sim.substeps import fastest_rad_s
from toolchain.cache import CACHE_DIR, is_whole

Array = NDArray[np.float64]
EQUATIONS = Lock()  # algebra is Python's, which does one thing at a time; compilers work side by side
BUILDING: dict[str, Lock] = {}  # by plant and effects: one builds a variant, others wait for it


@dataclass(frozen=True, eq=False)
class CompiledFilter:
    """One compiled filter: the effects `names` are in its equations, at next to no size in `p`; `index` finds coefficients in p.

    `states` are the plant's own, then those that effects brought; `follows` the output at whose reading one of these begins, by state;
    `switches` the places in p of the effects' switches.
    """

    filter: Filter
    names: frozenset[str]
    switches: Mapping[str, int]
    states: tuple[str, ...]
    follows: Mapping[str, str]
    p: Array
    index: Mapping[str, int]

    def place(self, effect: str, symbol: str) -> int:
        """The index in p of an effect's parameter."""
        return self.index[coefficient(effect, symbol)]


@dataclass(frozen=True, eq=False)
class EffectLibrary:
    """A nominal plant with its library: `names` are effects on its equations without a state or an axis of their own, `wide_names`
    those with, less `bristles`, whose states say what friction does near rest and are no gap, and less those that no filter can
    follow. `outputs` are the plant's outputs, then the states that a log may carry; `states` the plant's own."""

    bound: BoundPlant
    effects: Mapping[str, Effect]
    names: tuple[str, ...]
    wide_names: tuple[str, ...]
    bristles: tuple[str, ...]
    outputs: tuple[str, ...]

    @cached_property
    def candidates(self) -> tuple[str, ...]:
        """Effects that name a gap and are more than another name or another value of one of the plant's own coefficients, as a re-tune
        beyond its spread would have it."""
        gaps = (n for n, effect in self.effects.items() if effect.names_a_gap and effect.repeats and not effect.copy_of)
        return tuple(name for name in gaps if not redundant(self.bound, self.effects[name], decisions.ANOTHER_PLANT))

    @cached_property
    def states(self) -> tuple[str, ...]:
        """The plant's own states."""
        return tuple(str(state) for state in self.bound.model.states)

    @cached_property
    def rotor_speeds(self) -> tuple[str, ...]:
        """Those of its states that are the speed of a rotor."""
        speeds = {str(rotor.speed) for rotor in self.bound.model.places.rotors.values()}
        return tuple(state for state in self.states if state in speeds)

    @cached_property
    def velocities(self) -> tuple[int, ...]:
        """Which of its states is each axis' velocity."""
        return tuple(self.states.index(str(axis.velocity)) for axis in self.bound.model.axes)

    @cached_property
    def frictionless(self) -> frozenset[str]:
        """Axes without dry friction as stated."""
        model, known = self.bound.model, named_values(self.bound.model, self.bound.p)
        return frozenset(axis.name for axis in model.axes if sympy.sympify(axis.coulomb).xreplace(known) == 0)

    @cached_property
    def steps(self) -> Mapping[str, float]:
        """Each sensor's step by place, in the unit of what it reads."""
        sensors, known = self.bound.model.places.sensors, self.bound.plant.sensors
        return {place: known.get(sensor.output, 0.0) for place, sensor in sensors.items()}

    @property
    def own(self) -> int:
        """How many coefficients are the plant's own; they come first in every variant."""
        return len(self.bound.p)

    @property
    def plain(self) -> CompiledFilter:
        """The nominal equations alone, which are the fastest."""
        return _compiled(self, self.noises)

    def prepare(self) -> None:
        """Begin to open the variants, the one that takes longest first; who needs one sooner waits for it."""
        for effects in (self.whole, (), self.narrow):
            begin(_compiled, self, (*effects, *self.noises))

    @property
    def narrow(self) -> tuple[str, ...]:
        """Effects that bring no state, and those that have one in a filter alone: lags of sensors, which many hypotheses suppose."""
        return (*self.names, *(name for name, effect in self.effects.items() if _only_filtered(effect)))

    @property
    def whole(self) -> tuple[str, ...]:
        """All effects that any variant carries beside noise, which all do."""
        return (*self.narrow, *self.wide_names, *self.bristles)

    @cached_property
    def noises(self) -> tuple[str, ...]:
        """Effects that are states driven by noise: gusts."""
        return tuple(name for name, effect in self.effects.items() if effect.is_noise)

    @cached_property
    def losses(self) -> Effect | None:
        """The effect by which commands are lost; None where the plant has none."""
        return next((effect for effect in self.effects.values() if effect.loses_commands), None)

    def carried(self, name: str) -> bool:
        """Whether an effect is in the equations of a variant, with slopes by its parameters."""
        return name in self.whole or name in self.noises

    def compiled(self, effects: Iterable[str]) -> CompiledFilter:
        """The fastest that carries all of `effects` that any carries: the plant alone, with `narrow`, with axes that yield too, with all.

        States of effects that are off sleep, but the equations of all are asked.
        """
        return _compiled(self, (*self.carrying(effects), *self.noises))

    def carrying(self, effects: Iterable[str]) -> tuple[str, ...]:
        """What that variant carries beside noise."""
        wanted = set(effects).intersection(self.whole)
        variants = ((), self.narrow, (*self.narrow, *self.bristles), self.whole)
        return next(variant for variant in variants if wanted.issubset(variant))


def _filter_states(library: EffectLibrary, names: Iterable[str]) -> Iterator[FilterState]:
    return (state for name in names if (state := library.effects[name].filter_state) is not None)


def _only_filtered(effect: Effect) -> bool:
    """Whether a filter carries an effect by a state that no noise drives."""
    return effect.filter_state is not None and not effect.is_noise


def effect_library(bound: BoundPlant) -> EffectLibrary:
    """The library of a nominal plant."""
    effects = all_effects(bound)
    names = _noted(bound, "names", lambda: _sorted_names(bound, effects))
    outputs = [*bound.model.outputs, *(str(s) for s in bound.model.states if str(s) not in bound.model.outputs)]
    gaps = tuple(name for name in names["others"] if effects[name].names_a_gap)
    bristles = tuple(name for name in names["others"] if not effects[name].names_a_gap)
    return EffectLibrary(bound, effects, tuple(names["stateless"]), gaps, bristles, tuple(outputs))


def _sorted_names(bound: BoundPlant, effects: Mapping[str, Effect]) -> dict[str, Any]:
    """Effects on the equations that a filter can follow, by whether they bring a state or an axis."""
    found: dict[str, list[str]] = {"stateless": [], "others": []}
    for name, effect in effects.items():
        if effect.on_equations and effect.repeats:
            model = combined(bound, [name]).model
            same = len(model.states) == len(bound.model.states) and len(model.axes) == len(bound.model.axes)
            found["stateless" if same else "others"].append(name)
    return found


@cache
def _compiled(library: EffectLibrary, names: tuple[str, ...]) -> CompiledFilter:
    """Open a variant, building it where it is not on disk yet."""
    bound = library.bound
    what = hashlib.sha256(repr(names).encode()).hexdigest()[:16]
    with BUILDING.setdefault(f"{bound.plant.model} {what}", Lock()):
        # The whole library takes longest; for a smaller one another process costs as much as it saves.
        known = _noted(
            bound, what, lambda: (_built_in_subprocess if set(library.whole).issubset(names) else _build)(bound, names)
        )
    p, stated_rad_s = np.array(known["p"]), fastest_rad_s(bound, np.zeros(len(bound.model.states)))
    p[: len(bound.p)] = bound.p
    return CompiledFilter(
        filter=open_filter(Path(known["library"]), known["sizes"], tuple(known["axes"]), stated_rad_s),
        names=frozenset(names),
        switches=known["switches"],
        states=tuple(known["states"]),
        follows={state.name: state.follows for state in _filter_states(library, names) if state.follows},
        p=p,
        index={name: place for place, name in enumerate(known["parameters"])},
    )


def _built_in_subprocess(bound: BoundPlant, names: tuple[str, ...]) -> dict[str, Any]:
    """What is noted of a variant, by another process, which leaves this one to the search that has begun."""
    try:
        noted: dict[str, Any] = in_subprocess(_build_of, bound.plant, names, MADE_FROM)
    except NotDone:  # a plant of this process alone, say
        return _build(bound, names)
    return noted


def _build_of(plant: Plant, names: tuple[str, ...], made_from: bytes) -> dict[str, Any]:
    """What is noted of a variant of `plant`; raises RuntimeError where the code that runs here is not that of whoever asked."""
    if made_from != MADE_FROM:
        raise RuntimeError("sources were changed meanwhile")
    return _build(bind(plant), names)


def _build(bound: BoundPlant, names: tuple[str, ...]) -> dict[str, Any]:
    """What is noted of a variant with these effects, all switched on.

    The states come in the order of how often several are awake at once: the filter leaves whole blocks of sleepers alone.
    """
    effects = all_effects(bound)
    behind = [name for name in names if _only_filtered(effects[name])]
    noises = [name for name in names if effects[name].is_noise]
    switched = [name for name in names if name not in (*behind, *noises)]
    values = dict(zip(map(str, bound.model.parameter_symbols), bound.p.tolist(), strict=True))
    values |= {coefficient(name, p.symbol): p.touched for name in switched for p in effects[name].parameters}
    values |= {switch_of(output): 0.0 for output in bound.model.outputs}
    values |= {
        coefficient(name, p.symbol): p.reference for name in (*behind, *noises) for p in effects[name].parameters
    }
    with EQUATIONS:
        model = switched_model(bound.nominal, tuple(switched))
        for name in behind:
            model = with_filter_state(model, effects[name])
        brought = model.states[len(bound.model.states) :]
        late = brought[len(brought) - len(behind) :]
        model = with_reading_noise(model)
        own, errors = bound.model.states, model.states[len(bound.model.states) + len(brought) :]
        model = replace(model, states=(*own, *errors, *late, *brought[: len(brought) - len(behind)]))
        for name in noises:
            model = with_filter_state(model, effects[name])
        model = observed(model, bound.model)
        equations = equations_text(model)
    parameters = [str(symbol) for symbol in model.parameter_symbols]
    return {
        "library": str(build_filter(model.name, equations)),
        "parameters": parameters,
        "p": [values.get(name, 1.0) for name in parameters],
        "switches": {name: parameters.index(switch_name(effects[name])) for name in names},
        "states": [str(state) for state in model.states],
        "sizes": {"states": len(model.states), "outputs": len(model.outputs)},
        "axes": [axis.name for axis in model.axes],
    }


def observed(model: Model, nominal: Model) -> Model:
    """The model with the nominal states that a log may carry as further outputs."""
    further = {str(state): state for state in nominal.states if str(state) not in model.outputs}
    return replace(model, outputs={**model.outputs, **further})


def _noted(bound: BoundPlant, what: str, make: Any) -> dict[str, Any]:
    """What was noted on disk under this content, or what `make` gives, noted."""
    digest = hashlib.sha256(MADE_FROM)
    digest.update(bound.plant.model.encode())
    if bound.plant.equations is not None:
        digest.update(bound.plant.equations.text.encode())
    note = CACHE_DIR / "effect_libraries" / f"{bound.plant.model}-{digest.hexdigest()[:16]}-{what}.json"
    try:
        known: dict[str, Any] = json.loads(read_text(note, "note of an effect library"))
        if "library" not in known or is_whole(Path(known["library"])):
            return known
    except (BadInput, ValueError):
        pass
    known = make()
    write_atomic(note, json.dumps(known))
    return known


def _sources() -> bytes:
    """Digest of everything that a variant is made from: simulation, effects, filter."""
    digest = hashlib.sha256()
    root = Path(sim.__file__).resolve().parent
    here = Path(__file__).resolve().parent
    folders = (root, here.parent / "filter", here)
    for path in sorted(path for folder in folders for path in folder.rglob("*") if path.suffix in (".py", ".c", ".h")):
        digest.update(path.name.encode() + path.read_bytes())
    return digest.digest()


# Taken when this module is read: a note made later in this process is of the code that runs in it, whatever the files have become.
MADE_FROM = _sources()
