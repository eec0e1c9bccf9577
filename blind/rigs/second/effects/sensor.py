"""Effects between an axis and the number that its encoder gives."""

from collections.abc import Callable, Mapping

import numpy as np
from numpy.random import Generator

from blind.effects.effect import Effect, Equivalent, Equivalents, Settings, Shape, Visited, relative, scale_of, sign

SENSORS = ("psi_sensor", "phi_sensor")
ANGLES = ("psi", "phi")


def sensor_effects(axis: int) -> tuple[Effect, ...]:
    """Every library effect of one encoder. An offset of the azimuth is left out: nothing depends on where azimuth's
    zero is."""
    return (*((_offset(),) if axis == 0 else ()), _scale(axis), *_timing(axis), _coarse(axis), _play(axis))


def _effect(
    axis: int,
    name: str,
    values: Callable[[float, Shape], Mapping[str, float]],
    draw: Callable[[Generator], Shape],
    equivalent: Callable[[float, Shape, Visited], Equivalents],
    bounds: tuple[float, float],
) -> Effect:
    def settings(m: float, shape: Shape) -> Settings:
        return {(field, axis): value for field, value in values(m, shape).items()}

    place = SENSORS[axis]
    depends = f"{name} of {ANGLES[axis]}"
    return Effect(f"{place}.{name}", (place,), depends, settings, draw, equivalent, bounds, sensor=True)


def _offset() -> Effect:
    """A disc that sits aside and not quite centred: the offset differs a little with the angle."""

    def equivalent(m: float, shape: Shape, visited: Visited) -> Equivalents:
        offset = 0.03 * m * shape["sign"] * (1.0 + shape["swing"] * np.sin(visited.psi))
        return {"offset": relative(float(offset.mean()))}

    return _effect(
        0,
        "offset",
        lambda m, shape: {"offset_rad": 0.03 * m * shape["sign"], "offset_swing": shape["swing"]},
        lambda rng: {"sign": sign(rng), "swing": rng.uniform(-0.15, 0.15)},
        equivalent,
        (0.02, 8.0),
    )


def _scale(axis: int) -> Effect:
    """A scale that is wrong by a little more further out."""

    def equivalent(m: float, shape: Shape, visited: Visited) -> Equivalents:
        x = visited.angle(axis)
        error = 0.04 * m * shape["sign"] * scale_of(x, x * (1.0 + shape["bend"] * np.abs(x)))
        return {"scale": Equivalent(1.0 + error, abs(error))}

    return _effect(
        axis,
        "scale",
        lambda m, shape: {"scale_error": 0.04 * m * shape["sign"], "scale_bend": shape["bend"]},
        lambda rng: {"sign": sign(rng), "bend": rng.uniform(0.0, 0.2)},
        equivalent,
        (0.02, 5.0),
    )


def _timing(axis: int) -> tuple[Effect, Effect]:
    """A delay that is never quite the same; two lags in a row."""
    delay = _effect(
        axis,
        "delay",
        lambda m, shape: {"sensor_delay_s": 0.012 * m, "sensor_spread": shape["spread"]},
        lambda rng: {"spread": rng.uniform(0.0, 0.2)},
        lambda m, shape, visited: {"tau": relative(0.012 * m)},
        (0.1, 7.0),
    )
    lag = _effect(
        axis,
        "lag",
        lambda m, shape: {"sensor_lag_s": 0.015 * m, "sensor_split": shape["split"]},
        lambda rng: {"split": rng.uniform(0.6, 0.9)},
        lambda m, shape, visited: {"tau": relative(0.015 * m)},
        (0.05, 8.0),
    )
    return delay, lag


def _coarse(axis: int) -> Effect:
    """Steps whose edges lie apart for the two directions."""
    return _effect(
        axis,
        "quantization",
        lambda m, shape: {"count_rad": 0.01 * m, "count_hold": shape["hold"]},
        lambda rng: {"hold": rng.uniform(0.0, 0.15)},
        lambda m, shape, visited: {"q": relative(0.01 * m)},
        (0.4, 4.0),
    )


def _play(axis: int) -> Effect:
    """Two gears in a row, one with more play than the other; the width is the mean."""
    return _effect(
        axis,
        "backlash",
        lambda m, shape: {"backlash_rad": 0.01 * m, "backlash_split": shape["split"]},
        lambda rng: {"split": rng.uniform(0.1, 0.4)},
        lambda m, shape, visited: {"width": relative(0.01 * m)},
        (0.3, 4.0),
    )
