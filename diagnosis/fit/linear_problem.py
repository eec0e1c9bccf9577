"""The linear problem of a fit at a point: information and pull of all numbers, by slopes of the whitened innovations under fixed gains."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from diagnosis.filter.kalman import Pass
from diagnosis.fit.free_numbers import Free
from diagnosis.fit.known_before import add_prior, log_prior
from diagnosis.fit.likelihood import flat_slopes, likelihood, likelihood_of, stacked
from diagnosis.hypothesis.case import Case, FilteredLog
from diagnosis.hypothesis.hypothesis import SHORTEST_LAG_S, Hypothesis, Lack, passes
from diagnosis.library.effect_library import CompiledFilter
from diagnosis.library.input_effects import share_slopes
from sim.effect import Role

Array = NDArray[np.float64]
DIFFERENCE = 1e-3  # finite differences, in units of a parameter's scale
WIDEST, LAG_JUMP = 0.05, 0.3  # of a lag, over which its slope is taken at most; how much of ln s is a jump there


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


def linear(case: Case, hypothesis: Hypothesis, free: tuple[Free, ...], least: float = -np.inf) -> Fit | None:
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
        _add_differences(case, hypothesis, runs, columns, information, pull)
    for row, entry in enumerate(free, count):
        late = case.library.effects[entry.effect].reads_late
        if late and entry.of(hypothesis) > SHORTEST_LAG_S:
            pull[row], further = _smoothed(case, hypothesis, entry, float(information[row, row]))
            information[row, row] += further
    information *= np.outer(scale, scale)
    pull *= scale
    if not (np.isfinite(information).all() and np.isfinite(pull).all()):
        return None  # slopes that overflow: as good as a filter that fails
    add_prior(case, hypothesis, free, information, pull)
    if not _is_definite(information):
        return None
    return Fit(hypothesis, found, log_posterior, free, information, pull)


def log_posterior_of(case: Case, hypothesis: Hypothesis, free: Sequence[Free]) -> float:
    """The log of the likelihood and of what is known beforehand, -inf where the filter left all bounds."""
    return likelihood_of(case, hypothesis) + log_prior(case, hypothesis, free)


def tempered(case: Case, found: Fit, scale: float) -> Fit:
    """The fit with what is known of its numbers where the likelihood L counts as L^(1 / scale), as no model is exact: with C the prior's,

    A' = (A - C) / scale + C    (Miller and Dunson 2019)
    """
    prior = np.zeros_like(found.information)
    add_prior(case, found.hypothesis, found.free, prior, np.zeros_like(found.pull))
    return replace(found, information=prior + (found.information - prior) / scale, tempering=scale)


class _Columns:
    """Which columns of a pass are the slopes by which of the fitted numbers: theta first, then those of `free` that the equations hold; of
    what a log lacks it tells nothing.

    `places` are the pass' columns as places in p; a number that each log has for itself takes the same column in all of them.
    """

    def __init__(self, case: Case, compiled: CompiledFilter, free: Sequence[Free], lacks: Mapping[str, Lack]) -> None:
        self._count, self.free, self._lacks = len(case.free), free, lacks
        inside = [(row, entry) for row, entry in enumerate(free, self._count) if entry.effect in compiled.names]
        own = {row: compiled.place(entry.effect, entry.parameter.symbol) for row, entry in inside}
        further = list(dict.fromkeys(own.values()))
        self.places: list[int] = [*case.free.tolist(), *further]
        self.rows = np.array([*range(self._count), *own], dtype=int)
        self._column = {row: self._count + further.index(place) for row, place in own.items()}

    def of(self, log: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """The numbers that a log tells of, and the column of each in its pass."""
        rows = [
            row for row in self.rows.tolist() if row < self._count or self._tells(self.free[row - self._count], log)
        ]
        return np.array(rows, dtype=int), np.array([self._column.get(row, row) for row in rows], dtype=int)

    def _tells(self, entry: Free, log: int) -> bool:
        lack = self._lacks.get(entry.effect)
        return entry.log in (None, log) and (lack is None or log not in lack.logs)


def _add_differences(
    case: Case,
    hypothesis: Hypothesis,
    runs: Sequence[Pass],
    columns: "_Columns",
    information: Array,
    pull: Array,
) -> None:
    """Rows and columns of numbers that act on the way of a signal, by finite differences."""
    w, own, free = stacked(runs), columns.rows, columns.free
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


def _is_definite(information: Array) -> bool:
    """Whether it can be solved with: a size in a wild unit may drown all others."""
    try:
        np.linalg.cholesky(information)
    except np.linalg.LinAlgError:
        return False
    return True
