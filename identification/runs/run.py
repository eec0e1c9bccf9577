"""One run as the estimator sees it: inputs, readings with their standard deviations, and where the motion starts."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from identification.model.observation import Observation
from sim.bind import BoundPlant
from sim.model import Model

Array = NDArray[np.float64]
Index = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Carried:
    """States that only the inputs drive (a rotor's lag): they run on through all windows of a run, from x0 (states,).

    A window's own x0 counts what it begins beside them.
    """

    bound: BoundPlant
    x0: Array


@dataclass(frozen=True, eq=False)
class Run:
    """Rows t_s (n,) with inputs u (n, inputs) held; m readings y, sd of their errors, times at_s, channel (index into `channels`).

    The readings are `select` applied to the predicted k outputs of all rows, flattened to (n k,): places in it, or a sparse matrix
    (m, n k) where a reading is a mean or a difference. Windows are the rows from `begins` to before `stops` (windows,), each simulated
    from its own x0 (windows, states), of which the states `free` are estimated with it; `start_sd` (windows, free) is how far off x0
    may be.
    `observed` replaces the model's outputs; `alias` renames parameters to those of the model. `step` (channels,) is the resolution
    of each channel, 0 where its readings are not rounded. `first` keeps the starts' first guess once x0 has moved. Readings of a channel
    whose errors cancel from one to the next may count for more than independent ones, down to `least_inflation` (by default 1).
    A sample is integrated in `substeps` steps of Runge and Kutta.
    """

    name: str
    bound: BoundPlant
    t_s: Array
    u: Array
    y: Array
    sd: Array
    at_s: Array
    channel: Index
    channels: tuple[str, ...]
    select: Index | csr_array
    begins: Index
    stops: Index
    x0: Array
    free: tuple[str, ...] = ()
    start_sd: Array = field(default_factory=lambda: np.zeros((1, 0)))
    observed: Observation | None = None
    alias: Mapping[str, str] = field(default_factory=dict)
    carried: Carried | None = None
    step: Array = field(default_factory=lambda: np.zeros(0))
    first: Array | None = None
    least_inflation: tuple[float, ...] = ()
    substeps: int = 1

    @property
    def guess(self) -> Array:
        """Where the starts were before any fit, (windows, states): what `start_sd` counts from."""
        return self.x0 if self.first is None else self.first

    @property
    def windows(self) -> tuple[slice, ...]:
        """The rows of each window."""
        return tuple(slice(int(a), int(b)) for a, b in zip(self.begins, self.stops, strict=True))

    @property
    def window_readings(self) -> tuple[slice, ...]:
        """The readings of each window; readings that combine rows need a run of one window."""
        if not isinstance(self.select, np.ndarray) or self.begins.size == 1:
            return (slice(0, self.y.size),)
        edges = np.searchsorted(self.select, np.stack([self.begins, self.stops], axis=1) * self.outputs)
        return tuple(slice(int(a), int(b)) for a, b in edges)

    @property
    def outputs(self) -> int:
        """How many outputs are predicted at each row."""
        return len(self.observed.expressions if self.observed else self.bound.model.outputs)


@lru_cache(maxsize=64)
def coefficient_names(model: Model) -> tuple[str, ...]:
    """Names of the parameter vector's entries: "K_M", "p_bM_0", "p_bM_1", ..."""
    return tuple(str(symbol) for symbol in model.parameter_symbols)


@lru_cache(maxsize=64)
def _places(model: Model) -> Mapping[str, int]:
    return {name: place for place, name in enumerate(coefficient_names(model))}


@lru_cache(maxsize=64)
def offset_names(model: Model) -> tuple[str, ...]:
    """Names of constants added to the inputs, "offset.u_V": the trim of a real rig, estimated like a parameter where asked for."""
    return tuple(f"offset.{variable}" for variable in model.inputs)


@lru_cache(maxsize=64)
def state_places(model: Model) -> Mapping[str, int]:
    """Where each state stands, by its name."""
    return {str(state): place for place, state in enumerate(model.states)}


def free_places(run: Run) -> list[int]:
    """Where the free ones stand among the states."""
    places = state_places(run.bound.model)
    return [places[name] for name in run.free]


def known_names(run: Run, names: Sequence[str]) -> tuple[tuple[int, str], ...]:
    """Of the parameters `names` those that the run's model has: place in `names` and the model's own name."""
    known = {*_places(run.bound.model), *offset_names(run.bound.model)}
    own = [(place, run.alias.get(name, name)) for place, name in enumerate(names)]
    return tuple((place, name) for place, name in own if name in known)


def parameters_of(run: Run, names: Sequence[str], theta: Array) -> Array:
    """The model's parameter vector with the entries `names` set to theta."""
    known, p = _places(run.bound.model), run.bound.p.copy()
    for place, name in known_names(run, names):
        if name in known:
            p[known[name]] = theta[place]
    return p


def inputs_of(run: Run, names: Sequence[str], theta: Array) -> Array:
    """The run's inputs (n, inputs) with their offsets among `names` added."""
    offsets = offset_names(run.bound.model)
    added = np.zeros(len(offsets))
    for place, name in enumerate(names):
        if name in offsets:
            added[offsets.index(name)] = theta[place]
    return run.u + added if np.any(added) else run.u


def with_starts(run: Run, x0: Array) -> Run:
    """The same run from other window starts; the first guess is kept."""
    return replace(run, x0=x0, first=run.guess)


def with_sd(run: Run, sd: Array) -> Run:
    """The same run with other standard deviations of its readings."""
    return replace(run, sd=sd)
