"""With how many digits a column was written down: numbers that a log rounded cannot be replayed to the last bit."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from replay import thresholds

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Printing:
    """Digits of a column: `decimals` behind the point or `digits` in all, whichever was found first; both None for all digits."""

    decimals: int | None = None
    digits: int | None = None

    @property
    def is_exact(self) -> bool:
        """True where nothing was rounded."""
        return self.decimals is None and self.digits is None

    def half_step(self, values: ArrayLike) -> Array:
        """How far rounding may have moved each value, shape of `values`, in their unit; 0 where nothing was rounded."""
        values = np.asarray(values, dtype=float)
        if self.decimals is not None:
            return np.full(values.shape, 0.5 * 10.0**-self.decimals)
        if self.digits is not None:
            return 0.5 * 10.0 ** (_exponents(values) + 1 - self.digits)
        return np.zeros(values.shape)

    def __str__(self) -> str:
        if self.decimals is not None:
            return f"{self.decimals} decimals"
        return "all digits" if self.digits is None else f"{self.digits} significant digits"


def printing(values: ArrayLike) -> Printing:
    """The digits with which `values` (n,) were written; all of them where fewer than FEWEST_VALUES distinct numbers are there."""
    distinct = np.unique(np.asarray(values, dtype=float))
    distinct = distinct[np.isfinite(distinct)]
    if distinct.size < thresholds.FEWEST_VALUES:
        return Printing()
    found = [*_decimals(distinct), *_digits(distinct[:: max(1, distinct.size // 200)])]
    # Numbers of few digits have many decimals where they are small: what rounds them most is how they were written.
    return max(found, key=lambda entry: float(np.median(entry.half_step(distinct))), default=Printing())


def _decimals(distinct: Array) -> Iterator[Printing]:
    for decimals in range(thresholds.MOST_DECIMALS + 1):
        if np.array_equal(np.round(distinct, decimals), distinct):
            yield Printing(decimals=decimals)
            return


def _digits(distinct: Array) -> Iterator[Printing]:
    for digits in range(1, thresholds.MOST_DIGITS + 1):
        if all(float(f"{value:.{digits}g}") == value for value in distinct.tolist()):
            yield Printing(digits=digits)
            return


def _exponents(values: Array) -> Array:
    """Power of ten of the first digit; that of the smallest normal float32 for zero."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(np.maximum(np.floor(np.log10(np.abs(values))), -38.0))
