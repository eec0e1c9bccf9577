"""Maximum a posteriori fit of a hypothesis: Gauss-Newton with Levenberg's damping on the whitened innovations.

It is no use of identification/fit/levenberg_marquardt.py: what is maximised is a likelihood and no sum of squares, as ln s goes with what
is fitted, and each point costs a filter's pass over all logs. So steps begin undamped, are damped a few times only where the likelihood
falls, and end where one gains or promises less than LEAST_STEP_GAIN nats, which no sum of squares counts in.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from diagnosis import decisions
from diagnosis.filter.kalman import Pass
from diagnosis.hypothesis.case import Case, FilteredLog
from diagnosis.hypothesis.hypothesis import ELSEWHERE, SHORTEST_LAG_S, Hypothesis, Lack, nominal_hypothesis, passes
from diagnosis.library.effect_library import CompiledFilter
from diagnosis.library.input_effects import share_slopes
from sim.effect import EffectParameter, Role, Values

Array = NDArray[np.float64]
LEAST_STEP_GAIN = 0.1  # gain of the log posterior below which a fit has ended
LITTLE_NATS = (
    1.0  # gained by a round of several fits, or promised by a step, below which it is the last: a tenth of TAKEN_IN
)
# Of a step that is too long: tried as it is, then shorter by more and more, down to a third of it.
DAMPINGS, FIRST_DAMPING, MORE_DAMPING = 4, 0.06, 6.0
DIFFERENCE = 1e-3  # finite differences, in units of a parameter's scale
WIDEST, LAG_JUMP = 0.05, 0.3  # of a lag, over which its slope is taken at most; how much of ln s is a jump there
OUT_OF_REACH = 1e3  # references
WITHOUT_SLOPE = (Role.JITTER, Role.BEGINNING, Role.HOLD, Role.SHIFT)  # found otherwise, or known


@dataclass(frozen=True)
class Free:
    """One free number of an effect: its effect, its parameter, and the unit in which the fit counts it.

    `stated` is its value in the plant file, known to one `scale`; None where the file does not state the effect. `log` is the number of
    the log whose own it is, None where it is that of all.
    """

    effect: str
    parameter: EffectParameter
    scale: float
    stated: float | None = None
    log: int | None = None

    def of(self, hypothesis: Hypothesis) -> float:
        """Its value in a hypothesis."""
        return hypothesis.value(self.effect, self.parameter.symbol, self.log)


class _Columns:
    """Which columns of a pass are the slopes by which of the fitted numbers: theta first, then those of `free` that the equations hold; of
    what a log lacks it tells nothing.

    `places` are the pass' columns as places in p; a number that each log has for itself takes the same column in all of them.
    """

    def __init__(self, case: Case, compiled: CompiledFilter, free: Sequence[Free], lacks: Mapping[str, Lack]) -> None:
        self._count, self._free, self._lacks = len(case.free), free, lacks
        inside = [(row, entry) for row, entry in enumerate(free, self._count) if entry.effect in compiled.names]
        own = {row: compiled.place(entry.effect, entry.parameter.symbol) for row, entry in inside}
        further = list(dict.fromkeys(own.values()))
        self.places: list[int] = [*case.free.tolist(), *further]
        self.rows = np.array([*range(self._count), *own], dtype=int)
        self._column = {row: self._count + further.index(place) for row, place in own.items()}

    def of(self, log: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """The numbers that a log tells of, and the column of each in its pass."""
        rows = [
            row for row in self.rows.tolist() if row < self._count or self._tells(self._free[row - self._count], log)
        ]
        return np.array(rows, dtype=int), np.array([self._column.get(row, row) for row in rows], dtype=int)

    def _tells(self, entry: Free, log: int) -> bool:
        lack = self._lacks.get(entry.effect)
        return entry.log in (None, log) and (lack is None or log not in lack.logs)


@dataclass(frozen=True, eq=False)
class Fit:
    """What fits best, the log of its likelihood and posterior, and the linear problem there: `information` (k, k) v = -`pull` (k,),
    theta first, then `free`, both with the prior. Its information is of the likelihood raised to 1 / `tempering`.
    """

    hypothesis: Hypothesis
    log_likelihood: float
    log_posterior: float
    free: tuple[Free, ...]
    information: Array
    pull: Array
    tempering: float = 1.0

    @property
    def promised(self) -> float:
        """What a step to the top of the linear problem would gain, in nats: b' A^-1 b / 2 with A the information and b the pull."""
        return 0.5 * float(self.pull @ np.linalg.solve(self.information, self.pull))


