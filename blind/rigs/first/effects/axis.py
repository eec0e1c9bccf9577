"""Effects on the two axes."""

from collections.abc import Callable

import numpy as np
from numpy.random import Generator

from blind.effects.effect import (
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
COULOMB = (2.0e-4, 3.0e-4)


def axis_effects(axis: int) -> tuple[Effect, ...]:
    """Every library effect that both axes can have."""
    return (_coulomb(axis), _stribeck(axis), _drag(axis), _spring(axis), _spin(axis), _pulse(axis), _flexible(axis))


def _effect(
    axis: int,
    name: str,
    depends: str,
    settings: Callable[[float, Shape], Settings],
    draw: Callable[[Generator], Shape],
    equivalent: Callable[[float, Shape, Visited], Equivalents],
    bounds: tuple[float, float] = (0.003, 10.0),
) -> Effect:
    return Effect(
        f"{AXES[axis]}.{name}", (AXES[axis],), f"{depends} on {AXES[axis]}", settings, draw, equivalent, bounds
    )


def _coulomb(axis: int) -> Effect:
    """The plant file states no dry friction; the rig has bristles."""
    return Effect(
        name=f"{AXES[axis]}.coulomb",
        places=(AXES[axis],),
        depends=f"torque(sgn {ANGLES[axis]}_dot) on {AXES[axis]}",
        settings=lambda m, shape: {},
        equivalent=lambda m, shape, visited: {"b": relative(COULOMB[axis] * m)},
        absent=(("b_cE", "b_cA")[axis],),
        coulomb={axis: COULOMB[axis]},
    )


def _stribeck(axis: int) -> Effect:
    """exp(-|v|/v_s) here, a Gaussian in the library."""

    def equivalent(m: float, shape: Shape, visited: Visited) -> Equivalents:
        v = np.abs(visited.rate(axis))
        size, speed = 4e-4 * m, shape["speed_rad_s"]
        b_s, v_s = fitted(lambda x: x[0] * np.exp(-((v / x[1]) ** 2)), size * np.exp(-v / speed), [size, speed])
        return {"b_s": relative(b_s), "v_s": shape_only(abs(v_s), abs(v_s))}

    def settings(m: float, shape: Shape) -> Settings:
        return {("stribeck_Nm", axis): 4e-4 * m, ("stribeck_rad_s", axis): shape["speed_rad_s"]}

    def draw(rng: Generator) -> Shape:
        return {"speed_rad_s": rng.uniform(0.03, 0.15)}

    return _effect(axis, "stribeck", f"torque({ANGLES[axis]}_dot)", settings, draw, equivalent)


def _drag(axis: int) -> Effect:
    """v sqrt(v^2 + v0^2) here (laminar below v0), |v| v in the library."""
    size = (1.5e-3, 1.5e-3)[axis]

    def equivalent(m: float, shape: Shape, visited: Visited) -> Equivalents:
        v = visited.rate(axis)
        return {"c": relative(size * m * scale_of(v * np.abs(v), v * np.hypot(v, shape["floor"])))}

    def draw(rng: Generator) -> Shape:
        return {"floor": rng.uniform(0.02, 0.1)}

    def settings(m: float, shape: Shape) -> Settings:
        return {("drag", axis): size * m, ("drag_floor_rad_s", axis): shape["floor"]}

    return _effect(axis, "quadratic_drag", f"torque({ANGLES[axis]}_dot)", settings, draw, equivalent)


def _spring(axis: int) -> Effect:
    """A tether that stiffens here, a straight spring in the library."""

    def equivalent(m: float, shape: Shape, visited: Visited) -> Equivalents:
        x = visited.angle(axis) - shape["zero_rad"]
        torque = -2e-3 * m * x * (1.0 + shape["hardening"] * x * x)
        k, k_zero = np.polyfit(visited.angle(axis), torque, 1)
        return {"k": relative(-k), "angle_0": shape_only(-k_zero / k, 0.2)}

    def settings(m: float, shape: Shape) -> Settings:
        fields = {"spring": 2e-3 * m, "spring_zero_rad": shape["zero_rad"], "hardening": shape["hardening"]}
        return {(field, axis): value for field, value in fields.items()}

    def draw(rng: Generator) -> Shape:
        return {"zero_rad": rng.uniform(-0.4, 0.4), "hardening": rng.uniform(0.0, 0.4)}

    return _effect(axis, "cable_spring", f"torque({ANGLES[axis]})", settings, draw, equivalent)


def _spin(axis: int) -> Effect:
    """What speeds a rotor up turns the body the other way."""
    size = (2e-5, 1e-5)[axis]

    def draw(rng: Generator) -> Shape:
        return {"sign": sign(rng) if axis == 0 else 1.0}

    def settings(m: float, shape: Shape) -> Settings:
        return {("spin_inertia", axis): size * m * shape["sign"]}

    def equivalent(m: float, shape: Shape, visited: Visited) -> Equivalents:
        return {"J": relative(size * m * shape["sign"], either_sign=True)}

    return _effect(axis, "rotor_acceleration", f"torque(domega_{'TM'[axis]}/dt)", settings, draw, equivalent)


def _pulse(axis: int) -> Effect:
    """A push that swells and fades here, a rectangle in the library: the rectangle of the same middle that fits best."""

    def equivalent(m: float, shape: Shape, visited: Visited) -> Equivalents:
        height, width = nearest_rectangle(lambda phase: np.sqrt(np.sin(np.pi * phase)))
        duration = width * shape["long_s"]
        return {
            "torque": relative(3e-3 * m * shape["sign"] * height),
            "t_0": shape_only(shape["start_s"] + 0.5 * (shape["long_s"] - duration), duration),
            "duration": shape_only(duration, duration),
        }

    def settings(m: float, shape: Shape) -> Settings:
        fields = {"pulse_Nm": 3e-3 * m * shape["sign"], "pulse_start_s": shape["start_s"], "pulse_s": shape["long_s"]}
        return {(field, axis): value for field, value in fields.items()}

    def draw(rng: Generator) -> Shape:
        return {"sign": sign(rng), "start_s": rng.uniform(6.0, 18.0), "long_s": rng.uniform(0.5, 3.0)}

    return _effect(axis, "disturbance", "torque(t)", settings, draw, equivalent)


def _flexible(axis: int) -> Effect:
    """The encoder sits behind a light spring; the library's gain may be defined otherwise and is not judged."""

    def settings(m: float, shape: Shape) -> Settings:
        fields = {"flex": 0.3 * m, "flex_rad_s": shape["omega_n"], "flex_zeta": shape["zeta"]}
        return {(field, axis): value for field, value in fields.items()}

    def equivalent(m: float, shape: Shape, visited: Visited) -> Equivalents:
        return {"omega_n": relative(shape["omega_n"]), "zeta": shape_only(shape["zeta"], shape["zeta"])}

    def draw(rng: Generator) -> Shape:
        return {"omega_n": rng.uniform(15.0, 45.0), "zeta": rng.uniform(0.03, 0.1)}

    return Effect(
        name=f"{AXES[axis]}.flexible_mode",
        places=(AXES[axis],),
        depends=f"mode(torque) of {AXES[axis]}",
        settings=settings,
        draw=draw,
        equivalent=equivalent,
        bounds=(0.05, 3.5),
        sensor=True,
    )


def _centre_equivalent(m: float, shape: Shape, visited: Visited) -> Equivalents:
    """tau sin(delta) sin(Psi) beside an unchanged cosine here; the library turns the whole gravity torque by delta."""
    return {"delta": relative(np.arcsin(0.05 * m * shape["sign"]))}


def _shift_equivalent(m: float, shape: Shape, visited: Visited) -> Equivalents:
    """A ramp here, a step in the library."""
    return {
        "Delta": relative(0.02 * m * shape["sign"] * visited.gravity_Nm),
        "t_1": shape_only(shape["time_s"] + 0.5 * shape["ramp_s"], 1.0),
    }


def _coupling_equivalent(m: float, shape: Shape, visited: Visited) -> Equivalents:
    """A share of the true tail thrust here, omega |omega| in the library."""
    w = visited.omega_T
    k = scale_of(w * np.abs(w), 0.01 * m * shape["sign"] * visited.tail_thrust(w))
    return {"k": relative(k)}


ONE_AXIS = (
    Effect(
        name="elevation.centre_of_gravity",
        places=("elevation",),
        depends="torque(psi) on elevation",
        settings=lambda m, shape: {("centre_Nm", -1): 0.0383 * 0.05 * m * shape["sign"]},
        draw=lambda rng: {"sign": sign(rng)},
        equivalent=_centre_equivalent,
    ),
    Effect(
        name="elevation.weight_shift",
        places=("elevation",),
        depends="torque(t) on elevation",
        settings=lambda m, shape: {
            ("weight", -1): 0.02 * m * shape["sign"],
            ("weight_time_s", -1): shape["time_s"],
            ("weight_ramp_s", -1): shape["ramp_s"],
        },
        draw=lambda rng: {"sign": sign(rng), "time_s": rng.uniform(6.0, 18.0), "ramp_s": rng.uniform(0.05, 0.3)},
        equivalent=_shift_equivalent,
    ),
    Effect(
        name="elevation.tail_coupling",
        places=("elevation",),
        depends="torque(omega_T) on elevation",
        settings=lambda m, shape: {("tail_to_elevation_m", -1): 0.01 * m * shape["sign"]},
        draw=lambda rng: {"sign": sign(rng)},
        equivalent=_coupling_equivalent,
    ),
    Effect(
        name="azimuth.tilt",
        places=("azimuth",),
        depends="torque(phi) on azimuth",
        settings=lambda m, shape: {("tilt_Nm", -1): 2e-3 * m, ("tilt_rad", -1): shape["zero_rad"]},
        draw=lambda rng: {"zero_rad": rng.uniform(-np.pi, np.pi)},
        equivalent=lambda m, shape, visited: {"m": relative(2e-3 * m), "Phi_0": shape_only(shape["zero_rad"], 0.5)},
    ),
    Effect(
        name="azimuth.gyroscopic",
        places=("azimuth",),
        depends="torque(psi_dot, omega_M, psi) on azimuth",
        settings=lambda m, shape: {("gyro_azimuth", -1): 2e-5 * m},
        equivalent=lambda m, shape, visited: {"K": relative(2e-5 * m)},
        bounds=(0.01, 20.0),
    ),
    Effect(
        name="azimuth.friction_asymmetry",
        places=("azimuth",),
        depends="torque(sgn phi_dot) on azimuth",
        settings=lambda m, shape: {("asymmetry_Nm", 1): 2e-4 * m * shape["sign"]},
        draw=lambda rng: {"sign": sign(rng)},
        equivalent=lambda m, shape, visited: {"difference": relative(2e-4 * m * shape["sign"], either_sign=True)},
        bounds=(0.01, 2.0),
    ),
)
