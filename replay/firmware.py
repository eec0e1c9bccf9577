"""The controller's own code run again on a log: bit-exact, or the first difference and its cause.

    r_k = u_k - C(y_0..y_k, r_0..r_k)

with C the generated law, compiled for this computer, in the arithmetic that flew (firmware_replay_words.py). Where r is not zero in
every bit, other firmwares are run as code until one leaves nothing (firmware_replay_search.py). One that leaves anything is no
cause: then it says that none was found. Other firmwares are known in floating point only.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from records.diagnosis import Firmware, LiesIn, names_of
from records.errors import BadInput
from records.log import RunLog
from records.logs.sidecar import DOUBLE
from records.table import ControllerTable
from records.text.units import units_of
from replay.arithmetic import FIXED, Replayed, misread_in_fixed, replayed, replayed_in_fixed
from replay.causes.columns import OF_THE_COLUMNS
from replay.causes.lone import ANGLE_LOGGED_LATE, LOGGED_LATE
from replay.causes.printed import agrees_as_printed
from replay.flight import ReplayedLog, flight_of, has_replayable_columns
from replay.follower import MISREAD, UNLOGGED
from replay.law import FLOAT32, FLOAT64
from replay.search import LOG_ROUNDING, MISSING_ROWS, REPEATED_ROW, Told, channel_cause, explain, other_readings
from replay.variants import EARLY_OUTPUT, LATE_OUTPUT

NOT_FOUND = "not_found"
INPUT_UNKNOWN = "input_not_logged"
IN_DOUBLE = "flown_in_double"
AGREES_IN_DOUBLE = (
    "the law flew in double precision, as the log says, and no firmware did; run again in it, it agrees within rounding"
)
IN_FIXED_POINT = "the firmware computes in fixed point and agrees in every word"
ROUNDING_V = 1e-3
BEHIND_LIMIT = 2  # rows off the limits after which what they did to the law's state shows in its answer
# What is the log's doing alone: but for what it lacks, or holds twice or too late, the firmware did as its table says.
CLEARED = (LOG_ROUNDING, MISSING_ROWS, REPEATED_ROW, UNLOGGED, MISREAD, INPUT_UNKNOWN, IN_DOUBLE, LOGGED_LATE)
UNSEEN = ("begins_in_flight", "fused_multiply_add")
COLUMNS = (*OF_THE_COLUMNS, ANGLE_LOGGED_LATE, LATE_OUTPUT)
# What no firmware can do, so that the log holds it in wrong rows; and how to mend that.
AGAINST_TIME = {
    EARLY_OUTPUT: (
        "commands in rows before those of the angles that they answer",
        "the commands down, or the angles and references up",
    ),
    ANGLE_LOGGED_LATE: (
        "angles in rows behind those of the commands that answer them",
        "these angles up, or all other columns down",
    ),
}
NINE_DIGITS = "print nine digits, which hold all of a float32"
ANGLES_ROUNDED = f"the log holds its angles with few digits; with the whole counts that they stand for, every bit agrees: {NINE_DIGITS}"


@dataclass(frozen=True)
class Residual:
    """Log minus replay of one input: samples that differ, greatest difference in V and in units of the last place."""

    input: str
    samples_different: int
    max_V: float
    max_ulp: float


@dataclass(frozen=True)
class FirmwareReplay:
    """What running the firmware again showed.

    `cause` is the machine name ("stale_sample", "stale_sample + dropped_frame", "not_found"), None where nothing differs;
    `sentence` says it for a person; `alternatives` are other causes that these data cannot tell from it. `behind_missing` is a
    difference behind rows that the log lacks.
    """

    replayed: bool
    bit_exact: bool
    first_difference_s: float | None
    cause: str | None
    sentence: str | None
    residuals: tuple[Residual, ...] = ()
    incidents: tuple[tuple[str, float], ...] = ()
    alternatives: tuple[str, ...] = ()
    behind_missing: bool = False

    def record(self) -> Firmware:
        """The record of diagnosis.json."""
        told = (self.replayed, self.bit_exact, self.first_difference_s)
        if self.cause is None:
            return Firmware(*told, None, lies_in=self._lies_in(()))
        names, sentence = names_of(self.cause), self.sentence or ""
        return Firmware(*told, f"{self.cause}: {sentence}", names, self._lies_in(names), sentence)

    def _lies_in(self, names: tuple[str, ...]) -> LiesIn | None:
        if self.bit_exact or not self.replayed:
            return None
        if self.cause in CLEARED:
            return LiesIn.LOG
        if self.cause in UNSEEN or self.behind_missing:
            return LiesIn.UNSEEN
        if self.cause == NOT_FOUND:
            return LiesIn.UNEXPLAINED
        return LiesIn.COLUMNS if names[0] in COLUMNS else LiesIn.FIRMWARE


def demand_causal(path: Path, replay: FirmwareReplay) -> None:
    """Raise BadInput where the controller's own code gives the logged commands only in later rows: none answers what it has yet to read."""
    names = names_of(replay.cause or "")
    for name, (got, remedy) in AGAINST_TIME.items():
        if name in names:
            raise BadInput(
                "columns", str(path), f"{got}: {replay.sentence}", "columns in the rows of their time", f"move {remedy}"
            )