def free_numbers(case: Case, hypothesis: Hypothesis, shapes: bool = True) -> tuple[Free, ...]:
    """The numbers of the supposed effects that a fit may move: those of which its slopes tell."""
    found = []
    for name, log, values in _instances(case, hypothesis):
        effect = case.library.effects[name]
        for parameter in effect.parameters:
            if effect.shown_in_readings or effect.is_noise or parameter.role in WITHOUT_SLOPE:
                continue
            if name in case.stated:
                stated, sd = (given[name][parameter.symbol] for given in (case.stated, case.stated_sd))
                found += [Free(name, parameter, sd, stated)] if sd > 0.0 else []
            elif from_zero(parameter):
                found.append(Free(name, parameter, size_scale(parameter), log=log))
            elif shapes:
                scale = 0.2 * max(abs(values[parameter.symbol]), shape_unit(parameter))
                found.append(Free(name, parameter, scale, log=log))
    return tuple(found)


def _instances(case: Case, hypothesis: Hypothesis) -> Iterator[tuple[str, int | None, Values]]:
    """Each effect with its values, and those that are another in each log once for each log in which they happen."""
    for name, values in hypothesis.effects.items():
        if name not in hypothesis.own:
            yield name, None, values
            continue
        size = case.library.effects[name].size
        for log, own in hypothesis.own[name].items():
            if log != ELSEWHERE and own[size.symbol] != size.zero:
                yield name, log, own


def from_zero(parameter: EffectParameter) -> bool:
    """Whether a number counts from where its effect vanishes: a size does, but for a limit that only vanishes out of all reach."""
    out_of_reach = parameter.reference != 0.0 and abs(parameter.zero or 0.0) > OUT_OF_REACH * abs(parameter.reference)
    return parameter.is_size and not out_of_reach


def size_scale(parameter: EffectParameter) -> float:
    """The unit of a size: how far its reference is from nothing."""
    zero = parameter.zero or 0.0
    return abs(parameter.reference - zero) or 0.05 * (parameter.upper - parameter.lower)


def shape_unit(parameter: EffectParameter) -> float:
    """The unit of a shape that may be 0."""
    return abs(parameter.reference) if parameter.reference else 0.1 * min(parameter.upper - parameter.lower, 10.0)


def stacked(runs: Sequence[Pass]) -> Array:
    """All whitened innovations in a row, 0 where nothing was measured."""
    return np.asarray(np.nan_to_num(np.concatenate([run.w.ravel() for run in runs])))


def likelihood(runs: Sequence[Pass]) -> float:
    """The log likelihood over all flights."""
    return sum(run.log_likelihood for run in runs)


def likelihood_of(case: Case, hypothesis: Hypothesis) -> float:
    """The log likelihood of what is supposed, -inf where the filter left all bounds."""
    runs = passes(case, hypothesis)
    return -np.inf if runs is None else likelihood(runs)


def log_prior(case: Case, hypothesis: Hypothesis, free: Sequence[Free]) -> float:
    """Of theta, standard normal, of numbers that the plant file states, likewise, and of sizes, wide."""
    sizes = [
        (entry.of(hypothesis) - (entry.parameter.zero or 0.0)) / entry.scale / decisions.SIZE_SD
        for entry in free
        if from_zero(entry.parameter) and entry.stated is None
    ]
    return -0.5 * prior_chi_squared(case, hypothesis, free) - 0.5 * float(np.sum(np.square(sizes)))


def away(hypothesis: Hypothesis, free: Sequence[Free]) -> Array:
    """How far all numbers that the plant file states are from there, in standard deviations: theta, then those of its effects."""
    stated = [(entry.of(hypothesis) - entry.stated) / entry.scale for entry in free if entry.stated is not None]
    return np.append(hypothesis.theta, stated)


def prior_chi_squared(case: Case, hypothesis: Hypothesis, free: Sequence[Free]) -> float:
    """The squared distance of all that the plant file states from there, in its own spread: chi-squared under a plant as stated."""
    moved, theta = away(hypothesis, free), hypothesis.theta
    beside = 0.0 if case.spread is None else float(theta @ (case.pull_of(theta) - theta))
    return float(moved @ moved) + beside


def fit(case: Case, start: Hypothesis, *, rounds: int = 8, shapes: bool = True) -> Fit | None:
    """The best theta and effects from `start`, process noise held; None where the start cannot be filtered."""
    free = free_numbers(case, start, shapes)
    at = _linear(case, start, free)
    damping = 0.0
    for _ in range(rounds):
        if at is None:
            return None
        if damping == 0.0 and at.promised < LEAST_STEP_GAIN:
            return at
        for tried in range(DAMPINGS):
            moved = _moved(case, at, damping)
            # Most steps end at the first that is tried: its slopes come along.
            is_asked = tried == 0 or _log_posterior(case, moved, free) > at.log_posterior
            fitted = _linear(case, moved, free, at.log_posterior) if is_asked else None
            if fitted is not None:
                break
            damping = max(MORE_DAMPING * damping, FIRST_DAMPING)
        else:
            return at
        gain, at = fitted.log_posterior - at.log_posterior, fitted
        damping *= 0.2
        if gain < LEAST_STEP_GAIN:
            break
    return at


