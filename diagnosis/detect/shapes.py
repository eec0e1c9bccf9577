"""Shapes that a form takes: functions of one signal with their text, waves, what lies beyond an edge, what bristles follow."""

from collections.abc import Callable, Iterator, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Shapes = Mapping[str, Callable[[Array], Array]]
SQUARE = "{x} |{x}|"
WAVES = {"sin({count} {x})": 0.0, "cos({count} {x})": np.pi / 2}


def shaped(depends: str, name: str, x: Array, shapes: Shapes) -> Iterator[tuple[str, str, Array]]:
    return ((depends, text.format(x=name), np.asarray(shape(x), float)) for text, shape in shapes.items())


def waves_a_turn(counts: Sequence[int], texts: Sequence[str] = tuple(WAVES)) -> Shapes:
    """Sines and cosines of so many waves a turn."""
    return {text.format(count=count, x="{x}"): _wave(count, WAVES[text]) for count in counts for text in texts}


def _wave(count: int, shift: float) -> Callable[[Array], Array]:
    return lambda x: np.asarray(np.sin(count * x + shift))


def beyond(name: str, x: Array) -> Iterator[tuple[str, Array]]:
    """What of x lies beyond its rare values on either side."""
    for share in (2.0, 5.0, 15.0, 85.0, 95.0, 98.0):
        edge = float(np.percentile(x, share))
        above = share > 50.0
        text = f"what of {name} lies {'above' if above else 'below'} {edge:.3g}"
        yield text, np.maximum(x - edge, 0.0) if above else np.minimum(x - edge, 0.0)


def follower(x: Array, width: float) -> Array:
    """Where a brush of stiff bristles of `width` stands that x drags along."""
    z, found = 0.0, []
    for change in np.diff(x, prepend=x[0]).tolist():
        z = min(max(z + change, -width), width)
        found.append(z)
    return np.array(found)


def jitter(u: Array) -> Array:
    return np.append(0.0, np.abs(np.diff(u)))


def plain(shape: str) -> str:
    """Without brackets that a sign or bars around them make idle."""
    for twice, once in (("((", "("), ("))", ")"), ("|(", "|"), (")|", "|")):
        shape = shape.replace(twice, once)
    return shape
