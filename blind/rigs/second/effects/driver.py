"""Effects between command and rotor: drivers, supply, the loop's timing."""

import numpy as np
from numpy.random import Generator

from blind.effects.effect import Array, Effect, Equivalents, Settings, Shape, Visited, fitted, relative, scale_of

ROTORS = ("main", "tail")
INPUTS = ("u_M", "u_T")
LOWEST_LIMIT_V = (7.2, 4.2)


def driver_effects(rotor: int) -> tuple[Effect, ...]:
    """Every library effect of one driver."""
    return (_dead(rotor), _limit(rotor), _sag(rotor), _delay(rotor), _slew(rotor), _steps(rotor), _lag(rotor))


def _name(rotor: int, what: str) -> tuple[str, tuple[str, ...]]:
    place = f"{ROTORS[rotor]}_input"
    return f"{place}.{what}", (place,)


def dead_band(u: Array, d: float, knee: float, skew: float) -> Array:
    """A parabola for a knee, d a little wider for positive voltages than for negative ones."""
    own = d * (1.0 + skew * np.sign(u))
    size = np.abs(u)
    rounded = (size - own * (1.0 - knee)) ** 2 / (4.0 * knee * own)
    kept = np.where(size >= own * (1.0 + knee), size - own, np.where(size <= own * (1.0 - knee), 0.0, rounded))
    return np.asarray(kept * np.sign(u))


def _dead(rotor: int) -> Effect:
    size = 0.25

    def settings(m: float, shape: Shape) -> Settings:
        values = {"dead_V": size * m, "dead_knee": shape["knee"], "dead_skew": shape["skew"]}
        return {(field, rotor): value for field, value in values.items()}

    def equivalent(m: float, shape: Shape, visited: Visited) -> Equivalents:
        u = visited.u(rotor)
        out = dead_band(u, size * m, shape["knee"], shape["skew"])
        best = fitted(lambda x: np.sign(u) * np.maximum(np.abs(u) - x[0], 0.0) - u, out - u, [size * m])
        return {"d": relative(best[0])}

    def draw(rng: Generator) -> Shape:
        return {"knee": rng.uniform(0.1, 0.5), "skew": rng.uniform(-0.15, 0.15)}

    name, places = _name(rotor, "deadzone")
    return Effect(name, places, f"dead band of {INPUTS[rotor]}", settings, draw, equivalent, (0.01, 8.0))


def soft_limit(u: Array, limit: float, knee: float) -> Array:
    """Straight up to (1 - knee) of the limit, then towards it as a tanh."""
    room, size = limit * knee, np.abs(u)
    bent = limit - room + room * np.tanh((size - limit + room) / room)
    return np.asarray(np.where(size <= limit - room, size, bent) * np.sign(u))


def _limit(rotor: int) -> Effect:
    size = LOWEST_LIMIT_V[rotor]

    def equivalent(m: float, shape: Shape, visited: Visited) -> Equivalents:
        u = visited.u(rotor)
        out = soft_limit(u, size / m, shape["knee"])
        if np.array_equal(out, u):
            return {"limit": relative(size / m)}
        # A limit above all that came through would have no slope and stay where it starts.
        start = min(size / m, 0.99 * float(np.abs(out).max()))
        best = fitted(lambda x: np.clip(u, -abs(x[0]), abs(x[0])) - u, out - u, [start])
        return {"limit": relative(abs(best[0]))}

    name, places = _name(rotor, "saturation")
    return Effect(
        name,
        places,
        f"limit of {INPUTS[rotor]}",
        lambda m, shape: {("limit_V", rotor): size / m, ("limit_knee", rotor): shape["knee"]},
        lambda rng: {"knee": rng.uniform(0.03, 0.15)},
        equivalent,
        ((0.7, 1.22), (0.5, 1.9))[rotor],
    )


