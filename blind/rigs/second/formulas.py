"""The second rig's own formulas of the contract's effects, as its C has them, over the samples that its flights went through.

All take the amplitude in its field's unit, the shape by field, and the samples; all give one number per sample.
"""

import numpy as np

from blind.effects.ce150_formulas import FULL_RAD_S, LOWER_STOP_RAD, Term
from blind.effects.effect import Shape
from blind.effects.equivalent import PHASES
from blind.effects.visited import Array, Visited


def dead_band(i: int) -> Term:
    """Of input i: a parabola for a knee, the band a little wider for positive voltages than for negative ones; V."""

    def kept(a: float, shape: Shape, visited: Visited) -> Array:
        u, knee = visited.u(i), shape["dead_knee"]
        own = a * (1.0 + shape["dead_skew"] * np.sign(u))
        size = np.abs(u)
        rounded = (size - own * (1.0 - knee)) ** 2 / (4.0 * knee * own)
        beyond = np.where(size <= own * (1.0 - knee), 0.0, rounded)
        return np.asarray(np.where(size >= own * (1.0 + knee), size - own, beyond) * np.sign(u))

    return kept


def soft_limit(i: int) -> Term:
    """Of input i: straight up to (1 - knee) of the limit, then towards it as a tanh; V."""

    def passed(a: float, shape: Shape, visited: Visited) -> Array:
        u = visited.u(i)
        room, size = a * shape["limit_knee"], np.abs(u)
        bent = a - room + room * np.tanh((size - a + room) / room)
        return np.asarray(np.where(size <= a - room, size, bent) * np.sign(u))

    return passed


def inner_resistance(a: float, shape: Shape, visited: Visited) -> Array:
    """Share of the voltage that a source with an inner resistance lacks."""
    return np.asarray(1.0 - 1.0 / (1.0 + a * visited.load))


def two_masses_warm(a: float, shape: Shape, visited: Visited) -> Array:
    """Share of the drive that is lost: a part with the winding, the rest with the case around it."""
    winding, around = (1.0 - np.exp(-visited.t_s / shape[key]) for key in ("warm_fast_s", "warm_slow_s"))
    return np.asarray(a * (shape["warm_share"] * winding + (1.0 - shape["warm_share"]) * around))


def warm_start(a: float, shape: Shape, target: Array) -> list[float]:
    """The mean of the two times."""
    share = shape["warm_share"]
    return [a, share * shape["warm_fast_s"] + (1.0 - share) * shape["warm_slow_s"]]


def break_away(i: int) -> Term:
    """Dry friction of rotor i: rounded at rest, 1.4 times as much at break-away as at speed; rad/s^2."""

    def braking(a: float, shape: Shape, visited: Visited) -> Array:
        omega = visited.omega(i)
        return np.asarray(a * np.tanh(omega / shape["dry_round_rad_s"]) * (1.0 + 0.4 / (1.0 + (omega / 25.0) ** 2)))

    return braking


def cheeseman(a: float, shape: Shape, visited: Visited) -> Array:
    """Share of lift gained: 1 / (1 - (R / 4 h)^2) - 1 over the height of the arm, Cheeseman and Bennett 1955; `a` at the lower stop."""
    height = 1.0 + shape["ground_reach"] * (np.sin(visited.psi) + np.sin(-LOWER_STOP_RAD))
    return np.asarray(1.0 / (1.0 - a / (1.0 + a) / height**2) - 1.0)


def established(a: float, shape: Shape, visited: Visited) -> Array:
    """Share of a loss that is there once the reversed flow stands."""
    w = visited.omega_T
    return np.asarray(a * (w**2 / (w**2 + shape["reverse_rad_s"] ** 2)))


def washed_away(a: float, shape: Shape, visited: Visited) -> Array:
    """Share of the tail's thrust that the main rotor's air takes."""
    return np.asarray(1.0 - np.exp(-a * np.abs(visited.omega_M / FULL_RAD_S) ** shape["downwash_power"]))


def hyperbola(i: int) -> Term:
    """1 / (1 + (v / v_s)^2) on axis i, instead of the library's bell; N m."""

    def level(a: float, shape: Shape, visited: Visited) -> Array:
        return np.asarray(a / (1.0 + (np.abs(visited.rate(i)) / shape["stribeck_rad_s"]) ** 2))

    return level


def other_power(i: int) -> Term:
    """A power of the rate of axis i that is not quite two; N m."""

    def drag(a: float, shape: Shape, visited: Visited) -> Array:
        v = visited.rate(i)
        return np.asarray(a * np.sign(v) * np.abs(v) ** shape["drag_power"])

    return drag


def tether(i: int) -> Term:
    """Of axis i: slacker on the negative side, harder further out; N m."""

    def torque(a: float, shape: Shape, visited: Visited) -> Array:
        x = visited.angle(i) - shape["spring_zero_rad"]
        slack = np.where(x < 0.0, shape["spring_slack"], 1.0)
        return np.asarray(-a * slack * x * (1.0 + shape["spring_growth"] * np.abs(x)))

    return torque


def trapezium(a: float, shape: Shape, visited: Visited) -> Array:
    """A push that rises in a straight line, stays, falls; at most a triangle; over PHASES."""
    return np.asarray(a * np.clip(np.minimum(PHASES, 1.0 - PHASES) / shape["pulse_rise"], 0.0, 1.0))


def droop(a: float, shape: Shape, visited: Visited) -> Array:
    """The arm droops, so that the angle by which its weight lies aside is largest when it is level."""
    psi = visited.psi
    return np.asarray(np.cos(psi + a * (1.0 + shape["centre_droop"] * np.cos(psi))) - np.cos(psi))


def tail_lift(a: float, shape: Shape, visited: Visited) -> Array:
    """A power of the tail's speed; N m."""
    w = visited.omega_T
    return np.asarray(a * np.sign(w) * (np.abs(w) / 100.0) ** shape["tail_lift_power"])


def reach(a: float, shape: Shape, visited: Visited) -> Array:
    """The arm's reach shortens with its elevation."""
    return np.asarray(a * np.cos(visited.psi))


def canted(a: float, shape: Shape, visited: Visited) -> Array:
    """The rotor's shaft is not quite square to the arm."""
    return np.asarray(a * np.sin(visited.psi + shape["gyro_cant_rad"]))


def off_centre(a: float, shape: Shape, visited: Visited) -> Array:
    """A disc that sits aside and not quite centred: the offset differs a little with the angle; rad."""
    return np.asarray(a * (1.0 + shape["offset_swing"] * np.sin(visited.psi)))


def bent_scale(i: int) -> Term:
    """Of encoder i: a scale that is wrong by a little more further out; rad."""

    def added(a: float, shape: Shape, visited: Visited) -> Array:
        x = visited.angle(i)
        return np.asarray(a * (x * (1.0 + shape["scale_bend"] * np.abs(x))))

    return added
