"""Effects of dry friction in the two bearings; which law makes friction of them is the rig's."""

import numpy as np
from numpy.random import Generator

from blind.effects.effect import Effect, Equivalents, Settings, Shape, Visited, fitted, relative, shape_only, sign

AXES = ("elevation", "azimuth")
ANGLES = ("psi", "phi")
COULOMB_NM = (3e-4, 4e-4)
STRIBECK_NM = 5e-4


def bearing_effects(axis: int) -> tuple[Effect, ...]:
    """Every library effect of one bearing that both can have."""
    return (_coulomb(axis), _stribeck(axis))


def _coulomb(axis: int) -> Effect:
    """The plant file states no dry friction; the rig has it."""
    return Effect(
        name=f"{AXES[axis]}.coulomb",
        places=(AXES[axis],),
        depends=f"torque(sgn {ANGLES[axis]}_dot) on {AXES[axis]}",
        settings=lambda m, shape: {},
        equivalent=lambda m, shape, visited: {"b": relative(COULOMB_NM[axis] * m)},
        bounds=(0.03, 12.0),
        absent=(("b_cE", "b_cA")[axis],),
        coulomb={axis: COULOMB_NM[axis]},
    )


def _stribeck(axis: int) -> Effect:
    """1 / (1 + (v / v_s)^2) instead of the library's bell."""

    def equivalent(m: float, shape: Shape, visited: Visited) -> Equivalents:
        v, speed = np.abs(visited.rate(axis)), shape["speed_rad_s"]
        target = STRIBECK_NM * m / (1.0 + (v / speed) ** 2)
        b_s, v_s = fitted(lambda x: x[0] * np.exp(-((v / x[1]) ** 2)), target, [STRIBECK_NM * m, 1.5 * speed])
        return {"b_s": relative(b_s), "v_s": shape_only(abs(v_s), abs(v_s))}

    def settings(m: float, shape: Shape) -> Settings:
        return {("stribeck_Nm", axis): STRIBECK_NM * m, ("stribeck_rad_s", axis): shape["speed_rad_s"]}

    def draw(rng: Generator) -> Shape:
        return {"speed_rad_s": rng.uniform(0.03, 0.12)}

    depends = f"torque({ANGLES[axis]}_dot) on {AXES[axis]}"
    return Effect(f"{AXES[axis]}.stribeck", (AXES[axis],), depends, settings, draw, equivalent, (0.02, 12.0))


# Only one direction gets harder; the sign says which.
ASYMMETRY = Effect(
    name="azimuth.friction_asymmetry",
    places=("azimuth",),
    depends="torque(sgn phi_dot) on azimuth",
    settings=lambda m, shape: {("asymmetry_Nm", 1): 4e-4 * m * shape["sign"]},
    draw=lambda rng: {"sign": sign(rng)},
    equivalent=lambda m, shape, visited: {"difference": relative(4e-4 * m * shape["sign"], either_sign=True)},
    bounds=(0.03, 12.0),
)
