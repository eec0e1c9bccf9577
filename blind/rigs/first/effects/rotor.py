"""Effects of the rotors and of the air around them."""

import numpy as np
from numpy.random import Generator

from blind.effects.effect import (
    Effect,
    Equivalent,
    Equivalents,
    Settings,
    Shape,
    Visited,
    fitted,
    relative,
    scale_of,
    shape_only,
    sign,
)

ROTORS = ("main", "tail")
STOP_RAD = np.pi / 4


def rotor_effects(rotor: int) -> tuple[Effect, ...]:
    """Every library effect of one rotor that both can have."""
    return (_warmup(rotor), _dry(rotor))


def _warmup(rotor: int) -> Effect:
    """Winding resistance grows here; the library lets the drive fall."""

    def equivalent(m: float, shape: Shape, visited: Visited) -> Equivalents:
        rise = 1.0 - np.exp(-visited.t_s / shape["time_s"])
        target = 1.0 / (1.0 + 0.03 * m * rise) - 1.0
        a, time_s = fitted(lambda x: -x[0] * (1.0 - np.exp(-visited.t_s / x[1])), target, [0.03 * m, shape["time_s"]])
        return {"a": relative(a), "T": shape_only(time_s, time_s)}

    def draw(rng: Generator) -> Shape:
        return {"time_s": rng.uniform(8.0, 40.0)}

    return Effect(
        name=f"{ROTORS[rotor]}_rotor.warmup",
        places=(f"{ROTORS[rotor]}_rotor",),
        depends=f"gain(t) of omega_{'MT'[rotor]}",
        settings=lambda m, shape: {("warm", rotor): 0.03 * m, ("warm_time_s", rotor): shape["time_s"]},
        draw=draw,
        equivalent=equivalent,
    )


def _dry(rotor: int) -> Effect:
    return Effect(
        name=f"{ROTORS[rotor]}_rotor.dry_friction",
        places=(f"{ROTORS[rotor]}_rotor",),
        depends=f"torque(sgn omega_{'MT'[rotor]}) on rotor",
        settings=lambda m, shape: {("dry", rotor): 30.0 * m},
        equivalent=lambda m, shape, visited: {"c": relative(30.0 * m)},
    )


def _ground_settings(m: float, shape: Shape) -> Settings:
    return {("ground", -1): 0.05 * m, ("ground_height_rad", -1): shape["height_rad"]}


def _ground_equivalent(m: float, shape: Shape, visited: Visited) -> Equivalents:
    """Inverse square of the height here, an exponential in the library: 1/psi_0 starts as the slope at the middle."""
    above = visited.psi + STOP_RAD
    target = 0.05 * m * (shape["height_rad"] / (shape["height_rad"] + above)) ** 2
    a, psi_0 = fitted(lambda x: x[0] * np.exp(-above / np.abs(x[1])), target, [0.05 * m, shape["height_rad"]])
    return {"a": relative(a), "psi_0": shape_only(abs(psi_0), abs(psi_0))}


def _reverse_draw(rng: Generator) -> Shape:
    return {"sign": sign(rng), "width_rad_s": rng.uniform(5.0, 30.0)}


def _downwash_equivalent(m: float, shape: Shape, visited: Visited) -> Equivalents:
    """F_T / (1 + a x) here, F_T (1 - a x) in the library."""
    x = visited.omega_M / 600.0
    weight = visited.tail_thrust(visited.omega_T)
    return {"a": relative(scale_of(x * weight, (1.0 - 1.0 / (1.0 + 0.05 * m * x)) * weight))}


AIR = (
    Effect(
        name="main_rotor.ground_effect",
        places=("main_rotor",),
        depends="thrust(psi)",
        settings=_ground_settings,
        draw=lambda rng: {"height_rad": rng.uniform(0.25, 0.6)},
        equivalent=_ground_equivalent,
    ),
    Effect(
        name="tail_rotor.reverse_asymmetry",
        places=("tail_rotor",),
        depends="thrust(sgn omega_T)",
        settings=lambda m, shape: {
            ("reverse", -1): -0.15 * m * shape["sign"],
            ("reverse_width_rad_s", -1): shape["width_rad_s"],
        },
        draw=_reverse_draw,
        equivalent=lambda m, shape, visited: {"r": Equivalent(1.0 - 0.15 * m * shape["sign"], 0.15 * m)},
        bounds=(0.05, 5.0),
        needs="reversal",
    ),
    Effect(
        name="tail_rotor.downwash",
        places=("tail_rotor",),
        depends="thrust(omega_M)",
        settings=lambda m, shape: {("downwash", -1): 0.05 * m},
        equivalent=_downwash_equivalent,
    ),
)
