"""A size in the words of the diagnosis' library: a parameter, and how the library's formula is brought nearest to the benchmark's."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

Array = NDArray[np.float64]
PHASES = np.linspace(0.0, 1.0, 4001)  # of a pulse


@dataclass(frozen=True)
class Equivalent:
    """A parameter in the library's formula, SI units; an estimate's error is |estimate - value| / scale.

    `either_sign` where the contract leaves the sign's meaning open; `main` where the parameter counts in the error's median.
    """

    value: float
    scale: float
    either_sign: bool = False
    main: bool = True


Equivalents = Mapping[str, Equivalent]


def relative(value: float, either_sign: bool = False) -> Equivalent:
    """A parameter judged relative to its own size."""
    return Equivalent(float(value), abs(float(value)), either_sign)


def shape_only(value: float, scale: float) -> Equivalent:
    """A parameter that is stored and judged on `scale`, but does not count in the median error."""
    return Equivalent(float(value), float(scale), main=False)


def fitted(formula: Callable[[Array], Array], target: Array, start: Sequence[float]) -> Array:
    """Parameters of the library's formula that come nearest, by least squares, to the benchmark's `target` (n,)."""
    size = float(np.sqrt(np.mean(target**2))) or 1.0
    scale = np.abs(np.asarray(start)) + 1e-6
    solved = least_squares(lambda x: (formula(x) - target) / size, np.asarray(start), x_scale=scale, method="lm")
    return np.asarray(solved.x)


def below_largest(a: float, shape: Mapping[str, float], target: Array) -> list[float]:
    """Where the fit of a limit starts: one above all that came through would have no slope and stay there."""
    return [min(a, 0.99 * float(np.abs(target).max()))]


def scale_of(formula: Array, target: Array) -> float:
    """The factor that brings `formula` (n,) nearest to `target` (n,), by least squares."""
    return float(formula @ target / (formula @ formula))


def nearest_rectangle(height: Array) -> tuple[float, float]:
    """(height, width as a share of the pulse) of the rectangle in its middle that comes nearest to a pulse `height` (4001,) over PHASES."""
    widths = np.linspace(0.3, 1.0, 141)
    area = np.array([height[np.abs(PHASES - 0.5) <= width / 2].sum() / len(PHASES) for width in widths])
    best = int(np.argmax(area**2 / widths))
    return float(area[best] / widths[best]), float(widths[best])
