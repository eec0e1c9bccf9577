"""Where looks are taken from: a fit, what projects its numbers out, and how the filter there answers small disturbances."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from diagnosis.abreast import each
from diagnosis.case import Case
from diagnosis.filter import Filter, Pass
from diagnosis.fit import Fit, flat_slopes, stacked
from diagnosis.hypothesis import passes, tape_under
from diagnosis.tape import Tape

Array = NDArray[np.float64]
GRID_S = 0.3
MOST_STEPS = 200


@dataclass(frozen=True, eq=False)
class Scores:
    """Of k columns: squared norms (k, k) and scores -column'w (k,), what the plant's own coefficients imitate taken out; `raw` (k,) the
    squared norms before."""

    gram: Array
    score: Array
    raw: Array


@dataclass(frozen=True, eq=False)
class Ground:
    """A fit with its whitened innovations w (rows,) and their slopes (rows, free) by the plant's coefficients, in standard deviations.

    `solve` (free, free) is the inverse information of the coefficients alone; `runs` and `tapes` are the filter's passes, with gains.
    """

    case: Case
    fit: Fit
    w: Array
    slopes: Array
    solve: Array
    runs: tuple[Pass, ...]
    tapes: tuple[Tape, ...]
    filter: Filter
    kept: dict[int, tuple[Array, Scores]] = field(default_factory=dict)
    answers: dict[int, Array] = field(default_factory=dict)

    def still_to_gain(self, w: Array) -> float:
        """What moving the plant's coefficients would add to the log likelihood of innovations w, to first order."""
        pull = self.slopes.T @ w + self.case.pull_of(self.fit.supposed.theta)
        return 0.5 * float(pull @ self.solve @ pull)

    def scores(self, gram: Array, cross: Array, pull: Array) -> Scores:
        """Scores of columns with products gram = E'E (k, k), cross = J'E (free, k) and pull = E'w (k,)."""
        share = self.solve @ cross
        own = self.slopes.T @ self.w + self.case.pull_of(self.fit.supposed.theta)
        return Scores(gram - cross.T @ share, -(pull - share.T @ own), np.diag(gram).copy())

    def scores_of(self, columns: Array) -> Scores:
        """Scores of columns (rows, k)."""
        return self.scores(columns.T @ columns, self.slopes.T @ columns, columns.T @ self.w)

    def gains_of(self, columns: Array) -> Array:
        """Gain of the log likelihood (k,) by each of columns (rows, k) alone, in its own direction only."""
        cross = self.slopes.T @ columns
        share = self.solve @ cross
        own = self.slopes.T @ self.w + self.case.pull_of(self.fit.supposed.theta)
        norm = np.einsum("ij,ij->j", columns, columns) - np.einsum("ij,ij->j", cross, share)
        score = share.T @ own - columns.T @ self.w
        return np.asarray(0.5 * np.maximum(score, 0.0) ** 2 / np.maximum(norm, 1e-12))

    def answer(self, values: Sequence[Array], target: int) -> Array:
        """Change of all whitened innovations, shape (rows, k), by disturbances values[flight] (steps, k) of one target, see filter.py."""
        own = len(self.case.kit.states)
        if target >= own:
            target += self.filter.states - own

        width = max(self.case.slots) + 1
        found = np.zeros((sum(tape.rows for tape in self.tapes) * width, values[0].shape[1]))
        ends = np.cumsum([tape.rows * width for tape in self.tapes])[:-1]

        def over(tape: Tape, run: Pass, value: Array, room: Array) -> None:
            into = room.reshape(tape.rows, width, -1)
            self.filter.respond(tape, run, value[:, None, :], [target], self.case.slots, into)

        each(over, self.tapes, self.runs, values, np.split(found, ends))
        return found

    def steps(self, target: int) -> tuple[Array, Scores]:
        """Instants (k,) and the scores of unit steps at them, in acceleration or in the output, of one target."""
        if target not in self.kept:
            answers = self.answers_to_steps(target)
            self.kept[target] = self.instants(), self.scores_of(answers)
        return self.kept[target]

    def answers_to_steps(self, target: int) -> Array:
        """Answers (rows, k) to unit steps of one target."""
        if target not in self.answers:
            values = []
            for tape in self.tapes:
                on = (tape.t_s[:, None] >= self.instants()[None, :] - 1e-9).astype(float)
                moves = target < len(self.case.kit.states)
                values.append(on * np.append(np.diff(tape.t_s), 0.0)[:, None] if moves else on)
            self.answers[target] = self.answer(values, target)
        return self.answers[target]

    def instants(self) -> Array:
        """The grid of instants of steps (k,), in s."""
        end = max(tape.t_s[-1] for tape in self.tapes)
        return np.arange(0.0, end, max(GRID_S, end / MOST_STEPS))


def ground_of(case: Case, fit: Fit) -> Ground:
    """The ground at a fit."""
    supposed = fit.supposed
    variant = case.kit.variant(supposed.effects)
    runs = passes(case, supposed, case.free.tolist(), slopes=True, gains=True)
    assert runs is not None
    slopes = np.concatenate([flat_slopes(run) for run in runs]) * case.sd
    return Ground(
        case=case,
        fit=fit,
        w=stacked(runs),
        slopes=slopes,
        solve=np.asarray(np.linalg.inv(slopes.T @ slopes + case.known), float),
        runs=tuple(runs),
        tapes=tuple(tape_under(case, variant, flight, supposed.effects) for flight in case.flights),
        filter=variant.filter,
    )
