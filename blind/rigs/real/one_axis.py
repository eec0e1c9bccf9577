"""Who flies the plants with one axis: a PID or a PD, or commands made beforehand."""

from dataclasses import replace

import numpy as np
from numpy.random import Generator

from blind.rigs.real.manoeuvre import OPEN, drawn
from blind.rigs.real.orders import Array, Asked, Orders, alone, at_rest, free
from blind.simulation.ce150 import Rig

# Angle, integral and rate gains in V/rad, V/(rad s), V s/rad.
AEROSHIELD_GAINS = np.array([2.5, 8.0, 0.25])
DRONE_RAD_S = 8.0  # of its closed loop, which 20 ms of delay leave stable
PUSHED_S = 0.3  # of a shaft that turns freely: it goes far


def _sine_of_rest(rig: Rig, u_V: Array | float) -> Array:
    """sin(angle) at which an AeroShield rests."""
    return np.asarray(rig.value("K") * u_V / (rig.value("m") * rig.value("g")))


def aeroshield_open(rig: Rig, asked: Asked, rng: Generator) -> Orders:
    """About a third of what lifts the arm level."""
    level_V = rig.value("m") * rig.value("g") / rig.value("K")
    middle, size = level_V * rng.uniform(0.3, 0.45), level_V * rng.uniform(0.15, 0.3)
    u = np.clip(middle + size * asked.wishes[:, 0], 0.0, rig.value("u_max"))
    angle = float(np.arcsin(np.clip(_sine_of_rest(rig, u[0]), 0.0, 0.95)))
    return free(alone(u), at_rest(angle))


def aeroshield_closed(rig: Rig, asked: Asked, rng: Generator) -> Orders:
    angle = rng.uniform(0.35, 0.5) + 0.3 * asked.smooth(0, float(rng.uniform(0.05, 0.2)))
    level_V = rig.value("m") * rig.value("g") / rig.value("K")
    base = level_V * np.sin(angle)
    gain = np.array([AEROSHIELD_GAINS * rng.uniform(0.6, 1.2, 3), np.zeros(3)])
    start = at_rest(angle[0])
    return Orders(gain, 0.03, alone(angle), alone(base), start)


def emps_open(rig: Rig, asked: Asked, rng: Generator) -> Orders:
    u = rng.uniform(1.0, 2.5) * asked.washed(0)
    return free(alone(u), at_rest(0.0))


def emps_closed(rig: Rig, asked: Asked, rng: Generator) -> Orders:
    """A PD of a bandwidth that its rows allow."""
    q = 0.1 * asked.smooth(0, float(rng.uniform(0.15, 0.35)))
    bandwidth = min(30.0, 0.2 / asked.period_s) * rng.uniform(0.6, 1.0)
    stiff = rig.value("M") * bandwidth**2 / rig.value("gtau")
    gain = np.array([[stiff, 0.0, 1.6 * stiff / bandwidth], [0.0, 0.0, 0.0]])
    reference = alone(q)
    return Orders(gain, 2.0 * asked.period_s, reference, np.zeros_like(reference), at_rest(q[0]))


def _thrust_at(rig: Rig, theta: Array) -> Array:
    """Command that holds an ANT-X drone at an angle."""
    return np.asarray(rig.value("omega_n") ** 2 / rig.value("mu") * theta)


def antx_open(rig: Rig, asked: Asked, rng: Generator) -> Orders:
    """Doublets: what they leave the pitch swings out."""
    base_V = alone(rng.uniform(0.05, 0.15) * asked.doublets(0))
    return free(base_V, at_rest(0.0, base_V[0, 0]))


def antx_closed(rig: Rig, asked: Asked, rng: Generator) -> Orders:
    """A PID by pole placement on the pitch without its delay; what holds the angle is fed forward, and doublets are put in."""
    theta = rng.uniform(0.6, 1.0) * 0.45 * asked.smooth(0, float(rng.uniform(0.04, 0.12)))
    stiff = DRONE_RAD_S * rng.uniform(0.8, 1.1)
    angle = (stiff**2 - rig.value("omega_n") ** 2) / rig.value("mu")
    gain = np.array([[angle, 0.8 * angle, 1.4 * stiff / rig.value("mu")], [0.0, 0.0, 0.0]])
    pushes = replace(asked, wishes=alone(drawn(OPEN, rng, asked.t_s)))
    base_V = alone(_thrust_at(rig, theta) + rng.uniform(0.02, 0.1) * pushes.doublets(0))
    return Orders(gain, 0.01, alone(theta), base_V, at_rest(theta[0], base_V[0, 0]))


def motor_open(rig: Rig, asked: Asked, rng: Generator) -> Orders:
    base_V = alone(rng.uniform(2.0, 6.0) * asked.washed(0, PUSHED_S))
    return free(base_V, at_rest(0.0, base_V[0, 0] / rig.value("R")))


def motor_closed(rig: Rig, asked: Asked, rng: Generator) -> Orders:
    """A PI of a bandwidth that its rows allow."""
    theta = rng.uniform(8.0, 20.0) * asked.smooth(0, float(rng.uniform(0.05, 0.15)))
    stiff = rig.value("K") * min(30.0, 0.2 / asked.period_s) * rng.uniform(0.6, 1.0)
    gain = np.array([[stiff, stiff * rng.uniform(0.0, 1.0), 0.0], [0.0, 0.0, 0.0]])
    reference = alone(theta)
    return Orders(gain, 2.0 * asked.period_s, reference, np.zeros_like(reference), at_rest(theta[0]))
