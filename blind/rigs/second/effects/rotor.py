"""Effects of the rotors and of the air around them."""

import numpy as np
from numpy.random import Generator

from blind.effects.effect import (
    Array,
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
FULL_RAD_S = 600.0


def rotor_effects(rotor: int) -> tuple[Effect, ...]:
    """Every library effect of one rotor that both can have."""
    return (_warm(rotor), _dry(rotor))


def warmed(t_s: Array, a: float, shape: Shape) -> Array:
    """What a warming drive has lost: a share with the winding, the rest with the case around it."""
    winding, around = (1.0 - np.exp(-t_s / shape[key]) for key in ("fast_s", "slow_s"))
    return np.asarray(a * (shape["share"] * winding + (1.0 - shape["share"]) * around))


def _warm(rotor: int) -> Effect:
    def settings(m: float, shape: Shape) -> Settings:
        values = {"warm": 0.05 * m, **{f"warm_{key}": value for key, value in shape.items()}}
        return {(field, rotor): value for field, value in values.items()}

    def equivalent(m: float, shape: Shape, visited: Visited) -> Equivalents:
        target = warmed(visited.t_s, 0.05 * m, shape)
        middle_s = shape["share"] * shape["fast_s"] + (1.0 - shape["share"]) * shape["slow_s"]
        a, time_s = fitted(lambda x: x[0] * (1.0 - np.exp(-visited.t_s / np.abs(x[1]))), target, [0.05 * m, middle_s])
        return {"a": relative(a), "T": shape_only(abs(time_s), abs(time_s))}

    def draw(rng: Generator) -> Shape:
        return {"fast_s": rng.uniform(3.0, 8.0), "slow_s": rng.uniform(15.0, 40.0), "share": rng.uniform(0.2, 0.8)}

    name, place = f"{ROTORS[rotor]}_rotor.warmup", f"{ROTORS[rotor]}_rotor"
    return Effect(name, (place,), f"gain(t) of omega_{'MT'[rotor]}", settings, draw, equivalent)


def braking(omega: Array, c: float, round_rad_s: float) -> Array:
    """A dry rotor bearing: rounded at rest, 1.4 times as much at break-away as at speed."""
    return np.asarray(c * np.tanh(omega / round_rad_s) * (1.0 + 0.4 / (1.0 + (omega / 25.0) ** 2)))


def _dry(rotor: int) -> Effect:
    def equivalent(m: float, shape: Shape, visited: Visited) -> Equivalents:
        omega = visited.omega(rotor)
        return {"c": relative(scale_of(np.sign(omega), braking(omega, 30.0 * m, shape["round_rad_s"])))}

    return Effect(
        name=f"{ROTORS[rotor]}_rotor.dry_friction",
        places=(f"{ROTORS[rotor]}_rotor",),
        depends=f"torque(sgn omega_{'MT'[rotor]}) on rotor",
        settings=lambda m, shape: {("dry", rotor): 30.0 * m, ("dry_round_rad_s", rotor): shape["round_rad_s"]},
        draw=lambda rng: {"round_rad_s": rng.uniform(1.0, 5.0)},
        equivalent=equivalent,
    )


def lifted(psi: Array, gain: float, reach: float) -> Array:
    """Cheeseman and Bennett's 1 / (1 - (R / 4 h)^2) - 1 over the height of the arm; `gain` at the lower stop."""
    height = 1.0 + reach * (np.sin(psi) + np.sin(STOP_RAD))
    return np.asarray(1.0 / (1.0 - gain / (1.0 + gain) / height**2) - 1.0)


def _ground_equivalent(m: float, shape: Shape, visited: Visited) -> Equivalents:
    above = visited.psi + STOP_RAD
    target = lifted(visited.psi, 0.06 * m, shape["reach"])
    start = [0.06 * m, 0.5 / shape["reach"]]
    a, psi_0 = fitted(lambda x: x[0] * np.exp(-above / np.abs(x[1])), target, start)
    return {"a": relative(a), "psi_0": shape_only(abs(psi_0), abs(psi_0))}


def _reverse_equivalent(m: float, shape: Shape, visited: Visited) -> Equivalents:
    """The share of the reversed thrust that is missing or added, on the whole."""
    lost = -0.2 * m * shape["sign"]
    w = visited.omega_T[visited.omega_T < -1.0]
    force = visited.tail_thrust(w)
    established = w**2 / (w**2 + shape["speed_rad_s"] ** 2)
    return {"r": Equivalent(1.0 + lost * (scale_of(force, established * force) if len(w) else 1.0), 0.2 * m)}


def _downwash_equivalent(m: float, shape: Shape, visited: Visited) -> Equivalents:
    x, force = visited.omega_M / FULL_RAD_S, visited.tail_thrust(visited.omega_T)
    lost = 1.0 - np.exp(-0.08 * m * np.abs(x) ** shape["power"])
    return {"a": relative(scale_of(x * force, lost * force))}


AIR = (
    Effect(
        name="main_rotor.ground_effect",
        places=("main_rotor",),
        depends="thrust(psi)",
        settings=lambda m, shape: {("ground", -1): 0.06 * m, ("ground_reach", -1): shape["reach"]},
        draw=lambda rng: {"reach": rng.uniform(0.8, 2.0)},
        equivalent=_ground_equivalent,
        bounds=(0.01, 12.0),
    ),
    Effect(
        name="tail_rotor.reverse_asymmetry",
        places=("tail_rotor",),
        depends="thrust(sgn omega_T)",
        settings=lambda m, shape: {
            ("reverse", -1): -0.2 * m * shape["sign"],
            ("reverse_rad_s", -1): shape["speed_rad_s"],
        },
        draw=lambda rng: {"sign": sign(rng), "speed_rad_s": rng.uniform(10.0, 40.0)},
        equivalent=_reverse_equivalent,
        bounds=(0.05, 4.5),
        needs="reversal",
    ),
    Effect(
        name="tail_rotor.downwash",
        places=("tail_rotor",),
        depends="thrust(omega_M)",
        settings=lambda m, shape: {("downwash", -1): 0.08 * m, ("downwash_power", -1): shape["power"]},
        draw=lambda rng: {"power": rng.uniform(0.8, 1.6)},
        equivalent=_downwash_equivalent,
    ),
)
