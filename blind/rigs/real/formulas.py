"""The real rigs' own formulas of known effects, as their C has them, over the samples that their flights went through.

All take the amplitude in its field's unit, the shape by field, and the samples; all give one number per sample.
"""

import numpy as np

from blind.effects.ce150_formulas import FULL_RAD_S, LOWER_STOP_RAD, Sized, Term
from blind.effects.effect import Shape
from blind.effects.equivalent import PHASES, Equivalent, Equivalents, fitted, relative
from blind.effects.visited import Array, Visited


def dead_band(i: int) -> Term:
    """Of input i: its edge bends as log(1 + exp(x)); V."""

    def kept(a: float, shape: Shape, visited: Visited) -> Array:
        u, bend = visited.u(i), shape["dead_bend"] * a
        passed = bend * (np.logaddexp(0.0, (np.abs(u) - a) / bend) - np.log1p(np.exp(-1.0 / shape["dead_bend"])))
        return np.asarray(np.sign(u) * np.maximum(passed, 0.0))

    return kept


def soft_limit(i: int) -> Term:
    """Of input i: u / (1 + |u / limit|^p)^(1/p); V."""

    def passed(a: float, shape: Shape, visited: Visited) -> Array:
        u, p = visited.u(i), shape["limit_power"]
        return np.asarray(u * (1.0 + (np.abs(u) / a) ** p) ** (-1.0 / p))

    return passed


def sagging(a: float, shape: Shape, visited: Visited) -> Array:
    """Share of the voltage that a supply lacks: exponential in its load."""
    return np.asarray(1.0 - np.exp(-a * visited.load))


def warming(a: float, shape: Shape, visited: Visited) -> Array:
    """Share of the drive that is lost: two equal masses in a row."""
    x = visited.t_s / shape["warm_s"]
    return np.asarray(a * (1.0 - (1.0 + x) * np.exp(-x)))


def warm_start(a: float, shape: Shape, target: Array) -> list[float]:
    """Both masses' times together."""
    return [a, 2.0 * shape["warm_s"]]


def rounded_dry(i: int) -> Term:
    """Of rotor i: an arc tangent; rad/s^2."""
    return lambda a, shape, visited: np.asarray(a * np.arctan(visited.omega(i) / 2.0) * 2.0 / np.pi)


def tustin(i: int) -> Term:
    """exp(-v / v_s) on axis i (Tustin 1947), instead of the library's bell; N m, N."""
    return lambda a, shape, visited: np.asarray(a * np.exp(-np.abs(visited.rate(i)) / shape["stribeck_rate"]))


def saturating_drag(i: int) -> Term:
    """Of axis i: a square that grows slower at speed; N m, N."""

    def drag(a: float, shape: Shape, visited: Visited) -> Array:
        v = visited.rate(i)
        return np.asarray(a * v * np.abs(v) / (1.0 + np.abs(v) / shape["drag_rate"]))

    return drag


def hard_spring(i: int) -> Term:
    """Of axis i: a hyperbolic sine; N m, N."""

    def torque(a: float, shape: Shape, visited: Visited) -> Array:
        x = visited.angle(i) - shape["spring_zero"]
        return np.asarray(-a * np.sinh(shape["spring_hard"] * x) / shape["spring_hard"])

    return torque


def blunt_push(a: float, shape: Shape, visited: Visited) -> Array:
    """A hand's push, 1 - x^4 over its time; over PHASES."""
    return np.asarray(a * (1.0 - (2.0 * PHASES - 1.0) ** 4))


def near_ground(a: float, shape: Shape, visited: Visited) -> Array:
    """Share of lift gained: a bell of Cauchy over the height above the lower stop."""
    return np.asarray(a / (1.0 + ((visited.psi - LOWER_STOP_RAD) / shape["ground_rad"]) ** 2))


def washed(a: float, shape: Shape, visited: Visited) -> Array:
    """Share of the tail's thrust that the main rotor's air takes: soon at its most."""
    bend = shape["downwash_bend"]
    return np.asarray(a * np.tanh(bend * np.abs(visited.omega_M) / FULL_RAD_S) / np.tanh(bend))


def tail_lift(a: float, shape: Shape, visited: Visited) -> Array:
    """A square of the tail's speed that grows slower at speed; N m."""
    w = visited.omega_T
    return np.asarray(a * w * np.abs(w) / (1.0 + np.abs(w) / 2000.0))


def reversed_command(e: Sized) -> Equivalents:
    """r u for u < 0."""
    return {"r": Equivalent(1.0 - e.a, abs(e.a))}


def quadratic_thrust(e: Sized) -> Equivalents:
    """u (1 + a (|u| / U - 1)) is fitted to u (|u| / U)^a."""
    u, full = e.visited.u(e.index), e.shape["power_V"]
    share = np.abs(u) / full
    target = u * share**e.a - u
    best = fitted(lambda x: x[0] * u * (share - 1.0), target, [e.a])
    return {"a": relative(best[0])}
