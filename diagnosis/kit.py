"""A plant's equations with its whole library of effects in one compiled filter, kept on disk by content.

Building the equations takes seconds, so what the rest needs of them (names, places in the parameter vector) is kept beside the
compiled library: a second diagnosis of the same kind of plant starts at once.
"""

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import sim
from diagnosis.filter import Filter, build_filter, open_filter
from records.files import write_atomic
from sim.bind import BoundPlant
from sim.effects.api import combined, library, redundant, without_effects
from sim.effects.effect import Effect, coefficient
from sim.model import Model
from toolchain.host import CACHE_DIR

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Kit:
    """The filter with every effect of `names` in its equations, at next to no size in `p`; `index` finds coefficients in p, and
    `plain` is the filter of the nominal equations alone, which is faster.

    `bound` is the nominal plant, `own` the number of its own coefficients, which come first. `outputs` are the plant's outputs, then
    the states that a log may carry.
    """

    bound: BoundPlant
    filter: Filter
    plain: Filter
    names: tuple[str, ...]
    effects: Mapping[str, Effect]
    outputs: tuple[str, ...]
    states: tuple[str, ...]
    p: Array
    index: Mapping[str, int]

    @property
    def own(self) -> int:
        """How many coefficients are the plant's own."""
        return len(self.bound.p)

    @property
    def candidates(self) -> tuple[str, ...]:
        """Effects that are more than another value of one of the plant's own coefficients."""
        return tuple(name for name, effect in self.effects.items() if not redundant(self.bound, effect))

    def place(self, effect: str, symbol: str) -> int:
        """The index in p of an effect's parameter."""
        return self.index[coefficient(effect, symbol)]


def make_kit(bound: BoundPlant) -> Kit:
    """The kit of a nominal plant with all effects on its equations that need no state or axis of their own."""
    effects = library(bound)
    key = _digest(bound, effects)
    note = CACHE_DIR / "kits" / f"{bound.plant.model}-{key}.json"
    if not note.exists() or not all(Path(json.loads(note.read_text())[key]).exists() for key in ("library", "plain")):
        write_atomic(note, json.dumps(_build(bound, effects)))
    known = json.loads(note.read_text(encoding="utf-8"))
    library_path = Path(known["library"])
    axes = tuple(axis.name for axis in bound.model.axes)
    touched = np.array(known["p"])
    p = np.concatenate([bound.p, touched[len(bound.p) :]])
    return Kit(
        bound=bound,
        filter=open_filter(library_path, known["sizes"], axes),
        plain=open_filter(Path(known["plain"]), known["sizes"], axes),
        names=tuple(known["names"]),
        effects=effects,
        outputs=tuple(known["outputs"]),
        states=tuple(known["states"]),
        p=p,
        index={name: place for place, name in enumerate(known["parameters"])},
    )


def _build(bound: BoundPlant, effects: Mapping[str, Effect]) -> dict[str, Any]:
    names = _stateless(bound, effects)
    plant = combined(bound, names)
    model = observed(plant.model)
    return {
        "library": str(build_filter(model)),
        "plain": str(build_filter(observed(without_effects(bound).model))),
        "names": names,
        "parameters": [str(symbol) for symbol in model.parameter_symbols],
        "p": plant.p.tolist(),
        "outputs": list(model.outputs),
        "states": [str(state) for state in model.states],
        "sizes": {"states": len(model.states), "outputs": len(model.outputs), "axes": len(model.axes)},
    }


def _stateless(bound: BoundPlant, effects: Mapping[str, Effect]) -> list[str]:
    """Effects on the equations that bring neither a state nor an axis."""
    own = bound.model
    found = []
    for name, effect in effects.items():
        if not effect.on_equations:
            continue
        model = combined(bound, [name]).model
        if len(model.states) == len(own.states) and len(model.axes) == len(own.axes):
            found.append(name)
    return found


def observed(model: Model) -> Model:
    """The model with its states that a log may carry as further outputs."""
    further = {str(state): state for state in model.states if str(state) not in model.outputs}
    return replace(model, outputs={**model.outputs, **further})


def _digest(bound: BoundPlant, effects: Sequence[str] | Mapping[str, Effect]) -> str:
    """What the compiled filter depends on: the sources of simulation and filter, the kind of plant, the effects."""
    digest = hashlib.sha256(_sources())
    digest.update(repr((bound.plant.model, tuple(effects))).encode())
    return digest.hexdigest()[:20]


@cache
def _sources() -> bytes:
    digest = hashlib.sha256()
    root = Path(sim.__file__).resolve().parent
    here = Path(__file__).resolve().parent
    files = [path for folder in (root, here / "c") for path in folder.rglob("*") if path.suffix in (".py", ".c", ".h")]
    for path in sorted([*files, here / "kit.py", here / "filter.py"]):
        digest.update(path.name.encode() + path.read_bytes())
    return digest.digest()
