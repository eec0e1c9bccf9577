"""The table of a controller that is not the scheduled one: its own numbers in the frame that all controllers share.

    u = feedback(reference, angle) + u_ff(filtered elevation reference),   limited

The frame accepts inputs, filters references, adds the operating point's voltage and limits; what the feedback is made of are the
controller's own `gains`, a frozen record of numbers and tuples of numbers.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Generic, Protocol, TypeVar

from records.table import BothAxes, Polynomial, digest_of, lag_gain, text_of

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


class FlownTable(Protocol):
    """What every table states, whichever controller it is of: records.table.ControllerTable, or LawTable."""

    @property
    def plant(self) -> str:
        """The plant file's name."""

    @property
    def sample_period_s(self) -> float:
        """Time from sample to sample [s]."""

    @property
    def elevation(self) -> AxisRange:
        """The elevation's ranges."""

    @property
    def azimuth(self) -> AxisRange:
        """The azimuth's ranges."""

    @property
    def digest(self) -> str:
        """The name of the table: 64 hexadecimal digits."""


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


@dataclass(frozen=True)
class LawTable(BothAxes[AxisTable[G]]):
    """Both axes of a controller over the elevations psi_min_rad..psi_max_rad; `origin` tells where the numbers are from."""

    controller: str
    plant: str
    sample_period_s: float
    psi_min_rad: float
    psi_max_rad: float
    elevation: AxisTable[G]
    azimuth: AxisTable[G]
    origin: Mapping[str, Any] = field(default_factory=dict)

    @property
    def digest(self) -> str:
        """See records.table.digest_of."""
        return digest_of(self)


def law_table_text(table: LawTable[Any]) -> str:
    """The table as JSON text, see records.table.text_of."""
    return text_of(SCHEMA, table)
