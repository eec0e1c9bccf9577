"""What every form gains beside a fit: all are answered at once, some instants at a time, so that their answers are never whole."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import reduce
from itertools import pairwise
from operator import add

import numpy as np
from numpy.typing import NDArray

from diagnosis import decisions
from diagnosis.detect.forms import Form, forms
from diagnosis.detect.linearisation import Linearisation, Scores
from diagnosis.detect.replicas import replicas
from jobs.thread_map import thread_map

Array = NDArray[np.float64]
Answers = tuple[NDArray[np.int64], Array]  # places (m,) among all whitened innovations, and what changes there (m, k)
MEAN_GAIN = 0.5  # of white innovations


@dataclass(frozen=True, eq=False)
class FormScores:
    """Every form beside a fit: its scores, and what it usually gains where it says nothing (forms,)."""

    forms: tuple[Form, ...]
    scores: Scores
    null_gain: Array


@dataclass(frozen=True, eq=False)
class Products:
    """Of columns E (rows, k) with what stands beside them, slopes J (rows, free), innovations w (rows,) and replicas D (rows, r): `gram`
    E'E (k, k), `drawn` E'D (k, r), and by second of the logs `beside` [J w]'E (seconds, free + 1, k) and `squares` (seconds, k)."""

    gram: Array
    drawn: Array
    beside: Array
    squares: Array

    @property
    def cross(self) -> Array:
        """J'E (free, k)."""
        return np.asarray(self.beside[:, :-1].sum(axis=0))

    def __add__(self, other: "Products") -> "Products":
        """Those of both in a row."""
        return Products(
            self.gram + other.gram,
            self.drawn + other.drawn,
            self.beside + other.beside,
            self.squares + other.squares,
        )

    def scores(self, linearisation: Linearisation) -> Scores:
        """The scores of the columns."""
        return linearisation.scores(self.gram, self.cross, self.beside[:, -1].sum(axis=0))


@dataclass(frozen=True, eq=False)
class Answered:
    """All forms with the products of their answers, their scores, and what they gain in replicas without gap (forms, replicas)."""

    forms: tuple[Form, ...]
    products: Products
    scores: Scores
    null: Array

    def by_chance(self) -> FormScores:
        """Their scores with what replicas gain in the mean."""
        return FormScores(self.forms, self.scores, self.null.mean(axis=1))


def form_scores(linearisation: Linearisation) -> FormScores:
    """What every form gains beside a fit."""
    answered = answers(linearisation, replicas(linearisation))
    scatter = scatter_of_scores(linearisation, answered.products)
    return FormScores(answered.forms, answered.scores, np.maximum(answered.null.mean(axis=1), MEAN_GAIN * scatter))


def answers(linearisation: Linearisation, drawn: Array) -> Answered:
    """All forms beside a fit, answered; `drawn` (rows, replicas) are innovations without gap."""
    found = tuple(forms(linearisation))
    flights = range(len(linearisation.runs))

    def over(flight: int) -> Products:
        return products(linearisation, drawn, _answers(linearisation, found, flight), len(found))

    whole = reduce(add, thread_map(over, flights))
    scores = whole.scores(linearisation)
    return Answered(found, whole, scores, null_gains(linearisation, scores, whole.cross, whole.drawn, drawn))


def products(linearisation: Linearisation, drawn: Array, parts: Iterable[Answers], count: int) -> Products:
    """The products of `count` columns that come in parts."""
    begins, own = linearisation.seconds(), linearisation.own
    gram, met = np.zeros((count, count)), np.zeros((count, drawn.shape[1]))
    beside, squares = np.zeros((len(begins), own.shape[1], count)), np.zeros((len(begins), count))
    for rows, E in parts:
        gram += E.T @ E
        met += E.T @ drawn[rows]
        second = np.searchsorted(begins, rows, side="right") - 1
        for of in np.unique(second).tolist():
            here = second == of
            beside[of] += own[rows[here]].T @ E[here]
            squares[of] += np.einsum("ij,ij->j", E[here], E[here])
    return Products(gram, met, beside, squares)


def _answers(linearisation: Linearisation, found: Sequence[Form], flight: int) -> Iterator[Answers]:
    """The answers of one flight to all forms, side by side."""
    if not found:
        return
    first = sum(run.w.size for run in linearisation.runs[:flight])
    targets = np.array([form.target for form in found])
    values = np.stack([form.values[flight] for form in found], axis=1)
    chosen = [np.flatnonzero(targets == target) for target in np.unique(targets)]
    asked = [linearisation.answers(flight, values[:, own].__getitem__, int(targets[own[0]])) for own in chosen]
    for parts in zip(*asked, strict=True):
        rows = parts[0][0]
        E = np.zeros((len(rows), len(found)))
        for own, (_, changes) in zip(chosen, parts, strict=True):
            E[:, own[: changes.shape[1]]] = changes
        yield first + rows, E


def scatter_of_scores(linearisation: Linearisation, of: Products) -> Array:
    """How much more the scores of columns scatter than white innovations would make them (k,).

    (1)  J / I = sum over seconds b of (g_b - theta I_b)^2 / sum of I_b,   theta = sum of g_b / sum of I_b

    with the score g_b and the information I_b of each second, the plant's coefficients taken out: the sandwich of White (1982) by blocks.
    A disturbance that lasts makes innovations alike for a while, and a gain that much larger by chance.
    """
    begins, share = linearisation.seconds(), linearisation.solve @ of.cross
    own = [linearisation.own[first:last] for first, last in pairwise([*begins.tolist(), len(linearisation.w)])]
    met = np.stack([second[:, :-1].T @ second for second in own])  # J'[J w]
    score = np.einsum("bi,ik->bk", met[:, :, -1], share) - of.beside[:, -1]
    double = 2.0 * of.beside[:, :-1] - np.einsum("bij,jk->bik", met[:, :, :-1], share)
    information = np.maximum(of.squares - np.einsum("ik,bik->bk", share, double), 0.0)
    total = np.maximum(information.sum(axis=0), 1e-12)
    theta = score.sum(axis=0) / total
    return np.asarray(np.sum((score - theta * information) ** 2, axis=0) / total)


def gains(scores: Scores) -> Array:
    """Gain of the log likelihood by each column alone (k,); 0 where the plant's coefficients imitate it."""
    norm = np.diag(scores.gram)
    return np.where(_counts(scores), 0.5 * scores.score**2 / np.maximum(norm, 1e-12), 0.0)


def null_gains(linearisation: Linearisation, scores: Scores, cross: Array, met: Array, drawn: Array) -> Array:
    """The same (k, replicas) of innovations without gap, `drawn` (rows, replicas), whose products with the columns are `met` (k, replicas),
    those of the slopes `cross` (free, k)."""
    share = linearisation.solve @ cross
    score = met - share.T @ (linearisation.slopes.T @ drawn)
    norm = np.maximum(np.diag(scores.gram), 1e-12)[:, None]
    return np.where(_counts(scores)[:, None], 0.5 * score**2 / norm, 0.0)


def _counts(scores: Scores) -> NDArray[np.bool_]:
    """Which columns (k,) the plant's coefficients do not imitate."""
    return np.asarray(np.diag(scores.gram) > decisions.LEAST_LEFT_SHARE * np.maximum(scores.raw, 1e-12))
