"""The law of probabilities (records/model_comparison.py) fitted to examples: the most probable one, beforehand normal in each number.

Its two halves are apart: which of what explains is right, of answers that list it; and whether any of it is, of all, and of the same where
what is right was withheld. Now and then what is right was fitted so badly that no law of evidence finds it: such an answer, one in twenty
say, teaches the first half little, and is one to which nothing that was found is right.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize, minimize_scalar
from scipy.special import expit, softmax

from blind.calibration.examples import Example
from blind.calibration.withheld import withheld
from records.model_comparison import ComparisonLaw, features

Array = NDArray[np.float64]

# What is believed of the first half before any answer, (mean, standard deviation): that differences of some ten nats count at first, and of
# some fifty where forms explain ten thousand; that a further effect costs what any wrong effect gains by chance; that nats by which the
# logs are predicted over a second count in part, as they were fitted to.
BELIEVED = {"size": (1.2, 0.7), "power": (0.28, 0.1), "further": (2.5, 1.5), "ahead": (0.3, 0.3)}
# A free curve in place of the likeliest, log odds against it before the data, (mean, standard deviation), and where they are sought: of six
# gaps one is no library's, and a curve of what an effect depends on is often a scale likelier than the library's form of it.
CURVE_BELIEVED, CURVE_BOUNDS = (3.0, 1.5), (-5.0, 15.0)
INTERCEPT_DECAY = 0.01  # a standard deviation of ten logits, which only keeps it finite where all answers are right
UNVARIED_SD = 1e-9  # a feature with a smaller standard deviation does not vary
SLOPE = 1e-7  # nats per unit, at which the second half is at its end
ENDED = {
    "xatol": 1e-6,
    "fatol": 1e-9,
    "maxiter": 4000,
    "maxfev": 8000,
}  # the first half, of four numbers, without slopes
MISLED = 0.05  # of the answers, in which every candidate may be right alike
LEAST_FOUND = 0.01  # of a share: what is right and has less was not found
WITHHELD = 0.1  # of an answer, what each with a smaller library counts: of six gaps one is no library's

UNLEARNED = ComparisonLaw(*(mean for mean, _ in BELIEVED.values()), *[0.0] * 4, *[0.5] * 2)


def fit(examples: Sequence[Example], decay: float) -> ComparisonLaw:
    """The most probable law; `decay` is the inverse variance of each coefficient per standard deviation of its feature."""
    return with_explained(of_shares(examples), examples, decay)


def of_shares(examples: Sequence[Example]) -> ComparisonLaw:
    """The law with its first half, which no decay is of."""
    return _with_shares(UNLEARNED, [entry for entry in examples if any(entry.right)])


def partly(law: ComparisonLaw, examples: Sequence[Example], several: bool) -> float:
    """How often a wrong name of one effect, or of several, is right in part: Laplace's rule of succession, (k + 1) / (n + 2), an answer
    counting as far as no free curve explains it."""
    told = [entry.partly(law) for entry in examples]
    wrong = [(touching, share) for is_several, touching, share in filter(None, told) if is_several is several]
    return (sum(share for touching, share in wrong if touching) + 1.0) / (sum(share for _, share in wrong) + 2.0)


def log_loss(law: ComparisonLaw, examples: Sequence[Example]) -> float:
    """Nats an answer: -ln of the probability of what is right in it, or of its being something else."""
    return float(np.mean([-np.log(_right(law, entry)) for entry in examples]))


def _right(law: ComparisonLaw, entry: Example) -> float:
    explained, share = law.explained(entry.told), _share(law, entry)
    return explained * share if share >= LEAST_FOUND else 1.0 - explained


def _share(law: ComparisonLaw, entry: Example) -> float:
    return float(law.shares(entry.told)[:-1][list(entry.right)].sum())


def _with_shares(law: ComparisonLaw, listed: Sequence[Example]) -> ComparisonLaw:
    mean, sd = (np.array(values) for values in zip(*BELIEVED.values(), strict=True))

    def of(numbers: Array) -> ComparisonLaw:
        return replace(law, **dict(zip(BELIEVED, numbers.tolist(), strict=True)))

    columns, right = _listed(listed)
    formed_nats = np.array([[entry.told.formed_nats] for entry in listed])
    misled = np.array([np.mean(entry.right) for entry in listed])

    def loss(numbers: Array) -> float:
        shares = softmax(of(numbers).log_weights(columns, formed_nats), axis=1)
        told = np.log((1.0 - MISLED) * (shares * right).sum(axis=1) + MISLED * misled)
        return float(0.5 * np.sum(((numbers - mean) / sd) ** 2) - told.sum())

    return of(_least(loss, mean))


def _listed(listed: Sequence[Example]) -> tuple[Array, Array]:
    """What each lists, as (4, answers, most), and which of it is right (answers, most); no weight where an answer lists less than most."""
    most = max((entry.told.columns.shape[1] for entry in listed), default=0)
    columns, right = np.zeros((4, len(listed), most)), np.zeros((len(listed), most))
    columns[0] = -np.inf
    for row, entry in enumerate(listed):
        own = entry.told.columns
        columns[:, row, : own.shape[1]] = own
        right[row, : len(entry.right)] = entry.right
    return columns, right


def _least(loss: Callable[[Array], float], start: Array) -> Array:
    return np.asarray(minimize(loss, start, method="Nelder-Mead", options=ENDED).x)


def with_explained(law: ComparisonLaw, examples: Sequence[Example], decay: float) -> ComparisonLaw:
    """The same law with its second half, and how often a wrong first is right in part.

    Weight decay is per standard deviation of a feature, so the fit is defined with few examples and forgets units; a feature that does not
    vary has coefficient 0."""
    smaller = [entry for example in examples for entry in withheld(example)]
    told_of = [*examples, *smaller]
    weight = np.array([1.0] * len(examples) + [WITHHELD] * len(smaller))
    shares = [law.shares(entry.told) for entry in told_of]
    found = np.array([features(entry.told, share) for entry, share in zip(told_of, shares, strict=True)])
    unbiased = replace(law, curve=0.0)
    logit = np.array([unbiased.curve_logit(entry.told, share) for entry, share in zip(told_of, shares, strict=True)])
    right = np.array([_share(law, entry) >= LEAST_FOUND for entry in told_of], float)
    mean = np.average(found, axis=0, weights=weight)
    sd = np.sqrt(np.average((found - mean) ** 2, axis=0, weights=weight))
    varies = sd > UNVARIED_SD
    told = np.column_stack([np.ones(len(right)), (found - mean)[:, varies] / sd[varies]])
    decays = np.array([INTERCEPT_DECAY, *[decay] * int(varies.sum())])

    def of(curve: float) -> tuple[Array, float]:
        return _logistic(told, right, weight, decays, -np.logaddexp(0.0, logit - curve))

    def loss(curve: float) -> float:
        return of(curve)[1] + 0.5 * ((curve - CURVE_BELIEVED[0]) / CURVE_BELIEVED[1]) ** 2

    curve = float(minimize_scalar(loss, bounds=CURVE_BOUNDS, method="bounded", options={"xatol": 1e-6}).x)
    numbers, _ = of(curve)
    coefficients = np.zeros(len(sd))
    coefficients[varies] = numbers[1:] / sd[varies]
    left, favour = coefficients.tolist()
    intercept = float(numbers[0] - coefficients @ mean)
    law = replace(law, intercept=intercept, left=left, curve=curve, favour=favour)
    return replace(law, partly_single=partly(law, examples, False), partly_several=partly(law, examples, True))


def _logistic(told: Array, right: Array, weight: Array, decay: Array, offset: Array) -> tuple[Array, float]:
    """Where weighted log loss plus decay is least, of logits told w + offset, and that least, in nats."""

    def loss(w: Array) -> float:
        z = told @ w + offset
        return float(np.sum(weight * (np.logaddexp(0.0, z) - right * z)) + 0.5 * decay @ w**2)

    def slope(w: Array) -> Array:
        return np.asarray(told.T @ (weight * (expit(told @ w + offset) - right)) + decay * w)

    found = minimize(loss, np.zeros(told.shape[1]), jac=slope, method="BFGS", options={"gtol": SLOPE})
    return np.asarray(found.x), float(found.fun)
