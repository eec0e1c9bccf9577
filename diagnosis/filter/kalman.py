"""The extended Kalman filter of c/, compiled with a plant's equations: whitened innovations and their slopes."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from diagnosis.filter.filter_input import FilterInput

PART = 256  # instants answered at a time: what they fill stays in the processor's cache
Array = NDArray[np.float64]
# What is added at a slice of a filter input's instants (steps, ..., columns): made when it is asked for, so that none is ever whole.
Disturbances = Callable[[slice], Array]


@dataclass(frozen=True, eq=False)
class FilterNoise:
    """What the filter takes as random: q (states,) intensities of the rates, rub (axes,) see filter.h, p0 (states,) start variances.

    `forget` (states,) is the rate, in 1/s, at which a state that is noise alone decays, 0 for all others; `drive` (states,) the variance
    that a command which nobody knows gives each state in a second, by the second squared; `rest_s` the usual step from row to row, for
    which friction keeps a resting axis in doubt.
    """

    q: Array
    rub: Array
    p0: Array
    drive: Array
    forget: Array
    rest_s: float


def slope_of(noise: FilterNoise, other: FilterNoise, by: float) -> FilterNoise:
    """How a noise changes with a number, `by` so much of which it becomes the other."""
    return replace(
        noise, **{name: (getattr(other, name) - getattr(noise, name)) / by for name in ("q", "rub", "p0", "forget")}
    )


@dataclass(frozen=True, eq=False)
class Wanted:
    """What a pass is to leave: `slots` (outputs,) where each output's innovations go, -1 for none; by which `columns` of p and by which
    slopes of the noise, `noises`, its likelihood is differentiated; whether the slopes of each innovation and the gains are kept."""

    slots: Sequence[int]
    columns: Sequence[int] = ()
    noises: Sequence[FilterNoise] = ()
    slopes: bool = False
    gains: bool = False


@dataclass(frozen=True, eq=False)
class Pass:
    """One pass over a log of n rows: whitened innovations w (n, slots) and their variances s, NaN where nothing was measured; slopes
    dw (n, slots, columns) or None, their products `gram` = dw'dw and `pull` = dw'w; predicted states x and filtered ones (n, states).
    `gains` as in filter.h: F, K, H by step. By numbers of the noise, the `score` (numbers,) of the likelihood and Fisher's `information`
    (numbers, numbers).
    """

    w: Array
    s: Array
    dw: Array | None
    x: Array
    filtered: Array
    log_likelihood: float
    gram: Array
    pull: Array
    score: Array
    information: Array
    gains: tuple[Array, Array, Array] | None = None


@dataclass(frozen=True, eq=False)
class Filter:
    """A model's compiled filter with its numbers of states and outputs, the names of its axes, and the rate of the fastest motion of the
    plant as stated, which says how many substeps make sense."""

    states: int
    outputs: int
    axes: tuple[str, ...]
    ffi: Any
    lib: Any
    stated_rad_s: float = 0.0

    def run(
        self,
        filter_input: FilterInput,
        p: Array,
        x0: Array,
        noise: FilterNoise,
        wanted: Wanted,
        locked: Sequence[str] = (),
    ) -> Pass | None:
        """Filter one log's input from x0 (states,), or (starts, states) where it begins anew; `locked` are axes that are held.

        None where the state left all bounds or rattles without end: the parameters do not fit at all. What began anew so ends there.
        """
        slots, columns, noises = wanted.slots, wanted.columns, wanted.noises
        assert len(columns) <= self.lib.MAX_COLUMNS
        assert len(noises) <= self.lib.MAX_NOISES
        width, steps = max(slots) + 1, len(filter_input.t_s)
        given = (
            _given(filter_input, p, x0, self._rubbing(noise))
            | _added(filter_input, self.states)
            | _slopes([self._rubbing(by) for by in noises])
            | {
                "locked": np.array([axis in locked for axis in self.axes] or [False], dtype=np.uint8),
                "column": np.array(columns, dtype=np.int32),
                "slot": np.array(slots, dtype=np.int32),
                "anew": filter_input.anew,
            }
        )
        found = self._found(filter_input, width, wanted)
        request = self._request("filter_request *", given | found)
        request.steps, request.columns, request.slots, request.noises = steps, len(columns), width, len(noises)
        request.rest_s, request.stated_rad_s = noise.rest_s, self.stated_rad_s
        if self.lib.filter_run(request) != steps:
            return None
        F, K, H, gram = (found.pop(name) for name in ("F", "K", "H", "gram"))
        assert gram is not None
        gains = None if F is None or K is None or H is None else (F, K, H)
        return Pass(**found, gram=gram, log_likelihood=float(request.log_likelihood), gains=gains)  # type: ignore[arg-type]

    def _rubbing(self, noise: FilterNoise) -> FilterNoise:
        """The noise with one doubt of friction, which counts for nothing, where there is no axis."""
        return noise if self.axes else replace(noise, rub=np.zeros(1))

    def _found(self, filter_input: FilterInput, width: int, wanted: Wanted) -> dict[str, Array | None]:
        """Room for what a run leaves, as in filter.h; None for what is not kept."""
        rows, steps, n, outputs = filter_input.rows, len(filter_input.t_s), self.states, self.outputs
        columns, noises, gains = len(wanted.columns), len(wanted.noises), wanted.gains
        return {
            "w": np.full((rows, width), np.nan),
            "s": np.full((rows, width), np.nan),
            "dw": np.zeros((rows, width, columns)) if columns and wanted.slopes else None,
            "gram": np.zeros((columns, columns)),
            "pull": np.zeros(columns),
            "x": np.empty((rows, n)),  # all of it is filled: every row is an instant
            "filtered": np.empty((rows, n)),
            "F": np.zeros((steps, n, n)) if gains else None,
            "K": np.zeros((steps, outputs, n)) if gains else None,
            "H": np.zeros((steps, outputs, n)) if gains else None,
            "score": np.zeros(noises),
            "information": np.zeros((noises, noises)),
        }

    def _request(self, kind: str, arrays: Mapping[str, NDArray[Any] | None]) -> Any:
        """A request of C whose pointers are those of the arrays, which must live as long."""
        request = self.ffi.new(kind)
        for name, array in arrays.items():
            if array is not None:
                setattr(request, name, self.ffi.cast("void *", self.ffi.from_buffer(array)))
        return request

    def respond(
        self, filter_input: FilterInput, run: Pass, values: Disturbances, targets: Sequence[int], slots: Sequence[int]
    ) -> Iterator[tuple[NDArray[np.int64], Array]]:
        """Change of the whitened innovations by small disturbances `values` (steps, targets, columns), some of the filter input at a time.

        Yields places (m,) among the run's w, taken row by row, and the changes (m, k) there by the first k columns, in room that the next
        part takes; the columns behind them are not disturbed yet, and k never falls. Places that no part names do not change. A target
        below the number of states is a state, disturbed over the step from an instant; beyond, an output at that instant.
        """
        assert run.gains is not None
        F, K, H = run.gains
        count, steps = columns_of(values), len(filter_input.t_s)
        assert count <= self.lib.MAX_COLUMNS
        counts, places = _counted(filter_input, slots)
        begins = np.append(0, np.cumsum(counts.sum(axis=1)))[[*range(0, steps, PART), steps]]
        room = np.zeros((int(np.diff(begins).max()), count))
        arrays: dict[str, NDArray[Any] | None] = {
            "F": F,
            "K": K,
            "H": H,
            "s": run.s.reshape(-1)[places],
            "target": np.array(targets, dtype=np.int32),
            "place": _in_order(counts),
            "dw": room,
            "state": np.zeros((self.states, self.lib.MAX_COLUMNS)),
        }
        request = self._request("response_request *", arrays)
        request.columns, request.targets = count, len(targets)
        for part, (begin, end) in enumerate(pairwise(begins.tolist())):
            request.first, request.end, request.base = part * PART, min((part + 1) * PART, steps), begin
            value = _double(values(slice(request.first, request.end)))
            request.value = self.ffi.cast("void *", value.ctypes.data)
            self.lib.filter_respond(request)
            yield places[begin:end], room[: end - begin, : request.awake]

    def pulls(self, filter_input: FilterInput, run: Pass, slots: Sequence[int]) -> Array:
        """E'w (steps, states) by a unit that is added to each state over each step, E its answer in the whitened innovations w (rows,
        slots): the adjoint of `respond`, which takes the gains that a run that keeps them left."""
        assert run.gains is not None
        counts, places = _counted(filter_input, slots)
        found = np.empty((len(filter_input.t_s), self.states))
        arrays: dict[str, NDArray[Any] | None] = {
            **dict(zip("FKH", run.gains, strict=True)),
            "s": run.s.reshape(-1)[places],
            "w": run.w.reshape(-1)[places],
            "place": _in_order(counts),
            "pull": found,
        }
        request = self._request("adjoint_request *", arrays)
        request.steps = len(filter_input.t_s)
        self.lib.filter_adjoint(request)
        return found

    def response(
        self, filter_input: FilterInput, run: Pass, values: Disturbances, targets: Sequence[int], slots: Sequence[int]
    ) -> Array:
        """The whole of `respond`, shape (rows, slots, columns)."""
        found = np.zeros((run.w.size, columns_of(values)))
        for places, changes in self.respond(filter_input, run, values, targets, slots):
            found[places, : changes.shape[1]] = changes
        return found.reshape(*run.w.shape, -1)


def _given(filter_input: FilterInput, p: Array, x0: Array, noise: FilterNoise) -> dict[str, NDArray[Any] | None]:
    """What a run reads of a log, the parameters and the noise, as in filter.h."""
    return {
        "t_s": _double(filter_input.t_s),
        "u": _double(filter_input.u),
        "y": _double(filter_input.y),
        "r": _double(filter_input.r),
        "row": np.ascontiguousarray(filter_input.row, dtype=np.int64),
        "place": np.ascontiguousarray(filter_input.place, dtype=np.int64),
        "p": _double(p),
        "x0": _double(x0),
        "p0": _double(noise.p0),
        "q": _double(noise.q),
        "further": _double(np.outer(filter_input.untold_s**2, noise.drive)) if filter_input.untold_s.any() else None,
        "forget": _double(noise.forget),
        "rub": _double(noise.rub),
    }


def _added(filter_input: FilterInput, states: int) -> dict[str, NDArray[Any] | None]:
    """What acts beside the equations, as in filter.h: what it adds to an output is taken from what was read."""
    added = filter_input.added
    if added is None:
        return {}
    y = _double(filter_input.y - added.at(filter_input.t_s))
    return {"added": _double(added.over_steps(filter_input.t_s, states)), "y": y}


def _slopes(noises: Sequence[FilterNoise]) -> dict[str, NDArray[Any] | None]:
    """The slopes of the noise by its numbers, as in filter.h."""
    names = ("q", "p0", "forget", "rub")
    return {f"{name}_by": _double([getattr(by, name) for by in noises]) for name in names} if noises else {}


def _counted(filter_input: FilterInput, slots: Sequence[int]) -> tuple[NDArray[np.bool_], NDArray[np.int64]]:
    """Which readings (steps, outputs) have a whitened innovation, and their places among those of a run, taken row by row."""
    width, chosen = max(slots) + 1, np.array(slots)
    counts = (filter_input.place >= 0) & (chosen >= 0)
    return counts, (filter_input.place * width + chosen)[counts]


def _in_order(counts: NDArray[np.bool_]) -> NDArray[np.int64]:
    """The number of each reading that counts, -1 of the others."""
    return np.where(counts, np.cumsum(counts).reshape(counts.shape) - 1, -1)


def columns_of(values: Disturbances) -> int:
    """How many disturbances there are side by side."""
    return int(values(slice(0)).shape[-1])


def _double(array: ArrayLike) -> Array:
    return np.ascontiguousarray(array, dtype=float)
