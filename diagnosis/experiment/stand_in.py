"""A law that stands in for the rig's own controller where a flight is only imagined: linear-quadratic, with an integral of each error.

    u_k = u_0 - K (x_k - x_r,k) - K_i z_k,   z_(k+1) = z_k + h (y_k - r_k)

K, K_i minimise the sum of (y / s_y)^2 + (z / (s_y T_i))^2 + ((u - u_0) / s_u)^2 about one rest point, for the linearised plant
sampled with h. Slopes by the inputs are taken over s_u to both sides: a thrust that grows with the square has none at rest. The law is
given the true state, so it says what a rig can do, not what its controller will.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from records.errors import BadInput
from sim.bind import BoundPlant
from sim.equilibrium import OperatingPoint, equilibrium
from sim.kernel.reference import Reference, reference
from sim.model import Axis, Model

Array = NDArray[np.float64]
INTEGRAL_S = 1.0  # T_i
INPUT_SHARE = 0.2  # s_u, of the inputs' range
SMALL_WEIGHT = 1e-9  # weight of every other state, in squares of its own size
ANTI_WINDUP_S = 1.0  # of error that z may hold, in s_y


@dataclass(frozen=True, eq=False)
class StandIn:
    """Gains about a rest point: `K` (inputs, states), `K_i` (inputs, tracked); `tracked` are the states that follow references."""

    rest: OperatingPoint
    K: Array
    K_i: Array
    tracked: tuple[int, ...]
    size: Array
    low: Array
    high: Array
    period_s: float

    def command(self, x: Array, z: Array, r: Array) -> tuple[Array, Array]:
        """Inputs (inputs,) within their limits for the own states x, and the next z, for references r (tracked,)."""
        error = x - self.rest.x0
        places = list(self.tracked)
        error[places] = x[places] - r
        most = ANTI_WINDUP_S * self.size
        u = self.within(self.rest.u0 - self.K @ error - self.K_i @ z)
        return u, np.minimum(np.maximum(z + self.period_s * error[places], -most), most)

    def within(self, u: Array) -> Array:
        """The inputs (inputs,) that limits leave of `u`. NumPy's own clip takes five times as long for so few."""
        return np.asarray(np.minimum(np.maximum(u, self.low), self.high))


def steered(model: Model) -> tuple[Axis, ...]:
    """The axes that can be asked to follow a reference: those whose position is read."""
    read = {name for name, place in model.places.axes.items() if place.angle in model.outputs}
    return tuple(axis for axis in model.axes if axis.position is not None and axis.name in read)


def stand_in(
    bound: BoundPlant, at: dict[str, float], size: Array, period_s: float, locked: tuple[str, ...] = ()
) -> StandIn | None:
    """The law about the rest point with the axes at `at` (by name); None where no law holds the plant there.

    `size` (steered axes,) is s_y of each. Axes that are `locked` stand still and follow nothing.
    """
    model = bound.model
    arms = [axis for axis in model.axes if axis.position is not None]
    try:
        rest = equilibrium(bound, *(at.get(axis.name, 0.0) for axis in arms))
    except BadInput:
        return None
    free = [(axis, s) for axis, s in zip(steered(model), size.tolist(), strict=True) if axis.name not in locked]
    held = {symbol for axis in arms if axis.name in locked for symbol in (axis.position, axis.velocity)}
    kept = [place for place, state in enumerate(model.states) if state not in held]
    tracked = [model.states.index(axis.position) for axis, _ in free]
    if not free or len(tracked) > len(model.inputs):
        return None
    limits = np.array([bound.commands(variable) for variable in model.inputs])
    own = np.array([s for _, s in free])
    inputs, rows = INPUT_SHARE * np.ptp(limits, axis=1), [kept.index(place) for place in tracked]
    F, G = _sampled(bound, rest, kept, rows, inputs, period_s)
    gains = _gains(F, G, _weights(rest.x0[kept], rows, own), np.diag(1.0 / inputs**2))
    if gains is None:
        return None
    K = np.zeros((len(model.inputs), len(model.states)))
    K[:, kept] = gains[:, : len(kept)]
    return StandIn(rest, K, gains[:, len(kept) :], tuple(tracked), own, limits[:, 0], limits[:, 1], period_s)


def _slopes(equations: Reference, at: tuple[float, Array, Array, Array, Array], reach: Array) -> Array:
    """Slopes (states, inputs) of the rates over `reach` to both sides of each input."""
    t_s, x, u, p, signs = at
    sides = [[equations.rates(t_s, x, u + side * step, p, signs) for side in (1.0, -1.0)] for step in np.diag(reach)]
    return np.stack([(up - down) / (2.0 * r) for (up, down), r in zip(sides, reach.tolist(), strict=True)], axis=1)


def _sampled(
    bound: BoundPlant, rest: OperatingPoint, kept: list[int], rows: list[int], inputs: Array, period_s: float
) -> tuple[Array, Array]:
    """F (n + k, n + k) and G (n + k, inputs) of a sample: of the n states that are `kept`, and of the integrals of k `rows` of them."""
    from scipy.linalg import expm  # half a second with the next, which whoever needs no stand-in is spared

    equations, signs = reference(bound.model), np.zeros(len(bound.model.axes))
    at = (0.0, rest.x0, rest.u0, bound.p, signs)
    A, B = equations.A(*at)[np.ix_(kept, kept)], _slopes(equations, at, inputs)[kept]
    n, m, k = len(kept), B.shape[1], len(rows)
    whole = np.zeros((n + k + m, n + k + m))
    whole[:n, :n], whole[:n, n + k :] = A, B
    whole[np.arange(n, n + k), rows] = 1.0
    sampled = expm(period_s * whole)
    return sampled[: n + k, : n + k], sampled[: n + k, n + k :]


def _gains(F: Array, G: Array, Q: Array, R: Array) -> Array | None:
    """The linear-quadratic law of a sampled plant; None where there is none, or none that is stable."""
    from scipy.linalg import solve_discrete_are

    try:
        P = solve_discrete_are(F, G, Q, R)
    except (np.linalg.LinAlgError, ValueError):
        return None
    gains = np.linalg.solve(R + G.T @ P @ G, G.T @ P @ F)
    stable = np.abs(np.linalg.eigvals(F - G @ gains)).max() < 1.0
    return np.asarray(gains) if stable else None


def _weights(about: Array, rows: list[int], size: Array) -> Array:
    """Q of states that rest at `about` and of the integrals of those in `rows`, which follow to `size`."""
    scale = 1.0 + np.abs(about)
    Q = np.diag(np.concatenate([SMALL_WEIGHT / scale**2, 1.0 / (size * INTEGRAL_S) ** 2]))
    Q[rows, rows] += 1.0 / size**2
    return Q
