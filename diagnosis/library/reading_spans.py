"""Readings that may be off by anything within a span: how unsure they are, and what they count in the likelihood."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from diagnosis.filter.filter_input import FilterInput

Array = NDArray[np.float64]


@dataclass(frozen=True)
class UniformError:
    """An error that may be anything within a span of that `width`; what each is charged with instead of each row, and what is known of all
    of them, in nats."""

    width: float
    each_nats: float
    known_nats: float = 0.0


def less_sure(
    filter_input: FilterInput, output: int, rows: NDArray[np.int64], alike: Array, error: UniformError
) -> FilterInput:
    """The filter input where the readings of `rows` (n,) are off by such errors, so many `alike` (n,) by one."""
    r = filter_input.r.copy()
    r[rows, output] += alike * error.width**2 / 12.0
    counts = filter_input.place[rows, output] >= 0
    counted = rows[counts]
    each = 0.5 * float(np.sum(np.log(r[counted, output] / filter_input.r[counted, output])))
    errors = float(np.sum(1.0 / alike[counts]))
    return replace(filter_input, r=r, known=filter_input.known + each + error.known_nats - error.each_nats * errors)


def charge(filter_input: FilterInput, output: int, span: float) -> float:
    """What a reading that may be off by anything within `span` costs in likelihood."""
    return 0.5 * float(np.log1p(span**2 / 12.0 / filter_input.single[output]))
