"""What is said of a column in another unit, and how large its numbers are."""

import numpy as np

from logcheck import thresholds
from logcheck.finding import REFUSE, Array, Finding, Found
from records.log import RunLog


def slip(log: RunLog, name: str, column: str, sentence: str, expected: str, remedy: str) -> Found:
    """A column that is refused, from its first row to its last."""
    span = (float(log.t_s[0]), float(log.t_s[-1]))
    return Found(Finding("unit_slip", name, column, *span, sentence, REFUSE, 0, expected, remedy))


def greatest_of(values: Array) -> float:
    """How far values are from zero, but for single rows, which may be wrong in any unit."""
    return float(np.quantile(np.abs(values), thresholds.UNIT_QUANTILE))