def _moved(case: Case, at: Fit, damping: float) -> Hypothesis:
    """One damped step, kept within the effects' bounds. A number counts for no less than its unit in it: one of which the logs tell next to
    nothing, as a shape of no size yet, would else go as far as ever however much all others are held back."""
    count = len(case.free)
    theta = at.hypothesis.theta
    curvature = at.information + damping * np.diag(np.diag(at.information) + 1.0)
    step = -np.linalg.solve(curvature, at.pull)
    moved = replace(at.hypothesis, theta=theta + step[:count])
    for entry, change in zip(at.free, step[count:], strict=True):
        value = entry.of(moved) + float(np.clip(change, -30.0, 30.0)) * entry.scale
        value = float(np.clip(value, entry.parameter.lower, entry.parameter.upper))
        moved = moved.with_value(entry.effect, entry.parameter.symbol, value, entry.log)
    return moved


def _log_posterior(case: Case, hypothesis: Hypothesis, free: Sequence[Free]) -> float:
    return likelihood_of(case, hypothesis) + log_prior(case, hypothesis, free)


def _linear(case: Case, hypothesis: Hypothesis, free: tuple[Free, ...], least: float = -np.inf) -> Fit | None:
    """Likelihood and linear problem at a point; None where the filter or its slopes fail, or it is no likelier than `least`."""
    compiled = case.library.compiled(hypothesis.effects)
    inside = np.array([entry.effect in compiled.names for entry in free], dtype=bool)
    columns = _Columns(case, compiled, free, hypothesis.lacks)
    runs = passes(case, hypothesis, columns.places, slopes=not inside.all())
    if runs is None:
        return None
    found = likelihood(runs)
    log_posterior = found + log_prior(case, hypothesis, free)
    if not log_posterior > least:
        return None
    count = len(case.free)
    scale = np.concatenate([case.sd, [entry.scale for entry in free]])
    information, pull = np.zeros((len(scale), len(scale))), np.zeros(len(scale))
    for flight, run in zip(case.flights, runs, strict=True):
        rows, own = columns.of(flight.number)
        information[np.ix_(rows, rows)] += run.gram[np.ix_(own, own)]
        pull[rows] += run.pull[own]
    if not inside.all():
        _add_differences(case, hypothesis, free, runs, columns, information, pull)
    for row, entry in enumerate(free, count):
        late = case.library.effects[entry.effect].reads_late
        if late and entry.of(hypothesis) > SHORTEST_LAG_S:
            pull[row], further = _smoothed(case, hypothesis, entry, float(information[row, row]))
            information[row, row] += further
    information *= np.outer(scale, scale)
    pull *= scale
    if not (np.isfinite(information).all() and np.isfinite(pull).all()):
        return None  # slopes that overflow: as good as a filter that fails
    _add_prior(case, hypothesis, free, information, pull)
    if not _is_definite(information):
        return None
    return Fit(hypothesis, found, log_posterior, free, information, pull)


def _is_definite(information: Array) -> bool:
    """Whether it can be solved with: a size in a wild unit may drown all others."""
    try:
        np.linalg.cholesky(information)
    except np.linalg.LinAlgError:
        return False
    return True


def unfitted(case: Case, noisy: Hypothesis) -> Fit | None:
    """The plant as stated with the noise of another hypothesis, no more known of it than its file says; None where it cannot follow the
    logs."""
    gusts = {name: values for name, values in noisy.effects.items() if case.library.effects[name].is_noise}
    stated = nominal_hypothesis(case, 0.0).with_noise_of(noisy)
    start = fit(case, stated.with_effects({**stated.effects, **gusts}), rounds=0)
    if start is None:
        return None
    information, pull = np.zeros_like(start.information), np.zeros_like(start.pull)
    _add_prior(case, start.hypothesis, start.free, information, pull)
    return replace(start, information=information, pull=pull)


def tempered(case: Case, found: Fit, scale: float) -> Fit:
    """The fit with what is known of its numbers where the likelihood L counts as L^(1 / scale), as no model is exact: with C the prior's,

    A' = (A - C) / scale + C    (Miller and Dunson 2019)
    """
    prior = np.zeros_like(found.information)
    _add_prior(case, found.hypothesis, found.free, prior, np.zeros_like(found.pull))
    return replace(found, information=prior + (found.information - prior) / scale, tempering=scale)


