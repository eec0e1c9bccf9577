"""Steps of an input seen in the motion: which step's rounding errors the innovations follow."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

from diagnosis import decisions
from diagnosis.detect.linearisation import Linearisation
from diagnosis.filter.filter_input import FilterInput
from diagnosis.filter.kalman import Disturbances, Pass
from diagnosis.hypothesis.hypothesis import coefficients
from jobs.thread_map import thread_map
from sim.kernel.reference import reference
from toolchain.host import FAST_FLAGS, build_shared, load_shared

Array = NDArray[np.float64]
STEP_RATIO = 1.005  # 25 steps further a rounding must still fall alike
STEPS_APART = 1.004
# Where steps are looked for: from a share of what commands take of an input's range to a share of the whole range.
SMALLEST_STEP, LARGEST_STEP = 0.004, 0.25
MOMENTS = 50  # of a log, of which slopes are taken
ONE_WAY_SHARE = 0.5  # of an input's slopes that is left of their mean where three quarters push one way
MOST_GAINS = 40  # by what they say for the size of their errors; of these what they gain is asked
DECLARATIONS = """
void step_sums(int64_t rows, const double *u, const double *pull, const double *square, int64_t steps, const double *q, const double *hold,
               const double *shift, double *count, double *score, double *squares);
void step_errors(int64_t rows, const double *u, int64_t steps, const double *q, const double *hold, const double *shift, double *count,
                 double *error);
"""


@dataclass(frozen=True)
class Kind:
    """What steps are like, in shares of one: by how much each is held beyond its half, and where they lie."""

    hold: float = 0.0
    shift: float = 0.0


@dataclass(frozen=True, eq=False)
class _Rounded:
    """An input on its way: its column, what it adds to the plant's states (states,), and what steps may be like."""

    column: int
    push: Array
    kinds: Sequence[Kind]


def likely_steps(
    linearisation: Linearisation, place: str, kinds: Sequence[Kind] = (Kind(),)
) -> list[tuple[float, Kind]]:
    """The steps q of an input, each with what it is like, whose errors explain most, to first order; a rough step hits only near the true
    one."""
    model = linearisation.case.library.bound.model
    entry = model.places.inputs[place]
    column = model.inputs.index(entry.variable)
    push = push_of(linearisation, column)
    if not (np.isfinite(push).all() and push.any()):
        return []
    way = _Rounded(column, push, kinds)
    steps = _asked_of(linearisation, way.column, entry.size)
    promises = _promises(linearisation, way, steps)
    asked = np.argsort(-promises.max(axis=0))[:MOST_GAINS]
    steps, own = steps[asked], [kinds[place] for place in promises[:, asked].argmax(axis=0).tolist()]
    found: list[tuple[float, Kind]] = []
    for index in np.argsort(-_gains(linearisation, way, steps, own)).tolist():
        step = float(steps[index])
        if all(max(step, other) > STEPS_APART * min(step, other) for other, _ in found):
            found.append((step, own[index]))
        if len(found) == decisions.NEXT:
            break
    return found


def _asked_of(linearisation: Linearisation, column: int, size: float) -> Array:
    """The steps (k,) that an input may have: a signal that takes a hundredth of its range may still come in few steps."""
    u = np.concatenate([filter_input.u[:, column] for filter_input in linearisation.filter_inputs])
    taken = min(float(np.ptp(u)), size) or size
    smallest, largest = SMALLEST_STEP * taken, min(LARGEST_STEP * size, taken)
    return np.geomspace(smallest, largest, 1 + int(np.log(largest / smallest) / np.log(STEP_RATIO)))


@dataclass(frozen=True, eq=False)
class _Sent:
    """One log's commands, a row for as long as one stands: `u` (rows,), what the innovations say to a unit of error there, `pull`
    (rows,), and the `square` (rows,) of a unit's push."""

    u: Array
    pull: Array
    square: Array


def _promises(linearisation: Linearisation, way: _Rounded, steps: Array) -> Array:
    """The squared score (kinds, k) of each step's errors over their sum of squares: what they gain but for how much of them shows, which is
    much alike for errors that are as good as random. Errors count in steps: a step's size cancels."""
    logs = [
        _sent(filter_input, way.column, pull)
        for filter_input, pull in zip(linearisation.filter_inputs, linearisation.pulls(way.push), strict=True)
    ]

    def by(kind: Kind) -> Array:
        score, squares = (sum(sums) for sums in zip(*(_sums(log, steps, kind) for log in logs), strict=True))
        return np.asarray(np.maximum(score, 0.0) ** 2 / np.maximum(squares, 1e-300))

    return np.array(thread_map(by, way.kinds))


def _sent(filter_input: FilterInput, column: int, pull: Array) -> _Sent:
    u, h = filter_input.u[:, column], durations_s(filter_input)
    begins = np.flatnonzero(np.diff(u, prepend=np.nan) != 0.0)
    return _Sent(u[begins], np.add.reduceat(pull * h, begins), np.add.reduceat(h * h, begins))


