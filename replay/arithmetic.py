"""The generated law run on a log in the arithmetic that flew: a log names its table, whose digest is the same in both arithmetics."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from codegen.fixed.formats import law_formats
from codegen.law import generate_law
from records.errors import BadInput
from records.table import ControllerTable
from replay import thresholds
from replay.flight import ReplayedLog
from verification.fixed_stimuli import words_from_floats
from verification.host_law import HostLaw

Array = NDArray[np.float64]

FLOAT32, FIXED = "float32", "fixed"


@dataclass(frozen=True, eq=False)
class Replayed:
    """Inputs (n, loops) in V that the law of one arithmetic gives on a log, and where the log holds another word.

    `word_V` is the unit of the last place in fixed point, 0 in float32.
    """

    arithmetic: str
    u_V: Array
    differs: NDArray[np.bool_]
    word_V: float = 0.0

    @property
    def agreeing(self) -> float:
        """Share of the samples in which all inputs agree."""
        return float(np.mean(~self.differs.any(axis=1)))


def replayed(flight: ReplayedLog, table: ControllerTable) -> Replayed:
    """The law as it most likely flew: in float32, unless fixed point agrees where that does not."""
    in_float32 = replayed_in_float32(flight, table)
    if not in_float32.differs.any():
        return in_float32
    try:
        in_fixed = replayed_in_fixed(flight, table)
    except BadInput:  # a table that no words can hold never flew in them
        return in_float32
    return in_fixed if in_fixed.agreeing > max(thresholds.FLOWN_IN_FIXED, in_float32.agreeing) else in_float32


def replayed_in_float32(flight: ReplayedLog, table: ControllerTable) -> Replayed:
    """Bit for bit; a sample that the log lacks does not differ."""
    outputs = _run(table, FLOAT32, _given(flight).astype(np.float32).view(np.uint32))
    u_V = outputs.view(np.float32).astype(float)
    differs = flight.logged_V.astype(np.float32) != u_V.astype(np.float32)
    return Replayed(FLOAT32, u_V, differs & ~np.isnan(flight.logged_V))


def replayed_in_fixed(flight: ReplayedLog, table: ControllerTable) -> Replayed:
    """Word for word; raises BadInput for a table that no words can hold."""
    formats = law_formats(table)
    outputs = _run(table, FIXED, words_from_floats(_given(flight), formats.angle_places))
    differs = words_from_floats(flight.logged_V, formats.voltage_places) != outputs
    u_V: Array = outputs.view(np.int32).astype(np.float64) * 2.0**-formats.voltage_places
    return Replayed(FIXED, u_V, differs & ~np.isnan(flight.logged_V), 2.0**-formats.voltage_places)


def _given(flight: ReplayedLog) -> Array:
    return np.hstack([flight.reference_rad, flight.angle_rad])


def _run(table: ControllerTable, arithmetic: str, words: NDArray[np.uint32]) -> NDArray[np.uint32]:
    """Outputs (n, loops) of the generated C on inputs (n, 2 loops), from rest at the first angles."""
    host = HostLaw(generate_law(table, arithmetic), arithmetic, loops=table.loops)
    start = host.start(np.ascontiguousarray(words[:1, len(table.loops) :]))
    _, outputs = host.run(start, np.ascontiguousarray(words[:, np.newaxis]))
    return np.ascontiguousarray(outputs[:, 0])
