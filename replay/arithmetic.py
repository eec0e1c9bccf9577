"""The generated law run on a log in the arithmetic that flew: a log names its table, whose digest is the same in both arithmetics."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from codegen.fixed.formats import law_formats
from codegen.law import generate_law
from records.errors import BadInput
from records.table import ControllerTable
from replay import thresholds
from replay.flight import ReplayedLog, candidates_for_misread
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


def misread_in_fixed(flight: ReplayedLog, table: ControllerTable) -> list[int] | None:
    """The samples in which the law in fixed point had readings near those that the log holds, if with them every word agrees; else None.

    As few as may be: of the readings that give a sample's words those are taken with which the law follows the log farthest.
    """
    formats = law_formats(table)
    host = HostLaw(generate_law(table, FIXED), FIXED, loops=table.loops)
    given = words_from_floats(_given(flight), formats.angle_places)
    logged, known = words_from_floats(flight.logged_V, formats.voltage_places), ~np.isnan(flight.logged_V)
    moved = int(np.any(logged[1:] != logged[:-1], axis=1).sum())
    most = min(thresholds.MOST_MISREAD * len(given), (1.0 - thresholds.LEAST_EXPLAINED_SHARE) * moved)

    def follows(state: NDArray[np.uint32], first: int, behind: int) -> int:
        _, answered = host.run(state, np.ascontiguousarray(given[first:behind, np.newaxis]))
        differs = np.any((answered[:, 0] != logged[first:behind]) & known[first:behind], axis=1)
        return first + (int(np.argmax(differs)) if differs.any() else behind - first)

    state, row, found = host.start(np.ascontiguousarray(given[:1, len(table.loops) :])), 0, list[int]()
    while (stop := follows(state, row, len(given))) < len(given):
        state, _ = host.run(state, np.ascontiguousarray(given[row:stop, np.newaxis]))
        states = []
        for candidates in candidates_for_misread(flight, stop):
            words = words_from_floats(np.array(candidates), formats.angle_places)[np.newaxis]
            after, answered = host.run(np.repeat(state, len(candidates), axis=0), np.ascontiguousarray(words))
            fits = np.all((answered[0] == logged[stop]) | ~known[stop], axis=1)
            states = [np.ascontiguousarray(after[place : place + 1]) for place in np.flatnonzero(fits).tolist()]
            if states:
                break
        if not states or len(found) >= most:
            return None
        ahead, row = min(stop + 1 + thresholds.LOOK_AHEAD, len(given)), stop + 1
        state = max(states, key=lambda entry: follows(entry, stop + 1, ahead))
        found.append(stop)
    return found


def _given(flight: ReplayedLog) -> Array:
    return np.hstack([flight.reference_rad, flight.angle_rad])


def _run(table: ControllerTable, arithmetic: str, words: NDArray[np.uint32]) -> NDArray[np.uint32]:
    """Outputs (n, loops) of the generated C on inputs (n, 2 loops), from rest at the first angles."""
    host = HostLaw(generate_law(table, arithmetic), arithmetic, loops=table.loops)
    start = host.start(np.ascontiguousarray(words[:1, len(table.loops) :]))
    _, outputs = host.run(start, np.ascontiguousarray(words[:, np.newaxis]))
    return np.ascontiguousarray(outputs[:, 0])
