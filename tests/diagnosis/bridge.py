"""The marginal likelihood by bridge sampling, from draws of the posterior and of Laplace's normal: what Laplace's method is held against.

(1)  Z = E_q[p(x) h(x)] / E_post[q(x) h(x)],   h = 1 / (s_post p(x) / Z + s_q q(x))

(Meng and Wong, Statistica Sinica 6, 1996, eq (4.1)): p the likelihood times the prior, q a normal, s the shares of draws of each. Posterior
draws are a Metropolis chain's that q proposes (Tierney, Annals of Statistics 22, 1994, section 2.3.3).
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.special import logsumexp

from diagnosis import decisions
from diagnosis.fit.free_numbers import from_zero
from diagnosis.fit.known_before import log_prior
from diagnosis.fit.likelihood import likelihood_of
from diagnosis.fit.linear_problem import Fit
from diagnosis.hypothesis.case import Case
from jobs.thread_map import thread_map

Array = NDArray[np.float64]
ROUNDS = 200
WIDER = 1.05  # is q than Laplace's normal, so that tails of the posterior seldom lie beyond it; of 25 numbers more leaves few draws


def log_marginal_likelihood(case: Case, found: Fit, draws: int, seed: int) -> tuple[float, float]:
    """ln Z of the logs by `draws` of theta and of the effects' sizes, noise and shapes held, and its standard error in nats."""
    rng = np.random.default_rng(seed)
    count = len(found.hypothesis.theta)
    moved = np.array([row for row in range(len(found.information)) if row < count or _is_size(found, row)])
    root = WIDER * np.linalg.inv(np.linalg.cholesky(found.information[np.ix_(moved, moved)])).T
    z = rng.standard_normal((2 * draws, len(moved)))
    log_p = np.array(thread_map(lambda at: _log_density(case, found, moved, root @ at), list(z)))
    log_q = -0.5 * np.sum(z**2, axis=1) - 0.5 * len(moved) * np.log(2.0 * np.pi) - np.linalg.slogdet(root)[1]
    ratio = log_p - log_q
    chain = _chain(ratio[:draws], rng)
    post, own = ratio[chain], ratio[draws:]
    parts = [_bridged(part, own) for part in np.array_split(post, 10)]
    return _bridged(post, own) + _prior_volume(found, moved), float(np.std(parts) / np.sqrt(len(parts)))


def _is_size(found: Fit, row: int) -> bool:
    return from_zero(found.free[row - len(found.hypothesis.theta)].parameter)


def _prior_volume(found: Fit, moved: Array) -> float:
    """ln of what makes the prior of theta and sizes one of area 1."""
    sizes = len(moved) - len(found.hypothesis.theta)
    return -0.5 * len(moved) * float(np.log(2.0 * np.pi)) - sizes * float(np.log(decisions.SIZE_SD))


def _log_density(case: Case, found: Fit, moved: Array, step: Array) -> float:
    """The log of likelihood and prior a step away from the fit; -inf beyond an effect's bounds."""
    count, hypothesis = len(found.hypothesis.theta), found.hypothesis
    hypothesis = replace(hypothesis, theta=hypothesis.theta + step[:count])
    for row, change in zip(moved[count:].tolist(), step[count:].tolist(), strict=True):
        entry = found.free[row - count]
        value = entry.of(hypothesis) + change * entry.scale
        if not entry.parameter.lower <= value <= entry.parameter.upper:
            return -np.inf
        hypothesis = hypothesis.with_value(entry.effect, entry.parameter.symbol, value, entry.log)
    return likelihood_of(case, hypothesis) + log_prior(case, hypothesis, found.free)


def _chain(ratio: Array, rng: np.random.Generator) -> NDArray[np.int64]:
    """Where an independence chain is, draw by draw."""
    at, found = int(np.argmax(np.isfinite(ratio))), np.empty(len(ratio), dtype=np.int64)
    for draw, chance in enumerate(np.log(rng.uniform(size=len(ratio))).tolist()):
        at = draw if chance < ratio[draw] - ratio[at] else at
        found[draw] = at
    return found


def _bridged(post: Array, own: Array) -> float:
    """ln Z from ln(p / q) of draws of the posterior and of q, the fixed point of (1)."""
    share = np.log([len(post), len(own)]) - np.log(len(post) + len(own))
    log_z = float(np.median(post))
    for _ in range(ROUNDS):
        over = logsumexp(own - np.logaddexp(share[0] + own - log_z, share[1])) - np.log(len(own))
        under = logsumexp(-np.logaddexp(share[0] + post - log_z, share[1])) - np.log(len(post))
        before, log_z = log_z, float(over - under)
        if abs(log_z - before) < 1e-6:
            break
    return log_z
