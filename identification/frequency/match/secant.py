"""The secant search of seed 002, section 4.1, for several unknowns, restarted from other first approximations.

Where one unknown has the secant through F(u_1) and F(u_2), n unknowns have the affine function through n + 1 evaluations of F,

    (1)  F(theta + s) ~ F(theta) + S s,      S s_k = F_k - F for each of them,

and each later evaluation turns S so that it goes through the newest two (Broyden's update),

    (2)  S <- S + (F(theta + s) - F(theta) - S s) s^T / (s^T s)

in units of the parameters' sizes. The next approximation minimises |F + S s|^2 + mu |s|^2; mu grows while no better one is found. A search
that stalls is set up anew through n + 1 points about its best one, and ends when that does not help either. No derivative is asked for.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Residual = Callable[[Array], Array | None]
FIRST_STEP, LATER_STEP = 0.05, 1e-4  # of a parameter's size, for the first n + 1 points and for later ones
MOST_STEPS = 200
LEAST_GAIN = 1e-7  # relative gain of J by a new set of points that is none
# Relative gain of J over as many steps as new points would cost, below which secants are turned no further.
STALE = 1e-3
MU_MOST = 1e8
SAME_DIGITS = 7  # of J, as far as a settled search brings it: LEAST_GAIN


@dataclass(frozen=True, eq=False)
class Found:
    """Where one search began, the best theta that it came to, its J, how often F was evaluated, and whether the search settled."""

    start: Array
    theta: Array
    J: float
    evaluations: int
    settled: bool


def secant_search(residual: Residual, start: Array, size: Array) -> Found | None:
    """Minimise J = |F|^2 from `start`; None where F does not exist there. `residual` gives F (m,), or None where there is none."""
    F = residual(start)
    if F is None:
        return None
    best = Found(np.array(start), np.array(start), float(F @ F), 1, False)
    step, stalls = FIRST_STEP, 0
    for _ in range(MOST_STEPS):
        S, spent = _through_points(residual, best.theta, F, size, step)
        after, F = _descend(residual, best, F, S, size)
        gain = best.J - after.J
        best = Found(best.start, after.theta, after.J, after.evaluations + spent, False)
        stalls = stalls + 1 if gain <= LEAST_GAIN * best.J else 0
        step = max(LATER_STEP, step / 10.0)
        if stalls and step == LATER_STEP:
            return Found(best.start, best.theta, best.J, best.evaluations, True)
    return best


def restarted(residual: Residual, starts: Iterable[Array], size: Array) -> tuple[Found, ...]:
    """The search from each of `starts`, best first, of those with the same J the one that began first; those from which it cannot begin
    are left out.
    """
    found = [entry for start in starts if (entry := secant_search(residual, start, size)) is not None]
    return tuple(sorted(found, key=lambda entry: float(f"{entry.J:.{SAME_DIGITS}g}")))


def _through_points(residual: Residual, theta: Array, F: Array, size: Array, step: float) -> tuple[Array, int]:
    """S of (1) through theta and n points, each with one parameter moved; a point that does not exist is taken on the other side."""
    S, spent = np.zeros((F.size, theta.size)), 0
    for place in range(theta.size):
        for way in (step, -step):
            point = theta.copy()
            point[place] += way * size[place]
            other, spent = residual(point), spent + 1
            if other is not None:
                S[:, place] = (other - F) / way
                break
    return S, spent


def _descend(residual: Residual, best: Found, F: Array, S: Array, size: Array) -> tuple[Found, Array]:
    """Steps by (1) and (2) until mu is out of range, or 2 n + 8 of them have gained little: then new points serve better."""
    theta, J, mu = best.theta, best.J, 1e-3
    patience, spent, J_before = 2 * theta.size + 8, 0, np.inf
    while mu < MU_MOST:
        if spent % patience == 0:
            if J_before - J <= STALE * J:
                break
            J_before = J
        s = np.linalg.solve(S.T @ S + mu * np.diag(np.diag(S.T @ S) + 1e-12), -S.T @ F)
        other, spent = residual(theta + s * size), spent + 1
        if other is None:
            mu *= 10.0
            continue
        S = S + np.outer(other - F - S @ s, s) / max(float(s @ s), 1e-300)
        J_other = float(other @ other)
        if J_other >= J:
            mu *= 5.0
            continue
        small = J - J_other < 1e-10 * J
        theta, F, J, mu = theta + s * size, other, J_other, max(mu / 5.0, 1e-10)
        if small:
            break
    return Found(best.start, theta, J, best.evaluations + spent, False), F
