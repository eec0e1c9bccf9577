"""Effects on the motion of the two axes, dry friction apart."""

from collections.abc import Callable

import numpy as np
from numpy.random import Generator

from blind.effects.effect import (
    Array,
    Effect,
    Equivalents,
    Settings,
    Shape,
    Visited,
    fitted,
    nearest_rectangle,
    relative,
    scale_of,
    shape_only,
    sign,
)

AXES = ("elevation", "azimuth")
ANGLES = ("psi", "phi")
MODE_RAD_S = 30.0


def axis_effects(axis: int) -> tuple[Effect, ...]:
    """Every library effect that both axes can have."""
    return (_drag(axis), _spring(axis), _spin(axis), _pulse(axis), _flexible(axis))


def _effect(
    axis: int,
    name: str,
    depends: str,
    settings: Callable[[float, Shape], Settings],
    draw: Callable[[Generator], Shape],
    equivalent: Callable[[float, Shape, Visited], Equivalents],
) -> Effect:
    own = f"{depends} on {AXES[axis]}"
    return Effect(f"{AXES[axis]}.{name}", (AXES[axis],), own, settings, draw, equivalent, (0.01, 10.0))


def _drag(axis: int) -> Effect:
    """A power of the rate that is not quite two."""

    def equivalent(m: float, shape: Shape, visited: Visited) -> Equivalents:
        v = visited.rate(axis)
        return {"c": relative(2e-3 * m * scale_of(v * np.abs(v), np.sign(v) * np.abs(v) ** shape["power"]))}

    def settings(m: float, shape: Shape) -> Settings:
        return {("drag", axis): 2e-3 * m, ("drag_power", axis): shape["power"]}

    def draw(rng: Generator) -> Shape:
        return {"power": rng.uniform(1.75, 1.9) if rng.random() < 0.5 else rng.uniform(2.1, 2.3)}

    return _effect(axis, "quadratic_drag", f"torque({ANGLES[axis]}_dot)", settings, draw, equivalent)


def tether(x: Array, k: float, slack: float, growth: float) -> Array:
    """Torque of a tether at x from its rest: slacker on the negative side, harder further out."""
    return np.asarray(-k * np.where(x < 0.0, slack, 1.0) * x * (1.0 + growth * np.abs(x)))


def _spring(axis: int) -> Effect:
    def equivalent(m: float, shape: Shape, visited: Visited) -> Equivalents:
        angle = visited.angle(axis)
        torque = tether(angle - shape["zero_rad"], 3e-3 * m, shape["slack"], shape["growth"])
        k, at_zero = np.polyfit(angle, torque, 1)
        return {"k": relative(-k), "angle_0": shape_only(-at_zero / k, 0.2)}

    def settings(m: float, shape: Shape) -> Settings:
        values = {"spring": 3e-3 * m, **{f"spring_{key}": value for key, value in shape.items()}}
        return {(field, axis): value for field, value in values.items()}

    def draw(rng: Generator) -> Shape:
        slack, growth = rng.uniform(0.6, 1.0), rng.uniform(0.0, 0.3)
        return {"zero_rad": rng.uniform(-0.4, 0.4), "slack": slack, "growth": growth}

    return _effect(axis, "cable_spring", f"torque({ANGLES[axis]})", settings, draw, equivalent)


def _spin(axis: int) -> Effect:
    """The reaction reaches the arm through a mount that gives a little."""
    size = (4e-5, 1.5e-5)[axis]

    def settings(m: float, shape: Shape) -> Settings:
        return {("spin_inertia", axis): size * m * shape["sign"], ("spin_soft_s", axis): shape["soft_s"]}

    def equivalent(m: float, shape: Shape, visited: Visited) -> Equivalents:
        return {"J": relative(size * m * shape["sign"], either_sign=True)}

    def draw(rng: Generator) -> Shape:
        return {"sign": sign(rng) if axis == 0 else 1.0, "soft_s": rng.uniform(0.004, 0.015)}

    return _effect(axis, "rotor_acceleration", f"torque(domega_{'TM'[axis]}/dt)", settings, draw, equivalent)


def _pulse(axis: int) -> Effect:
    """A trapezium, at most a triangle, that starts at t_0 of the log's own time."""

    def equivalent(m: float, shape: Shape, visited: Visited) -> Equivalents:
        height, width = nearest_rectangle(lambda x: np.clip(np.minimum(x, 1.0 - x) / shape["rise"], 0.0, 1.0))
        duration = width * shape["s"]
        begins = visited.start_s + shape["start_s"] + 0.5 * (shape["s"] - duration)
        return {
            "torque": relative(4e-3 * m * shape["sign"] * height),
            "t_0": shape_only(begins, duration),
            "duration": shape_only(duration, duration),
        }

    def settings(m: float, shape: Shape) -> Settings:
        values = {"pulse_Nm": 4e-3 * m * shape["sign"], "pulse_start_s": shape["start_s"]}
        values |= {"pulse_s": shape["s"], "pulse_rise": shape["rise"]}
        return {(field, axis): value for field, value in values.items()}

    def draw(rng: Generator) -> Shape:
        shape = {"sign": sign(rng), "start_s": rng.uniform(5.0, 16.0), "s": rng.uniform(0.4, 3.0)}
        return {**shape, "rise": rng.uniform(0.1, 0.5)}

    return _effect(axis, "disturbance", "torque(t)", settings, draw, equivalent)


