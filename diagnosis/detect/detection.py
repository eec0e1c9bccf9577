"""Is there a gap at all? The largest score of all effects and forms against its law in replicas without gap, and how far the plant's
own parameters had to leave what is stated of them."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import mpmath
import numpy as np
from numpy.typing import NDArray

from diagnosis import decisions
from diagnosis.decisions import held_against
from diagnosis.detect.form_scores import MEAN_GAIN, FormScores, answers, gains, null_gains
from diagnosis.detect.instants import disturbed_by
from diagnosis.detect.linearisation import Linearisation
from diagnosis.detect.replicas import Tail, replicas, tail_of
from diagnosis.detect.starts import ScoreTest
from diagnosis.fit.free_numbers import size_scale
from diagnosis.fit.known_before import away, prior_chi_squared
from diagnosis.fit.linear_problem import Fit
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import passes
from jobs.thread_map import at_once, thread_map
from records.reasons import Decision

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Detection:
    """`p` the chance of so large a gap without one, the law it comes from, the largest gain, and what each form gains; `moved` says
    whether the plant follows its logs only by parameters that are hardly those of its file."""

    p: float
    tail: Tail
    largest: float
    moved: bool
    by_form: FormScores
    decisions: tuple[Decision, ...] = ()


@dataclass(frozen=True, eq=False)
class _Gains:
    """Gains of the log likelihood (k,) by what may be missing, and the same in replicas without gap (k, replicas)."""

    seen: Array
    null: Array

    def usual(self) -> "_Gains":
        """The same in units of what each usually gains without a gap."""
        usual = np.maximum(1.0, self.null.mean(axis=1) / MEAN_GAIN)
        return _Gains(self.seen / usual, self.null / usual[:, None])

    def beside(self, other: "_Gains") -> "_Gains":
        """Both."""
        return _Gains(np.concatenate([self.seen, other.seen]), np.concatenate([self.null, other.null]))


def detect(
    case: Case, linearisation: Linearisation, tests: Callable[[], Sequence[ScoreTest]], lossy: Fit | None = None
) -> tuple[Detection, tuple[ScoreTest, ...] | None]:
    """Compare the gains of lost frames, of steps in time and of all forms with replicas; where that leaves a gap open, also
    those of effects at their best starts, which `tests` scores and which are then returned."""
    drawn = replicas(linearisation)
    answered, events = at_once(lambda: answers(linearisation, drawn), lambda: _events(case, linearisation, drawn))
    lost = 0.0 if lossy is None else lossy.log_posterior - linearisation.fit.log_posterior
    told = _Gains(gains(answered.scores), answered.null).usual().beside(events).beside(_without_law([lost], drawn))
    of_forms = answered.by_chance()
    detection = _detection(case, linearisation, told, of_forms)
    if detection.p <= decisions.ALARM and detection.largest > decisions.PLAIN_TO_SEE:
        return detection, None
    score_tests = tuple(tests())
    told = told.beside(_of_effects(case, linearisation, score_tests, drawn))
    return _detection(case, linearisation, told, of_forms), score_tests


def _detection(case: Case, linearisation: Linearisation, told: _Gains, by_form: FormScores) -> Detection:
    """What these gains say of a gap, and the plant's own parameters."""
    largest = float(np.max(told.seen, initial=0.0))
    tail = tail_of(np.max(told.null, axis=0))
    chances = {
        "largest_gain": tail.probability(largest - _allowed(case)),
        "parameters_together": _prior_tail(case, linearisation.fit),
        "parameter_furthest": moved_tail(case, linearisation.fit),
    }
    p = min(1.0, len(chances) * min(chances.values()))
    limit = decisions.ALARM / len(chances)  # each test has its share of the level (Bonferroni)
    moved = min(chances["parameters_together"], chances["parameter_furthest"]) <= limit
    rules = tuple(_rule(name, chance, limit) for name, chance in chances.items())
    return Detection(p, tail, largest, moved, by_form, rules)


def _of_effects(case: Case, linearisation: Linearisation, score_tests: Sequence[ScoreTest], drawn: Array) -> _Gains:
    """Those of effects, of which the ones in the equations count by first order."""
    columns = _effect_columns(case, linearisation, score_tests)
    scores, cross = linearisation.scores_of(columns), linearisation.slopes.T @ columns
    null = null_gains(linearisation, scores, cross, columns.T @ drawn, drawn)
    outside = [entry.gain for entry in score_tests if not case.library.carried(entry.effect)]
    return _Gains(gains(scores), null).usual().beside(_without_law(outside, drawn))


def _without_law(found: Sequence[float], drawn: Array) -> _Gains:
    """Gains of what no replica has: frames that were lost, what acts on the way of a signal."""
    return _Gains(np.array(found), np.zeros((len(found), drawn.shape[1])))


def _allowed(case: Case) -> float:
    """Nats that may be gained without a gap: laws of friction differ in what no parameter of one can mimic."""
    rubs = len(case.library.frictionless) < len(case.library.bound.model.axes)
    return decisions.TAKEN_IN if rubs else 0.0


