"""Where score tests are taken from: a fit, what projects its numbers out, and how the filter there answers small disturbances."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from diagnosis.filter.filter_input import FilterInput
from diagnosis.filter.kalman import Disturbances, Filter, Pass, columns_of
from diagnosis.fit.likelihood import flat_slopes, likelihood, stacked
from diagnosis.fit.linear_problem import Fit
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import Hypothesis, filter_input_under, passes
from jobs.thread_map import thread_map

Array = NDArray[np.float64]
EVENT_GRID_S = 0.3  # between the steps in time that are scored
LEAST_EVENT_STEPS, MOST_EVENT_STEPS = 4, 200  # fewer tell no pulse from a step; more of a long log take time


@dataclass(frozen=True, eq=False)
class Scores:
    """Of k columns: squared norms (k, k) and scores -column'w (k,), what the plant's own coefficients imitate taken out; `raw` (k,) the
    squared norms before."""

    gram: Array
    score: Array
    raw: Array


@dataclass(frozen=True, eq=False)
class Linearisation:
    """A fit with its whitened innovations w (rows,) and their slopes (rows, free) by the plant's coefficients, in standard deviations.

    `solve` (free, free) is the inverse information of the coefficients alone; `runs` and `filter inputs` are the
    filter's passes, with gains.
    """

    case: Case
    fit: Fit
    w: Array
    slopes: Array
    solve: Array
    runs: tuple[Pass, ...]
    filter_inputs: tuple[FilterInput, ...]
    filter: Filter
    kept: dict[int, tuple[Array, Scores]] = field(default_factory=dict)

    def further(self, change: Array) -> tuple[float, float]:
        """What moving the plant's coefficients would add to the log likelihood, to first order, where the innovations changed by
        `change` (rows,), beyond what it would add here; and the share of the change that the coefficients imitate."""
        own = self.slopes.T @ change
        moved = self.solve @ own
        return float(moved @ (self.pull + 0.5 * own)), float(own @ moved / (change @ change))

    def moved_by(self, answers: Array) -> Array:
        """Where theta goes from here (free,), to first order, beside what the plant lacks and the logs have: `answers` (rows,) of it."""
        return np.asarray(-self.solve @ (self.pull - self.slopes.T @ answers))

    def scores(self, gram: Array, cross: Array, pull: Array) -> Scores:
        """Scores of columns with products gram = E'E (k, k), cross = J'E (free, k) and pull = E'w (k,)."""
        share = self.solve @ cross
        return Scores(gram - cross.T @ share, -(pull - share.T @ self.pull), np.diag(gram).copy())

    def scores_of(self, columns: Array) -> Scores:
        """Scores of columns (rows, k)."""
        return self.scores(columns.T @ columns, self.slopes.T @ columns, columns.T @ self.w)

    def scores_by(self, values: Sequence[Disturbances], target: int) -> Scores:
        """Scores of the answers to disturbances values[flight] (steps, k) of one target, see filter.py."""
        gram, beside = self._met(values, {target: 1.0}, lambda E, part: (E.T @ E, E.T @ part), self.own)
        return self.scores(gram, beside[:, :-1].T, beside[:, -1])

    def scores_apart(self, values: Sequence[Disturbances], target: int, spans: Sequence[slice]) -> list[Scores]:
        """The same of some spans of the columns, each by itself: of none with columns of another."""

        def terms(E: Array, part: Array) -> tuple[Array, ...]:
            return E.T @ part, *(E[:, span].T @ E[:, span] for span in spans)

        beside, *grams = self._met(values, {target: 1.0}, terms, self.own)
        told = [beside[span] for span in spans]
        return [self.scores(gram, own[:, :-1].T, own[:, -1]) for gram, own in zip(grams, told, strict=True)]

    def gains_by(self, values: Sequence[Disturbances], push: Array) -> Array:
        """Gain of the log likelihood (k,) by each of the answers to disturbances of the plant's own states, `push` (states,) times the
        values, alone and in its own direction only."""
        squares, beside = (sum(parts) for parts in zip(*self.beside_each(values, push), strict=True))
        norm, score = self.alone(np.asarray(squares), np.asarray(beside))
        return gain_alone(score, norm)

    def beside_each(self, values: Sequence[Disturbances], push: Array) -> list[tuple[Array, Array]]:
        """By flight the squares (k,) of those answers, and their products (k, free + 1) with the slopes and the innovations."""
        pushed = {int(state): float(push[state]) for state in np.flatnonzero(push)}
        found = self._met_each(values, pushed, lambda E, part: (np.einsum("ij,ij->j", E, E), E.T @ part), self.own)
        return [(squares, beside) for squares, beside in found]

    def alone(self, squares: Array, beside: Array) -> tuple[Array, Array]:
        """Squared norms (k,) and scores (k,) of columns by those sums over all flights, each beside the plant's coefficients alone."""
        cross, pull = beside[:, :-1].T, beside[:, -1]
        share = self.solve @ cross
        return squares - np.einsum("ij,ij->j", cross, share), share.T @ self.pull - pull

    def pulls(self, push: Array) -> list[Array]:
        """E'w by `push` (states,) added to the plant's own states over each step of each flight (steps,): for many disturbances at once."""

        def over(filter_input: FilterInput, run: Pass) -> Array:
            return self.filter.pulls(filter_input, run, self.case.slots)[:, : len(push)] @ push

        return thread_map(over, self.filter_inputs, self.runs)

    def steps(self, target: int) -> tuple[Array, Scores]:
        """Instants (k,) and the scores of unit steps at them, in acceleration or in the output, of one target."""
        if target not in self.kept:
            self.kept[target] = self.instants(), self.scores_by(self._unit_steps(target), target)
        return self.kept[target]

    def steps_against(self, target: int, columns: Array) -> Array:
        """Products (k, m) of the answers to those unit steps with columns (rows, m)."""
        return self._met(self._unit_steps(target), {target: 1.0}, lambda E, part: (E.T @ part,), columns)[0]

    def answer(self, values: Sequence[Disturbances], target: int) -> Array:
        """Change of all whitened innovations, shape (rows, k), by disturbances values[flight] (steps, k) of one target."""
        place = self._place(target)

        def over(filter_input: FilterInput, run: Pass, value: Disturbances) -> Array:
            return self.filter.response(filter_input, run, _weighed(value, [1.0]), [place], self.case.slots)

        return np.concatenate(
            [found.reshape(-1, found.shape[2]) for found in thread_map(over, self.filter_inputs, self.runs, values)]
        )

    def answers(self, flight: int, value: Disturbances, target: int) -> Iterator[tuple[NDArray[np.int64], Array]]:
        """The same of one flight, some of its instants at a time: as Filter.respond yields them, in room that the next part takes."""
        filter_input, run = self.filter_inputs[flight], self.runs[flight]
        return self.filter.respond(filter_input, run, _weighed(value, [1.0]), [self._place(target)], self.case.slots)

    def _met_each(
        self,
        values: Sequence[Disturbances],
        targets: Mapping[int, float],
        terms: Callable[[Array, Array], tuple[Array, ...]],
        columns: Array,
    ) -> list[tuple[Array, ...]]:
        """By flight the sums over its rows of what `terms` makes of the answers (rows, k) and of columns (rows, m), some rows at a time:
        each a multiple of the answers, so that those not disturbed yet would add nothing. Each target is disturbed by so many times the
        values."""
        sizes = [run.w.size for run in self.runs]
        places, weights = [self._place(target) for target in targets], list(targets.values())

        def over(filter_input: FilterInput, run: Pass, value: Disturbances, part: Array) -> tuple[Array, ...]:
            sums = terms(np.zeros((0, columns_of(value))), part[:0])
            for rows, E in self.filter.respond(filter_input, run, _weighed(value, weights), places, self.case.slots):
                for total, term in zip(sums, terms(E, part[rows]), strict=True):
                    total[tuple(slice(size) for size in term.shape)] += term
            return sums

        return thread_map(over, self.filter_inputs, self.runs, values, np.split(columns, np.cumsum(sizes)[:-1]))

    def _met(
        self,
        values: Sequence[Disturbances],
        targets: Mapping[int, float],
        terms: Callable[[Array, Array], tuple[Array, ...]],
        columns: Array,
    ) -> tuple[Array, ...]:
        """The same sums over all flights."""
        return tuple(sum(parts) for parts in zip(*self._met_each(values, targets, terms, columns), strict=True))

    @cached_property
    def pull(self) -> Array:
        """What the innovations and what is known of the coefficients say together of each (free,)."""
        return np.asarray(self.slopes.T @ self.w + self.case.pull_of(self.fit.hypothesis.theta))

    @cached_property
    def own(self) -> Array:
        """The slopes with the innovations behind them (rows, free + 1)."""
        return np.column_stack([self.slopes, self.w])

    def _unit_steps(self, target: int) -> list[Disturbances]:
        """Unit steps at the grid's instants by flight (steps, k)."""
        begins, moves = self.instants() - 1e-9, target < len(self.case.library.states)

        def steps(filter_input: FilterInput) -> Disturbances:
            height = np.append(np.diff(filter_input.t_s), 0.0) if moves else np.ones(len(filter_input.t_s))
            return lambda part: np.where(filter_input.t_s[part, None] >= begins, height[part, None], 0.0)

        return [steps(filter_input) for filter_input in self.filter_inputs]

    def _place(self, target: int) -> int:
        """A target of the library's own states and outputs, counted as the filter's."""
        own = len(self.case.library.states)
        return target if target < own else target + self.filter.states - own

    def seconds(self) -> NDArray[np.int64]:
        """Where in w each second of each log begins."""
        begins, first = [], 0
        for flight, run in zip(self.case.flights, self.runs, strict=True):
            since = (flight.log.t_s - flight.log.t_s[0]) / self.case.second_s
            rows = np.flatnonzero(np.diff(np.floor(since), prepend=-1.0) > 0.0)
            begins.append(first + rows * run.w.shape[1])
            first += run.w.size
        return np.concatenate(begins)

    def instants(self) -> Array:
        """The grid of instants of steps (k,), in s."""
        begin = min(filter_input.t_s[0] for filter_input in self.filter_inputs)
        end = max(filter_input.t_s[-1] for filter_input in self.filter_inputs)
        whole = end - begin
        apart = min(EVENT_GRID_S, whole / LEAST_EVENT_STEPS)
        return np.arange(begin, end, max(apart, whole / MOST_EVENT_STEPS))


