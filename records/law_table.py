"""The table of a controller that is not the scheduled one: its own numbers in the frame that all controllers share.

    u = feedback(reference, angle) + u_ff(filtered reference of the scheduling angle),   limited

The frame accepts inputs, filters references, adds the operating point's voltage and limits; what the feedback is made of are the
controller's own `gains`, a frozen record of numbers and tuples of numbers.
"""

from dataclasses import dataclass
from typing import Any, Generic, Protocol, TypeVar

from records.table import Polynomial, Table, lag_gain, text_of

SCHEMA = "law-table/1"
G = TypeVar("G")


class AxisRange(Protocol):
    """What every table states of an axis: the range of its references, its limits, its encoder's step."""

    @property
    def reference_min_rad(self) -> float:
        """Least reference that the law takes [rad]."""

    @property
    def reference_max_rad(self) -> float:
        """Largest reference that the law takes [rad]."""

    @property
    def u_min_V(self) -> float:
        """Least voltage."""

    @property
    def u_max_V(self) -> float:
        """Largest voltage."""

    @property
    def resolution_rad(self) -> float:
        """The encoder's step [rad]."""


# What flies, whichever controller it is of: records.table.ControllerTable, or LawTable.
FlownTable = Table[Any]


@dataclass(frozen=True)
class AxisTable(Generic[G]):
    """One axis: the controller's own `gains`, the frame's feed-forward, reference filter, limits and ranges (V, rad)."""

    gains: G
    feedforward_V: Polynomial
    prefilter_time_constant_s: float
    u_min_V: float
    u_max_V: float
    u_safe_V: float
    reference_min_rad: float
    reference_max_rad: float
    resolution_rad: float

    def prefilter_gain(self, sample_period_s: float) -> float:
        """b of the axis' reference filter, see `lag_gain`."""
        return lag_gain(self.prefilter_time_constant_s, sample_period_s)


@dataclass(frozen=True, kw_only=True)
class LawTable(Table[AxisTable[G]]):
    """The table of another controller, by its name."""

    controller: str


def law_table_text(table: LawTable[Any]) -> str:
    """The table as JSON text, see records.table.text_of."""
    return text_of(SCHEMA, table)
