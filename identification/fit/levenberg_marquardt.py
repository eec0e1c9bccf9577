"""Levenberg and Marquardt's method for a sum of squares V(x) = r(x)^T r(x): damped normal equations, and how the damping goes.

(1)  (J^T J + mu diag(J^T J)) step = -J^T r,    kept where V(x + step) < V(x); else mu is raised and the step taken anew.

Damping by the diagonal of J^T J makes a step independent of the parameters' units (Marquardt, J. SIAM 11, 1963, p. 431). Who calls
forms (1), as what can be eliminated from it is the caller's; here is the one loop around it.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Protocol, TypeVar

FIRST, LEAST, MOST = (
    1e-3,
    1e-12,
    1e12,
)  # mu at the start; below LEAST and above MOST of the diagonal it acts on no digit of a step


@dataclass(frozen=True)
class DampingSchedule:
    """mu / `fall` after a better point; mu * `rise` after a refused step, and `quicken` times that for each further one in a row."""

    fall: float
    rise: float
    quicken: float


MARQUARDT = DampingSchedule(fall=10.0, rise=10.0, quicken=1.0)  # Marquardt 1963, nu = 10
# Nielsen, Damping parameter in Marquardt's method, IMM-REP-1999-05, (2.4), with its largest fall after every better point.
NIELSEN = DampingSchedule(fall=3.0, rise=2.0, quicken=2.0)


class Costed(Protocol):
    """A point with its V."""

    @property
    def cost(self) -> float:
        """V, infinite where the model fails."""


Point = TypeVar("Point", bound=Costed)


def trials(
    start: Point, moved: Callable[[Point, float], Point | None], schedule: DampingSchedule
) -> Iterator[Point | None]:
    """One trial after the other: the better point that it leads to, or None where its step is refused.

    `moved` gives the point behind the step (1) from a point under mu, or None where that step is too short to count: then all ends, as it
    does with mu above MOST. Who asks for trials ends earlier by asking for no more. Raises what `moved` raises.
    """
    point, mu, rise = start, FIRST, schedule.rise
    while mu < MOST:
        trial = moved(point, mu)
        if trial is None:
            return
        if trial.cost < point.cost:
            point, mu, rise = trial, max(mu / schedule.fall, LEAST), schedule.rise
            yield point
        else:
            mu, rise = mu * rise, rise * schedule.quicken
            yield None