def _flexible(axis: int) -> Effect:
    """Two masses: the arm with the rotors, a spring, the hub with bearing and encoder. A larger one is softer.

    What a library calls the mode's gain is its own matter and is not judged.
    """

    def omega(m: float) -> float:
        return float(MODE_RAD_S / np.sqrt(m))

    def settings(m: float, shape: Shape) -> Settings:
        values = {"mass_share": shape["share"], "mass_rad_s": omega(m), "mass_zeta": shape["zeta"], "mass_reads": 1.0}
        return {(field, axis): value for field, value in values.items()}

    return Effect(
        name=f"{AXES[axis]}.flexible_mode",
        places=(AXES[axis],),
        depends=f"mode(torque) of {AXES[axis]}",
        settings=settings,
        draw=lambda rng: {"share": rng.uniform(0.2, 0.7), "zeta": rng.uniform(0.03, 0.1)},
        equivalent=lambda m, shape, visited: {
            "omega_n": relative(omega(m)),
            "zeta": shape_only(shape["zeta"], shape["zeta"]),
        },
        bounds=(0.2, 8.0),
        sensor=True,
    )


def _centre_equivalent(m: float, shape: Shape, visited: Visited) -> Equivalents:
    """The arm droops, so that the angle by which its weight lies aside is largest when it is level."""
    delta = 0.06 * m * shape["sign"]
    target = np.cos(visited.psi + delta * (1.0 + shape["droop"] * np.cos(visited.psi))) - np.cos(visited.psi)
    best = fitted(lambda x: np.cos(visited.psi + x[0]) - np.cos(visited.psi), target, [delta])
    return {"delta": relative(best[0])}


def _shift_equivalent(m: float, shape: Shape, visited: Visited) -> Equivalents:
    """A slide here, a step in the library, at the middle of the slide in the log's own time."""
    return {
        "Delta": relative(0.025 * m * shape["sign"] * visited.gravity_Nm),
        "t_1": shape_only(visited.start_s + shape["time_s"] + 0.5 * shape["slide_s"], 1.0),
    }


def _tail_lift_equivalent(m: float, shape: Shape, visited: Visited) -> Equivalents:
    w = visited.omega_T
    torque = 2e-4 * m * shape["sign"] * np.sign(w) * (np.abs(w) / 100.0) ** shape["power"]
    return {"k": relative(scale_of(w * np.abs(w), torque))}


def _tilt_equivalent(m: float, shape: Shape, visited: Visited) -> Equivalents:
    """The arm's reach shortens with its elevation."""
    lever = np.sin(visited.phi - shape["zero_rad"])
    size = 3e-3 * m * scale_of(lever, np.cos(visited.psi) * lever)
    return {"m": relative(size), "Phi_0": shape_only(shape["zero_rad"], 0.5)}


def _gyro_equivalent(m: float, shape: Shape, visited: Visited) -> Equivalents:
    """The rotor's shaft is not quite square to the arm."""
    turned = visited.psi_dot * visited.omega_M
    canted = turned * np.sin(visited.psi + shape["cant_rad"])
    return {"K": relative(3e-5 * m * scale_of(turned * np.sin(visited.psi), canted))}


ONE_AXIS = (
    Effect(
        name="elevation.centre_of_gravity",
        places=("elevation",),
        depends="torque(psi) on elevation",
        settings=lambda m, s: {("centre_rad", -1): 0.06 * m * s["sign"], ("centre_droop", -1): s["droop"]},
        draw=lambda rng: {"sign": sign(rng), "droop": rng.uniform(0.0, 0.3)},
        equivalent=_centre_equivalent,
    ),
    Effect(
        name="elevation.weight_shift",
        places=("elevation",),
        depends="torque(t) on elevation",
        settings=lambda m, s: {
            ("weight", -1): 0.025 * m * s["sign"],
            ("weight_time_s", -1): s["time_s"],
            ("weight_slide_s", -1): s["slide_s"],
        },
        draw=lambda rng: {"sign": sign(rng), "time_s": rng.uniform(5.0, 16.0), "slide_s": rng.uniform(0.2, 1.0)},
        equivalent=_shift_equivalent,
    ),
    Effect(
        name="elevation.tail_coupling",
        places=("elevation",),
        depends="torque(omega_T) on elevation",
        settings=lambda m, s: {("tail_lift", -1): 2e-4 * m * s["sign"], ("tail_lift_power", -1): s["power"]},
        draw=lambda rng: {"sign": sign(rng), "power": rng.uniform(1.7, 2.3)},
        equivalent=_tail_lift_equivalent,
    ),
    Effect(
        name="azimuth.tilt",
        places=("azimuth",),
        depends="torque(phi) on azimuth",
        settings=lambda m, s: {("tilt_Nm", -1): 3e-3 * m, ("tilt_rad", -1): s["zero_rad"]},
        draw=lambda rng: {"zero_rad": rng.uniform(-np.pi, np.pi)},
        equivalent=_tilt_equivalent,
    ),
    Effect(
        name="azimuth.gyroscopic",
        places=("azimuth",),
        depends="torque(psi_dot, omega_M, psi) on azimuth",
        settings=lambda m, s: {("gyro_azimuth", -1): 3e-5 * m, ("gyro_cant_rad", -1): s["cant_rad"]},
        draw=lambda rng: {"cant_rad": rng.uniform(-0.05, 0.05)},
        equivalent=_gyro_equivalent,
        bounds=(0.01, 10.0),
    ),
)