def _add_prior(case: Case, hypothesis: Hypothesis, free: Sequence[Free], information: Array, pull: Array) -> None:
    count = len(hypothesis.theta)
    information[:count, :count] += case.known
    pull[:count] += case.pull_of(hypothesis.theta)
    for row, entry in enumerate(free, count):
        value = entry.of(hypothesis)
        if entry.stated is not None:
            information[row, row] += 1.0
            pull[row] += (value - entry.stated) / entry.scale
            continue
        size = value - (entry.parameter.zero or 0.0)
        information[row, row] += 1.0 / decisions.SIZE_SD**2 if from_zero(entry.parameter) else 1e-6
        pull[row] += size / entry.scale / decisions.SIZE_SD**2 if from_zero(entry.parameter) else 0.0


def _add_differences(
    case: Case,
    hypothesis: Hypothesis,
    free: Sequence[Free],
    runs: Sequence[Pass],
    columns: "_Columns",
    information: Array,
    pull: Array,
) -> None:
    """Rows and columns of numbers that act on the way of a signal, by finite differences."""
    w, own = stacked(runs), columns.rows
    slopes = np.concatenate([_own_slopes(columns, flight, run) for flight, run in zip(case.flights, runs, strict=True)])
    count = len(hypothesis.theta)
    outside = np.setdiff1d(np.arange(count, len(pull)), own)
    for row in [row for row in outside.tolist() if _is_loss(free[row - count]) and _knows_losses(case)]:
        share = free[row - count].of(hypothesis)
        slopes_by_share = [share_slopes(flight.filter_input, share) for flight in case.flights]
        pull[row] = -sum(slope for slope, _ in slopes_by_share)
        information[row, row] = -sum(bend for _, bend in slopes_by_share)
        outside = outside[outside != row]
    if not len(outside):
        return
    changes = np.stack([_difference(case, hypothesis, free[row - count], w) for row in outside.tolist()], axis=1)
    information[np.ix_(own, outside)] = slopes.T @ changes
    information[np.ix_(outside, own)] = information[np.ix_(own, outside)].T
    information[np.ix_(outside, outside)] = changes.T @ changes
    pull[outside] = changes.T @ w


def _own_slopes(columns: "_Columns", flight: FilteredLog, run: Pass) -> Array:
    """Slopes of all whitened innovations of a pass by the numbers of `columns.rows`, 0 by those of other logs."""
    rows, own = columns.of(flight.number)
    slopes = flat_slopes(run)
    found = np.zeros((len(slopes), len(columns.rows)))
    found[:, np.searchsorted(columns.rows, rows)] = slopes[:, own]
    return found


def _smoothed(case: Case, hypothesis: Hypothesis, entry: Free, known: float) -> tuple[float, float]:
    """The slope of the negative log likelihood by a sensor's lag, and what the innovations' variances s alone tell of it:
    sum (d ln s)^2 / 2. A lag smooths the process noise too, which slopes of the innovations under fixed gains know nothing of.

    Taken over a standard deviation to both sides, by the information `known` from those slopes: closer by, an axis that comes to rest
    a row earlier decides. Rows whose variance jumps for that have no slope. NaN where the filter fails on a side.
    """
    lag_s = entry.of(hypothesis)
    reach = min(1.0 / np.sqrt(known), WIDEST * lag_s) if known > 0.0 else WIDEST * lag_s
    below, above = (passes(case, _with_number(hypothesis, entry, lag_s + side * reach)) for side in (-1.0, 1.0))
    if below is None or above is None:
        return np.nan, np.nan
    change = np.concatenate([np.log(one.s / other.s).ravel() for one, other in zip(above, below, strict=True)])
    change = np.where(np.abs(change) < LAG_JUMP, change, 0.0) / (2.0 * reach)
    return (likelihood(below) - likelihood(above)) / (2.0 * reach), 0.5 * float(change @ change)


def _is_loss(entry: Free) -> bool:
    return entry.parameter.role is Role.LOSS


def _knows_losses(case: Case) -> bool:
    """Whether the readings said which frames were lost."""
    return any(bool(flight.filter_input.lost.any()) for flight in case.flights)


def flat_slopes(run: Pass) -> Array:
    """Slopes (rows, columns) of all whitened innovations of a pass; none of them where nothing is uncertain."""
    if run.dw is None:
        return np.zeros((run.w.size, 0))
    return run.dw.reshape(-1, run.dw.shape[2])


def _difference(case: Case, hypothesis: Hypothesis, entry: Free, w: Array) -> Array:
    """The slope by a number that acts on the way of a signal, from a small step away from its bound."""
    value = entry.of(hypothesis)
    step = DIFFERENCE * entry.scale
    step = step if value + step <= entry.parameter.upper else -step
    runs = passes(case, _with_number(hypothesis, entry, value + step))
    return np.zeros_like(w) if runs is None else (stacked(runs) - w) / step


def _with_number(hypothesis: Hypothesis, entry: Free, value: float) -> Hypothesis:
    """The same with another value of one number."""
    return hypothesis.with_value(entry.effect, entry.parameter.symbol, value, entry.log)