def _sums(log: _Sent, steps: Array, kind: Kind) -> tuple[Array, Array]:
    """Score and sum of squares (k,) of the errors of each step over one log."""
    score, squares = np.empty_like(steps), np.empty_like(steps)
    _called("step_sums", [log.u, log.pull, log.square], steps, [kind] * len(steps), [score, squares])
    return score, squares


def _gains(linearisation: Linearisation, way: _Rounded, steps: Array, kinds: Sequence[Kind]) -> Array:
    errors = [_disturbing(filter_input, way.column, steps, kinds) for filter_input in linearisation.filter_inputs]
    return linearisation.gains_by(errors, way.push)


def _disturbing(filter_input: FilterInput, column: int, steps: Array, kinds: Sequence[Kind]) -> Disturbances:
    """Errors of an input by steps (k,), each of its kind, over each of a filter input's own (instants, k): those that the rig has move the
    innovations as its answer says; what the model would add moves them the other way."""
    errors, h = errors_of(filter_input.u[:, column], steps, kinds), durations_s(filter_input)
    return lambda part: np.asarray(steps * errors[part] * h[part, None])


def errors_of(u: Array, steps: Array, kinds: Sequence[Kind]) -> Array:
    """What rounding takes from commands u (rows,), in steps (rows, k)."""
    errors = np.empty((len(u), len(steps)))
    _called("step_errors", [u], steps, kinds, [errors])
    return errors


def _called(name: str, rows: Sequence[Array], steps: Array, kinds: Sequence[Kind], found: Sequence[Array]) -> None:
    """A function of input_steps.c over the `rows` (each (n,)), which fills what is `found`."""
    ffi, lib = _library()
    hold, shift = np.array([(kind.hold, kind.shift) for kind in kinds]).T
    arrays = [*map(np.ascontiguousarray, (*rows, steps, hold, shift)), np.empty_like(steps), *found]
    told = [ffi.cast("double *", array.ctypes.data) for array in arrays]
    getattr(lib, name)(len(rows[0]), *told[: len(rows)], len(steps), *told[len(rows) :])


def durations_s(filter_input: FilterInput) -> Array:
    """How long each instant's inputs are held (instants,)."""
    return np.append(np.diff(filter_input.t_s), 0.0)


def push_of(linearisation: Linearisation, column: int) -> Array:
    """What a unit of an input adds to the plant's own states (states,) by the end of a row, a second of it:

    (1)  G = 1/h int_0^h e^(A s) ds B

    A and B the slopes of the rates as fitted, means along the flights; it shows in each state that it drives, at once or through others.
    """
    own = len(linearisation.case.library.states)
    A, B = _slopes_along(linearisation, column)
    h_s = float(np.median(np.concatenate([np.diff(filter_input.t_s) for filter_input in linearisation.filter_inputs])))
    both = np.zeros((own + 1, own + 1))
    both[:own, :own], both[:own, own] = A, B.mean(axis=0)
    return np.asarray(expm(both * h_s)[:own, own] / h_s) if np.isfinite(both).all() else np.full(own, np.nan)


def turns(linearisation: Linearisation, column: int) -> bool:
    """Whether an input pushes some state now one way, now the other, as its square does: of that a mean push tells nothing."""
    _, B = _slopes_along(linearisation, column)
    return bool((np.abs(B.mean(axis=0)) < ONE_WAY_SHARE * np.abs(B).mean(axis=0)).any())


def _slopes_along(linearisation: Linearisation, column: int) -> tuple[Array, Array]:
    """The slopes of the rates as fitted along the flights: their mean A by the states (states, states), and B (moments, states) by an
    input."""
    case = linearisation.case
    model, own = case.library.bound.model, len(case.library.states)
    p = coefficients(case, case.library.plain, linearisation.fit.hypothesis.with_effects({}))[: case.library.own]
    slopes, signs = reference(model), np.zeros(len(model.axes))
    along = [
        moment for log in zip(linearisation.filter_inputs, linearisation.runs, strict=True) for moment in _moments(*log)
    ]
    A, B = np.zeros((own, own)), np.zeros((len(along), own))
    with np.errstate(all="ignore"):
        for row, (x, u) in enumerate(along):
            A += slopes.A(0.0, x[:own], u, p, signs) / len(along)
            B[row] = slopes.B(0.0, x[:own], u, p, signs)[:, column]
    return A, B


def _moments(filter_input: FilterInput, run: Pass) -> Iterator[tuple[Array, Array]]:
    """States and inputs at some rows of a log, spread evenly."""
    rows = np.flatnonzero(filter_input.row >= 0)
    for instant in rows[:: max(len(rows) // MOMENTS, 1)].tolist():
        yield run.filtered[filter_input.row[instant]], filter_input.u[instant]


@cache
def _library() -> tuple[Any, Any]:
    path = build_shared("input_steps", [Path(__file__).with_name("input_steps.c")], flags=FAST_FLAGS)
    return load_shared(DECLARATIONS, path)
