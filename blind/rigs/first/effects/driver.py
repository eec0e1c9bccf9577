"""Effects between command and rotor: the drivers, their supply, the loop's timing."""

import numpy as np
from numpy.random import Generator

from blind.effects.effect import Effect, Equivalents, Settings, Shape, Visited, fitted, relative

ROTORS = ("main", "tail")
INPUTS = ("u_M", "u_T")


def driver_effects(rotor: int) -> tuple[Effect, ...]:
    """Every library effect of one driver."""
    return (
        _dead_zone(rotor),
        _saturation(rotor),
        _plain(rotor, "supply_sag", "sag", "s", 0.03, (0.003, 8.0), f"gain(u_M, u_T) of {INPUTS[rotor]}"),
        _plain(rotor, "delay", "delay_s", "tau", 0.01, (0.1, 8.0), f"delay of {INPUTS[rotor]}"),
        _slew(rotor),
        _plain(rotor, "quantization", "step_V", "q", 0.2, (0.05, 6.0), f"steps of {INPUTS[rotor]}"),
        _plain(rotor, "lag", "lag_s", "tau", 0.02, (0.05, 8.0), f"lag of {INPUTS[rotor]}"),
    )


def _place(rotor: int) -> tuple[str, ...]:
    return (f"{ROTORS[rotor]}_input",)


def _plain(
    rotor: int, name: str, setting: str, symbol: str, size: float, bounds: tuple[float, float], depends: str
) -> Effect:
    """An effect with one number that means the same in the library's formula."""
    return Effect(
        name=f"{ROTORS[rotor]}_input.{name}",
        places=_place(rotor),
        depends=depends,
        settings=lambda m, shape: {(setting, rotor): size * m},
        equivalent=lambda m, shape, visited: {symbol: relative(size * m)},
        bounds=bounds,
    )


def _dead_zone(rotor: int) -> Effect:
    """Rounded knees here, a hard corner in the library."""

    def settings(m: float, shape: Shape) -> Settings:
        d = 0.2 * m
        return {("dead_V", rotor): d, ("dead_width_V", rotor): shape["width"] * d}

    def equivalent(m: float, shape: Shape, visited: Visited) -> Equivalents:
        d = 0.2 * m
        w = shape["width"] * d
        u = np.abs(visited.u(rotor))
        out = w * (np.logaddexp(0.0, (u - d) / w) - np.log1p(np.exp(-d / w)))
        best = fitted(lambda x: np.maximum(u - x[0], 0.0) - u, out - u, [d])
        return {"d": relative(best[0])}

    def draw(rng: Generator) -> Shape:
        return {"width": rng.uniform(0.1, 0.35)}

    name = f"{ROTORS[rotor]}_input.deadzone"
    return Effect(name, _place(rotor), f"dead band of {INPUTS[rotor]}", settings, draw, equivalent, (0.01, 8.0))


def _saturation(rotor: int) -> Effect:
    """A rounded corner here; more is a lower limit."""
    base = (7.6, 4.0)[rotor]

    def equivalent(m: float, shape: Shape, visited: Visited) -> Equivalents:
        limit = base / m
        u = visited.u(rotor)
        out = u / (1.0 + (u / limit) ** 12) ** (1.0 / 12.0)
        best = fitted(lambda x: np.clip(u, -abs(x[0]), abs(x[0])) - u, out - u, [0.97 * limit])
        return {"limit": relative(abs(best[0]))}

    return Effect(
        name=f"{ROTORS[rotor]}_input.saturation",
        places=_place(rotor),
        depends=f"limit of {INPUTS[rotor]}",
        settings=lambda m, shape: {("limit_V", rotor): base / m},
        equivalent=equivalent,
        bounds=((0.8, 1.28), (0.6, 1.7))[rotor],
    )


def _slew(rotor: int) -> Effect:
    return Effect(
        name=f"{ROTORS[rotor]}_input.slew_limit",
        places=_place(rotor),
        depends=f"rate limit of {INPUTS[rotor]}",
        settings=lambda m, shape: {("slew_V_s", rotor): 10.0 / m},
        equivalent=lambda m, shape, visited: {"r": relative(10.0 / m)},
        bounds=(0.05, 12.0),
    )


LOOP = (
    Effect(
        name="loop.delay",
        places=("loop",),
        depends="delay of u_M and u_T",
        settings=lambda m, shape: {("delay_s", 0): 0.01 * m, ("delay_s", 1): 0.01 * m},
        equivalent=lambda m, shape, visited: {"tau": relative(0.01 * m)},
        bounds=(0.1, 6.0),
    ),
    Effect(
        name="loop.dropped_frames",
        places=("loop",),
        depends="lost updates of u_M and u_T",
        settings=lambda m, shape: {},
        equivalent=lambda m, shape, visited: {"p": relative(min(0.1 * m, 0.6))},
        bounds=(0.05, 5.0),
        loss=0.1,
    ),
)