def gain_alone(score: Array, norm: Array) -> Array:
    """Gain of the log likelihood (k,) by columns of these scores and squared norms (k,), each alone and in its own direction only."""
    return np.asarray(0.5 * np.maximum(score, 0.0) ** 2 / np.maximum(norm, 1e-12))


def _weighed(values: Disturbances, weights: Sequence[float]) -> Disturbances:
    """Disturbances (steps, k), so many times for each of some targets, as the filter takes them."""
    return lambda part: values(part)[:, None, :] * np.array(weights)[:, None]


def linearised(case: Case, fit: Fit) -> Linearisation:
    """The linearisation at a fit."""
    hypothesis = fit.hypothesis
    compiled = case.library.compiled(hypothesis.effects)
    runs = passes(case, hypothesis, case.free.tolist(), slopes=True, gains=True)
    assert runs is not None
    slopes = np.concatenate([flat_slopes(run) for run in runs]) * case.sd
    return Linearisation(
        case=case,
        fit=fit,
        w=stacked(runs),
        slopes=slopes,
        solve=np.asarray(np.linalg.inv(slopes.T @ slopes + case.known), float),
        runs=tuple(runs),
        filter_inputs=tuple(
            filter_input_under(case, compiled, flight, hypothesis.over(flight)) for flight in case.flights
        ),
        filter=compiled.filter,
    )


def answering(case: Case, hypothesis: Hypothesis) -> Linearisation | None:
    """The same of a hypothesis of which nothing is fitted: answers alone, beside no coefficients; None where it cannot be filtered."""
    compiled = case.library.compiled(hypothesis.effects)
    runs = passes(case, hypothesis, gains=True)
    if runs is None:
        return None
    w, none = stacked(runs), np.zeros((0, 0))
    fit = Fit(hypothesis, likelihood(runs), -np.inf, (), none, np.zeros(0))
    inputs = tuple(filter_input_under(case, compiled, flight, hypothesis.over(flight)) for flight in case.flights)
    return Linearisation(case, fit, w, np.zeros((len(w), 0)), none, tuple(runs), inputs, compiled.filter)