def replay_firmware(log: RunLog, table: ControllerTable, others: Sequence[ControllerTable] = ()) -> FirmwareReplay:
    """Run the generated law of `table` on the log's angles and references from rest, and explain any difference.

    `others` are further tables that may have flown. Raises BadInput when the log names a table that is not `table`, or `table`
    is one that no law can be made from.
    """
    demand_own(log, table)
    if not has_replayable_columns(log, table):
        sentence = "the log lacks a reference or an angle that the law takes"
        return FirmwareReplay(False, False, None, "not_replayable", sentence)
    flight = flight_of(log, table)
    run = replayed(flight, table)
    residuals = _residuals(flight, run)
    rows = np.flatnonzero(run.differs.any(axis=1))
    at_s = float(flight.t_s[rows[0]]) if rows.size else None
    if run.arithmetic == FIXED:
        return _in_fixed_point(flight, table, run, residuals)
    if at_s is None and not flight.missing:
        return _agreeing(flight, residuals)
    within_V = agrees_as_printed(flight, table)
    as_printed = None if within_V is None else Told(LOG_ROUNDING, _as_printed(flight, within_V))
    in_double = log.arithmetic == DOUBLE
    told = explain(flight, table, others, as_printed, FLOAT64 if in_double else FLOAT32)
    if told is None:
        behind_fixed = _behind_fixed(flight, table, residuals, at_s)
        if behind_fixed is not None:
            return behind_fixed
        return FirmwareReplay(
            True, False, at_s, NOT_FOUND, _unexplained(residuals, _hint(flight, table, run, int(rows[0]))), residuals
        )
    if told.cause is None and at_s is None:
        return _agreeing(flight, residuals)
    if told.cause is None and in_double:
        return FirmwareReplay(True, False, None, IN_DOUBLE, AGREES_IN_DOUBLE, residuals)
    if told.cause is None:
        return FirmwareReplay(True, False, at_s, LOG_ROUNDING, ANGLES_ROUNDED, residuals)
    return FirmwareReplay(True, False, at_s, told.cause, told.sentence, residuals, told.incidents, told.alternatives)


def _agreeing(flight: ReplayedLog, residuals: tuple[Residual, ...], said: str | None = None) -> FirmwareReplay:
    """A firmware that agrees in every bit of what the log holds of its commands."""
    unknown = flight.unknown
    if not unknown.any():
        return FirmwareReplay(True, True, None, None, said, residuals)
    rows, first_s = int(unknown.sum()), float(flight.t_s[np.argmax(unknown)])
    lacks = f"the log lacks what was sent in {rows} row{'s' if rows > 1 else ''}, first at {first_s:.6g} s"
    sentence = f"{said + '; ' if said else ''}{lacks}; in all others every bit agrees"
    return FirmwareReplay(True, False, None, INPUT_UNKNOWN, sentence, residuals)


def _as_printed(flight: ReplayedLog, within_V: float) -> str:
    few = " and ".join(dict.fromkeys(str(entry) for entry in flight.printings if not entry.is_exact))
    return (
        f"the log rounded its numbers ({few}); within what that does to its law's answers, {within_V:.2g} {flight.unit} at most, the "
        f"replay agrees: {NINE_DIGITS}"
    )


def demand_own(log: RunLog, table: ControllerTable) -> None:
    """Raise BadInput where the log names another table."""
    if log.table_digest is not None and log.table_digest != table.digest:
        raise BadInput(
            "controller table",
            "run log",
            f"table {table.digest[:16]}",
            f"table {log.table_digest[:16]}, which the log names",
            "give the table that flew",
        )


def _in_fixed_point(
    flight: ReplayedLog, table: ControllerTable, run: Replayed, residuals: tuple[Residual, ...]
) -> FirmwareReplay:
    """What is told of a log whose law computed in fixed point: the table's own firmware, what lies behind it, or no cause."""
    rows = np.flatnonzero(run.differs.any(axis=1))
    if not rows.size:
        return _agreeing(flight, residuals, IN_FIXED_POINT)
    at_s = float(flight.t_s[rows[0]])
    behind_it = _behind_words(flight, table, run, residuals, at_s)
    if behind_it is not None:
        return behind_it
    lacks: NDArray[np.bool_] = np.asarray(np.isnan(np.hstack([flight.reference_rad, flight.angle_rad])).any(axis=1))
    if lacks[: rows[0] + 1].any():
        since_s = float(flight.t_s[np.argmax(lacks)])
        sentence = (
            f"{IN_FIXED_POINT}, up to {since_s:.6g} s; behind what the log lacks there the law's state is not known"
        )
        return FirmwareReplay(True, False, at_s, MISSING_ROWS, sentence, residuals)
    misread = None if lacks.any() else misread_in_fixed(flight, table)
    if misread:
        sentence = (
            f"the firmware computes in fixed point; {other_readings(len(misread), float(flight.t_s[misread[0]]))}"
        )
        incidents = tuple((MISREAD, float(flight.t_s[row])) for row in misread)
        return FirmwareReplay(True, False, at_s, MISREAD, sentence, residuals, incidents)
    behind = any(flight.t_s[first] < at_s for first, _ in flight.missing)
    where = " behind rows that the log lacks" if behind else ""
    sentence = f"{IN_FIXED_POINT}, until {at_s:.2f} s{where}; in fixed point no other law is tried"
    return FirmwareReplay(True, False, at_s, NOT_FOUND, sentence, residuals, behind_missing=behind)