def _sag(rotor: int) -> Effect:
    """A source with an inner resistance and a capacitor: u / (1 + s load / 10 V), the load a little late."""

    def equivalent(m: float, shape: Shape, visited: Visited) -> Equivalents:
        u, load = visited.u(rotor), (np.abs(visited.u_M) + np.abs(visited.u_T)) / 10.0
        return {"s": relative(scale_of(load * u, (1.0 - 1.0 / (1.0 + 0.03 * m * load)) * u))}

    name, places = _name(rotor, "supply_sag")
    return Effect(
        name,
        places,
        f"gain(u_M, u_T) of {INPUTS[rotor]}",
        lambda m, shape: {("sag", rotor): 0.03 * m, ("supply_s", -1): shape["time_s"]},
        lambda rng: {"time_s": rng.uniform(0.02, 0.15)},
        equivalent,
        (0.01, 12.0),
    )


def _late(rotors: tuple[int, ...], m: float, shape: Shape) -> Settings:
    values = {"delay_s": 0.012 * m, "delay_spread": shape["spread"]}
    return {(field, rotor): value for field, value in values.items() for rotor in rotors}


def _delay(rotor: int) -> Effect:
    """A delay that is never quite the same."""
    name, places = _name(rotor, "delay")
    return Effect(
        name,
        places,
        f"delay of {INPUTS[rotor]}",
        lambda m, shape: _late((rotor,), m, shape),
        lambda rng: {"spread": rng.uniform(0.0, 0.25)},
        lambda m, shape, visited: {"tau": relative(0.012 * m)},
        (0.1, 8.0),
    )


def _slew(rotor: int) -> Effect:
    """Not quite as fast down as up."""
    name, places = _name(rotor, "slew_limit")
    return Effect(
        name,
        places,
        f"rate limit of {INPUTS[rotor]}",
        lambda m, shape: {("slew_V_s", rotor): 8.0 / m, ("slew_skew", rotor): shape["skew"]},
        lambda rng: {"skew": rng.uniform(-0.12, 0.12)},
        lambda m, shape, visited: {"r": relative(8.0 / m)},
        (0.05, 12.0),
    )


def _steps(rotor: int) -> Effect:
    """Steps with a memory: a level is left late."""
    name, places = _name(rotor, "quantization")
    return Effect(
        name,
        places,
        f"steps of {INPUTS[rotor]}",
        lambda m, shape: {("step_V", rotor): 0.25 * m, ("step_hold", rotor): shape["hold"]},
        lambda rng: {"hold": rng.uniform(0.05, 0.2)},
        lambda m, shape, visited: {"q": relative(0.25 * m)},
        (0.05, 8.0),
    )


def _lag(rotor: int) -> Effect:
    """Two lags in a row."""
    name, places = _name(rotor, "lag")
    return Effect(
        name,
        places,
        f"lag of {INPUTS[rotor]}",
        lambda m, shape: {("lag_s", rotor): 0.02 * m, ("lag_split", rotor): shape["split"]},
        lambda rng: {"split": rng.uniform(0.6, 0.9)},
        lambda m, shape, visited: {"tau": relative(0.02 * m)},
        (0.05, 6.0),
    )


LOOP = (
    Effect(
        name="loop.delay",
        places=("loop",),
        depends="delay of u_M and u_T",
        settings=lambda m, shape: _late((0, 1), m, shape),
        draw=lambda rng: {"spread": rng.uniform(0.0, 0.25)},
        equivalent=lambda m, shape, visited: {"tau": relative(0.012 * m)},
        bounds=(0.1, 8.0),
    ),
    Effect(
        name="loop.dropped_frames",
        places=("loop",),
        depends="lost updates of u_M and u_T",
        settings=lambda m, shape: {},
        draw=lambda rng: {"burst_frames": 1.0 if rng.random() < 0.5 else rng.uniform(2.0, 6.0)},
        equivalent=lambda m, shape, visited: {"p": relative(min(0.1 * m, 0.6))},
        bounds=(0.05, 6.0),
        loss=0.1,
    ),
)
