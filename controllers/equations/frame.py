"""A controller's numbers in the frame that it shares with the scheduled law (codegen/law_frame.py), and what it may ask beyond."""

from collections.abc import Callable
from dataclasses import dataclass, fields, is_dataclass, replace
from typing import Any, Protocol, TypeVar

import numpy as np

from codegen.law_frame import Arithmetic, AxisFrame, LawNumbers, frame_numbers, range_numbers, without_vanishing_powers
from records.law_table import AxisTable, LawTable

N = TypeVar("N")


class Decisions(Arithmetic[N], Protocol[N]):
    """What controllers ask of an arithmetic beyond what the frame asks."""

    def is_less(self, value: N, other: N) -> Any:
        """Condition value < other; neither is NaN."""


@dataclass(frozen=True)
class AxisNumbers(AxisFrame[N]):
    """Numbers of one axis; `gains` is the controller's record with every number made by the arithmetic."""

    gains: Any


def numbers_of(table: LawTable[Any], number: Callable[[float], N]) -> LawNumbers[N]:
    """All numbers of a table, each made by `number`."""

    def of_axis(axis: AxisTable[Any]) -> AxisNumbers[N]:
        return AxisNumbers(gains=_each(axis.gains, number), **frame_numbers(axis, table.sample_period_s, number))

    return LawNumbers(axes=tuple(of_axis(axis) for axis in table.axes), **range_numbers(table, number))


def _each(entry: Any, number: Callable[[float], Any]) -> Any:
    """The same record, tuple or number with `number` applied to every float; whole numbers are sizes and stay."""
    if is_dataclass(entry) and not isinstance(entry, type):
        return replace(entry, **{field.name: _each(getattr(entry, field.name), number) for field in fields(entry)})
    if isinstance(entry, tuple):
        return tuple(_each(value, number) for value in entry)
    return number(entry) if isinstance(entry, float) else entry


def float32_polynomial(coefficients: tuple[float, ...]) -> tuple[float, ...]:
    """The polynomial as C stores it: never empty, so that its array has a size."""
    used = without_vanishing_powers(coefficients)
    return tuple(float(np.float32(value)) for value in used) or (0.0,)