def _rule(name: str, chance: float, limit: float) -> Decision:
    """One test of "no gap"."""
    return held_against(name, "logs", chance, limit, decisions.ALARM.unit, "gap" if chance <= limit else "no gap")


def _prior_tail(case: Case, found: Fit) -> float:
    """The chance that all numbers that the plant file states went together so far from there."""
    count = len(away(found.hypothesis, found.free))
    return chi_squared_tail(count, prior_chi_squared(case, found.hypothesis, found.free))


def chi_squared_tail(count: int, value: float) -> float:
    """The chance that the squares of `count` standard normal numbers sum to `value` or more: Q(count / 2, value / 2), the regularised
    upper incomplete gamma function; 1 where nothing is counted."""
    return float(mpmath.gammainc(0.5 * count, 0.5 * value, regularized=True)) if count else 1.0


def moved_tail(case: Case, found: Fit) -> float:
    """The chance that the number that left what is stated furthest went so far, of all that are stated, less TOLERATED_MOVE deviations.

    A number that logs tell exactly moves by one standard deviation of its stated spread, one of which they tell nothing does not move.
    """
    moved = away(found.hypothesis, found.free)
    stated = [
        *range(len(case.free)),
        *(len(case.free) + k for k, entry in enumerate(found.free) if entry.stated is not None),
    ]
    known = np.diag(np.linalg.pinv(found.information))[stated]
    furthest = (
        float(np.max(np.abs(moved) / np.sqrt(np.maximum(1.0 - known, decisions.NEGLIGIBLE_SHARE)), initial=0.0))
        - decisions.TOLERATED_MOVE
    )
    return min(1.0, len(moved) * float(mpmath.erfc(furthest / np.sqrt(2.0))))


def _events(case: Case, linearisation: Linearisation, drawn: Array) -> _Gains:
    """The largest gain of steps and pulses in time of each target.

    Each gain counts in units of what that step or pulse usually gains without a gap: rounding at rest looks like steps.
    """
    library = case.library
    targets = {disturbed_by(case, library.effects[name]) for name in library.candidates}
    known = sorted(target for target in targets if target is not None)
    pairs = thread_map(lambda target: _pulses(linearisation, drawn, target), known)
    null = np.array([found for _, found in pairs]).reshape(len(pairs), drawn.shape[1])
    return _Gains(np.array([seen for seen, _ in pairs]), null)


def _pulses(linearisation: Linearisation, drawn: Array, target: int) -> tuple[float, Array]:
    """The largest gain of steps and pulses of one target, in the log and in each replica."""
    _, scores = linearisation.steps(target)
    met = linearisation.steps_against(target, np.concatenate([drawn, linearisation.slopes], axis=1))
    replicas = drawn.shape[1]
    score = met[:, :replicas] - met[:, replicas:] @ linearisation.solve @ (linearisation.slopes.T @ drawn)
    gram = scores.gram
    first, last = _spans(len(gram))
    norm = np.maximum(gram[first, first] + gram[last, last] - 2.0 * gram[first, last], 1e-12)
    null = 0.5 * (score[first] - score[last]) ** 2 / norm[:, None]
    usual = np.maximum(1.0, null.mean(axis=1) / MEAN_GAIN)
    seen = float(np.max(0.5 * (scores.score[first] - scores.score[last]) ** 2 / norm / usual))
    return seen, np.max(null / usual[:, None], axis=0)


def _spans(count: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Pairs of a step and a later one, at distances that grow as Fibonacci's numbers."""
    lengths = [1, 2]
    while lengths[-1] + lengths[-2] < count:
        lengths.append(lengths[-1] + lengths[-2])
    pairs = [(start, start + length) for length in lengths for start in range(count - length)]
    return np.array([one for one, _ in pairs], dtype=int), np.array([other for _, other in pairs], dtype=int)


def _effect_columns(case: Case, linearisation: Linearisation, score_tests: Sequence[ScoreTest]) -> Array:
    """Signatures of the effects in the equations, from where they were seen best."""
    library, hypothesis = case.library, linearisation.fit.hypothesis
    chosen = [entry for entry in score_tests if entry.effect in library.names]
    values = {}
    for entry in chosen:
        size = library.effects[entry.effect].size
        values[entry.effect] = {**entry.values, size.symbol: size.touched}
    compiled = library.compiled((*hypothesis.effects, *values))
    places = [compiled.place(name, library.effects[name].size.symbol) for name in values]
    runs = passes(case, hypothesis.with_effects({**values, **hypothesis.effects}), places, slopes=True)
    rows = len(linearisation.w)
    if runs is None or not places:
        return np.zeros((rows, 0))
    slopes = np.concatenate([run.dw.reshape(-1, len(places)) for run in runs if run.dw is not None])
    return np.asarray(slopes * [size_scale(library.effects[name].size) for name in values])