def _behind_fixed(
    flight: ReplayedLog, table: ControllerTable, residuals: tuple[Residual, ...], at_s: float | None
) -> FirmwareReplay | None:
    """A law in fixed point of whose words none is in the log, as something behind it changed them all."""
    try:
        run = replayed_in_fixed(flight, table)
    except BadInput:  # a table that no words can hold never flew in them
        return None
    behind_it = _behind_words(flight, table, run, residuals, at_s)
    return behind_it or _misread_words(flight, table, residuals, at_s)


def _misread_words(
    flight: ReplayedLog, table: ControllerTable, residuals: tuple[Residual, ...], at_s: float | None
) -> FirmwareReplay | None:
    """A law in fixed point that had other readings than the log holds, of which one changes all words behind it."""
    if np.isnan(np.hstack([flight.reference_rad, flight.angle_rad])).any():
        return None
    rows = misread_in_fixed(flight, table)
    if not rows:
        return None
    incidents = tuple((MISREAD, float(flight.t_s[row])) for row in rows)
    sentence = f"the firmware computes in fixed point; {other_readings(len(rows), incidents[0][1])}"
    return FirmwareReplay(True, False, at_s, MISREAD, sentence, residuals, incidents)


def _behind_words(
    flight: ReplayedLog, table: ControllerTable, run: Replayed, residuals: tuple[Residual, ...], at_s: float | None
) -> FirmwareReplay | None:
    behind_it = channel_cause(flight, table, run.u_V, run.word_V)
    if behind_it is None:
        return None
    sentence = f"the firmware computes in fixed point and {behind_it.sentence}"
    return FirmwareReplay(True, False, at_s, behind_it.name, sentence, residuals)


def _residuals(flight: ReplayedLog, run: Replayed) -> tuple[Residual, ...]:
    present = ~np.isnan(flight.logged_V).any(axis=1)
    result = []
    columns = (flight.logged_V[present].T, run.u_V[present].T, run.differs[present].T)
    for name, logged, own, differs in zip(flight.input_names, *columns, strict=True):
        error = logged - own
        ulp = np.abs(error) / np.spacing(np.abs(own).astype(np.float32)).astype(float)
        result.append(Residual(name, int(np.sum(differs)), float(np.abs(error).max()), float(ulp.max())))
    return tuple(result)


def _hint(flight: ReplayedLog, table: ControllerTable, run: Replayed, row: int) -> str:
    """What is striking about the first row that differs, or about the log's references."""
    if row > 0 and _meets_limit(table, run, row):
        return ", from where the law first meets a limit, or leaves it: is its anti-windup another?"
    digits = dict.fromkeys(str(entry) for entry in flight.reference_printings if not entry.is_exact)
    if digits:
        few = " and ".join(digits)
        return f"; the log holds its references with {few}: a law that was given more cannot be run again, so log all digits"
    return ", from the first row on: has the log lost its beginning, and with it the law's state?" if row == 0 else ""


def _meets_limit(table: ControllerTable, run: Replayed, row: int) -> bool:
    low = np.array([axis.u_min_V for axis in table.axes], np.float32)
    high = np.array([axis.u_max_V for axis in table.axes], np.float32)
    at_limit = np.any((run.u_V[: row + 1] <= low) | (run.u_V[: row + 1] >= high), axis=1)
    return bool(at_limit.any() and np.sum(~at_limit[np.argmax(at_limit) :]) <= BEHIND_LIMIT)


def _unexplained(residuals: Sequence[Residual], hint: str) -> str:
    different = max(entry.samples_different for entry in residuals)
    greatest = max(residuals, key=lambda entry: entry.max_V)
    size = f"up to {greatest.max_V:.3g} {units_of([greatest.input])} ({greatest.max_ulp:.3g} units of the last place)"
    rounding = (
        ", the size of rounding: another compiler, processor or order of operations"
        if greatest.max_V < ROUNDING_V
        else ""
    )
    samples = "1 sample differs" if different == 1 else f"{different} samples differ"
    return f"no other firmware that was tried gives all logged inputs; {samples}, {size}{rounding}{hint}"
