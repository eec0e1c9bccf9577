"""Effects between an axis and the number that its encoder gives."""

from collections.abc import Callable

from numpy.random import Generator

from blind.effects.effect import Effect, Equivalent, Equivalents, Settings, Shape, Visited, relative, sign

SENSORS = ("psi_sensor", "phi_sensor")
ANGLES = ("psi", "phi")


def sensor_effects(axis: int) -> tuple[Effect, ...]:
    """Every library effect of one encoder. An offset of the azimuth is left out: nothing depends on where azimuth's zero is."""
    offset = (_signed(axis, "offset", "offset_rad", 0.02),) if axis == 0 else ()
    return (
        *offset,
        _scale(axis),
        _plain(axis, "quantization", "count_rad", "q", 0.006, (0.5, 6.0)),
        _plain(axis, "delay", "sensor_delay_s", "tau", 0.01, (0.1, 6.0)),
        _plain(axis, "lag", "sensor_lag_s", "tau", 0.015, (0.05, 6.0)),
        _plain(axis, "backlash", "backlash_rad", "width", 0.006, (0.3, 6.0)),
    )


def _make(
    axis: int,
    name: str,
    settings: Callable[[float, Shape], Settings],
    draw: Callable[[Generator], Shape],
    equivalent: Callable[[float, Shape, Visited], Equivalents],
    bounds: tuple[float, float],
) -> Effect:
    depends = f"{name} of {ANGLES[axis]}"
    place = SENSORS[axis]
    return Effect(f"{place}.{name}", (place,), depends, settings, draw, equivalent, bounds, sensor=True)


def _plain(axis: int, name: str, setting: str, symbol: str, size: float, bounds: tuple[float, float]) -> Effect:
    return _make(
        axis,
        name,
        lambda m, shape: {(setting, axis): size * m},
        lambda rng: {},
        lambda m, shape, visited: {symbol: relative(size * m)},
        bounds,
    )


def _signed(axis: int, name: str, setting: str, size: float) -> Effect:
    return _make(
        axis,
        name,
        lambda m, shape: {(setting, axis): size * m * shape["sign"]},
        lambda rng: {"sign": sign(rng)},
        lambda m, shape, visited: {name: relative(size * m * shape["sign"])},
        (0.02, 5.0),
    )


def _scale(axis: int) -> Effect:
    return _make(
        axis,
        "scale",
        lambda m, shape: {("scale_error", axis): 0.03 * m * shape["sign"]},
        lambda rng: {"sign": sign(rng)},
        lambda m, shape, visited: {"scale": Equivalent(1.0 + 0.03 * m * shape["sign"], 0.03 * m)},
        (0.02, 6.0),
    )
