"""Readings that may be off by anything within a span: how unsure they are, and what they count in the likelihood."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from diagnosis.filter.filter_input import FilterInput

Array = NDArray[np.float64]


def less_sure(
    filter_input: FilterInput,
    output: int,
    rows: NDArray[np.int64],
    alike: Array,
    span: float,
    each_nats: float,
    known: float = 0.0,
) -> FilterInput:
    """The filter input where the readings of `rows` (n,) may be off by anything within `span`, so many `alike` (n,) by one error; which is
    charged with `each_nats` for each such error instead of by each row, less what is `known` in nats."""
    r = filter_input.r.copy()
    r[rows, output] += alike * span**2 / 12.0
    counts = filter_input.place[rows, output] >= 0
    counted = rows[counts]
    each = 0.5 * float(np.sum(np.log(r[counted, output] / filter_input.r[counted, output])))
    return replace(
        filter_input, r=r, known=filter_input.known + each + known - each_nats * float(np.sum(1.0 / alike[counts]))
    )


def charge(filter_input: FilterInput, output: int, span: float) -> float:
    """What a reading that may be off by anything within `span` costs in likelihood."""
    return 0.5 * float(np.log1p(span**2 / 12.0 / filter_input.single[output]))
