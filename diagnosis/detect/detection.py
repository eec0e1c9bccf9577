"""Is there a gap at all? The largest score of all effects and forms against its law in replicas without gap, and how far the plant's
own parameters had to leave what is stated of them."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import mpmath
import numpy as np
from numpy.typing import NDArray

from diagnosis import decisions
from diagnosis.decisions import held_against
from diagnosis.detect.forms import Form, forms
from diagnosis.detect.instants import disturbed_by
from diagnosis.detect.linearisation import Linearisation, Scores
from diagnosis.detect.replicas import Tail, replicas, tail_of
from diagnosis.detect.score_tests import ScoreTest
from diagnosis.fit.gauss_newton import Fit, away, prior_chi_squared, size_scale
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import passes
from jobs.thread_map import thread_map
from records.reasons import Decision

Array = NDArray[np.float64]
MEAN_GAIN = 0.5  # of white innovations


@dataclass(frozen=True, eq=False)
class FormScores:
    """Every form beside a fit: its scores, and what it usually gains where it says nothing (forms,)."""

    forms: tuple[Form, ...]
    scores: Scores
    null_gain: Array


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


def detect(
    case: Case, linearisation: Linearisation, score_tests: Sequence[ScoreTest], lossy: Fit | None = None
) -> Detection:
    """Compare the gains of effects at their best starts, of lost frames, of steps in time and of all forms with replicas."""
    found = forms(linearisation)
    of_effects, of_forms, drawn = _at_once(
        lambda: _effect_columns(case, linearisation, score_tests),
        lambda: _form_columns(linearisation, found),
        lambda: replicas(linearisation),
    )
    (by_form, null_forms), (effects, null_effects), (events, null_events) = _at_once(
        lambda: _gains_of(linearisation, of_forms, drawn),
        lambda: _gains_of(linearisation, of_effects, drawn),
        lambda: _events(case, linearisation, drawn),
    )
    null = np.concatenate([null_forms, null_effects])
    usual = np.maximum(1.0, null.mean(axis=1) / MEAN_GAIN)
    seen = np.concatenate([gains(by_form), gains(effects)]) / usual
    outside = [entry.gain for entry in score_tests if not case.library.carried(entry.effect)]
    outside += [] if lossy is None else [lossy.log_posterior - linearisation.fit.log_posterior]
    largest = max([*events, *outside, float(np.max(seen, initial=0.0))])
    tail = tail_of(np.max(np.concatenate([null / usual[:, None], null_events]), axis=0))
    chances = {
        "largest_gain": tail.probability(largest - _allowed(case)),
        "parameters_together": _prior_tail(case, linearisation.fit),
        "parameter_furthest": moved_tail(case, linearisation.fit),
    }
    p = min(1.0, len(chances) * min(chances.values()))
    limit = decisions.ALARM / len(chances)  # each test has its share of the level (Bonferroni)
    moved = min(chances["parameters_together"], chances["parameter_furthest"]) <= limit
    rules = tuple(_rule(name, chance, limit) for name, chance in chances.items())
    return Detection(p, tail, largest, moved, FormScores(tuple(found), by_form, null_forms.mean(axis=1)), rules)


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


def form_scores(linearisation: Linearisation) -> FormScores:
    """What every form gains beside a fit."""
    found = forms(linearisation)
    columns, drawn = _at_once(lambda: _form_columns(linearisation, found), lambda: replicas(linearisation))
    scores, null = _gains_of(linearisation, columns, drawn)
    usual = np.maximum(null.mean(axis=1), MEAN_GAIN * scatter_of_scores(linearisation, columns))
    return FormScores(tuple(found), scores, usual)


def scatter_of_scores(linearisation: Linearisation, columns: Array) -> Array:
    """How much more the scores of columns (rows, k) scatter than white innovations would make them (k,).

    (1)  J / I = sum over seconds b of (g_b - theta I_b)^2 / sum of I_b,   theta = sum of g_b / sum of I_b

    with the score g_b and the information I_b of each second, the plant's coefficients taken out: the sandwich of White (1982) by blocks.
    A disturbance that lasts makes innovations alike for a while, and a gain that much larger by chance.
    """
    own = columns - linearisation.slopes @ (linearisation.solve @ (linearisation.slopes.T @ columns))
    begins = linearisation.seconds()
    score = -np.add.reduceat(own * linearisation.w[:, None], begins, axis=0)
    information = np.add.reduceat(own**2, begins, axis=0)
    total = np.maximum(information.sum(axis=0), 1e-12)
    theta = score.sum(axis=0) / total
    return np.asarray(np.sum((score - theta * information) ** 2, axis=0) / total)


def _at_once(*pieces: Callable[[], Any]) -> list[Any]:
    """What the pieces return, in their order."""
    return thread_map(lambda piece: piece(), pieces)


def _gains_of(linearisation: Linearisation, columns: Array, drawn: Array) -> tuple[Scores, Array]:
    """Scores of the columns (rows, k), and their gains in replicas (k, replicas)."""
    scores = linearisation.scores_of(columns)
    return scores, _null_gains(linearisation, columns, scores, drawn)


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


def gains(scores: Scores) -> Array:
    """Gain of the log likelihood by each column alone (k,); 0 where the plant's coefficients imitate it."""
    norm = np.diag(scores.gram)
    counts = norm > decisions.LEAST_LEFT_SHARE * np.maximum(scores.raw, 1e-12)
    return np.where(counts, 0.5 * scores.score**2 / np.maximum(norm, 1e-12), 0.0)


def _null_gains(linearisation: Linearisation, columns: Array, scores: Scores, drawn: Array) -> Array:
    """Gains (k, replicas)."""
    share = linearisation.solve @ (linearisation.slopes.T @ columns)
    score = columns.T @ drawn - share.T @ (linearisation.slopes.T @ drawn)
    norm = np.diag(scores.gram)
    counts = (norm > decisions.LEAST_LEFT_SHARE * np.maximum(scores.raw, 1e-12))[:, None]
    return np.where(counts, 0.5 * score**2 / np.maximum(norm, 1e-12)[:, None], 0.0)


def _events(case: Case, linearisation: Linearisation, drawn: Array) -> tuple[list[float], Array]:
    """The largest gain of steps and pulses in time by target, in the log and in replicas (targets, replicas).

    Each gain counts in units of what that step or pulse usually gains without a gap: rounding at rest looks like steps.
    """
    library = case.library
    targets = {disturbed_by(case, library.effects[name]) for name in library.candidates}
    known = sorted(target for target in targets if target is not None)
    pairs = thread_map(lambda target: _pulses(linearisation, drawn, target), known)
    return [seen for seen, _ in pairs], np.array([np.zeros(drawn.shape[1]), *(null for _, null in pairs)])


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


def _form_columns(linearisation: Linearisation, found: Sequence[Form]) -> Array:
    columns = np.zeros((len(linearisation.w), len(found)))
    for target in sorted({form.target for form in found}):
        chosen = [index for index, form in enumerate(found) if form.target == target]
        values = [
            np.stack([found[i].values[flight] for i in chosen], axis=1)
            for flight in range(len(linearisation.filter_inputs))
        ]
        columns[:, chosen] = linearisation.answer([value.__getitem__ for value in values], target)
    return columns
