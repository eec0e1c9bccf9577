"""The controller's own code run again on a log: bit-exact, or the first difference and its cause.

    r_k = u_k - C(y_0..y_k, r_0..r_k)

with C the generated law, compiled for this computer. Where r is not zero in every bit, other firmwares are run as code until one
leaves nothing (firmware_replay_search.py). One that leaves anything is no cause: then it says that none was found.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from codegen.law import generate_law
from diagnosis.firmware_replay_flight import Flight, flight_of, has_replayable_columns
from diagnosis.firmware_replay_search import LOG_ROUNDING, explain
from records.diagnosis import Firmware
from records.errors import BadInput
from records.log import RunLog
from records.table import ControllerTable
from verification.host_law import HostLaw

Array = NDArray[np.float64]

NOT_FOUND = "not_found"
ROUNDING_V = 1e-3
ANGLES_ROUNDED = "the log holds its angles with few digits; with the whole counts that they stand for, every bit agrees"


@dataclass(frozen=True)
class Residual:
    """Log minus replay of one input: samples that differ, greatest and rms difference in V and greatest in units of the last place."""

    input: str
    samples_different: int
    max_V: float
    rms_V: float
    max_ulp: float


@dataclass(frozen=True)
class FirmwareReplay:
    """What running the firmware again showed.

    `cause` is the machine name ("stale_sample", "stale_sample + dropped_frame", "not_found"), None where nothing differs;
    `sentence` says it for a person; `alternatives` are other causes that these data cannot tell from it.
    """

    replayed: bool
    bit_exact: bool
    first_difference_s: float | None
    cause: str | None
    sentence: str | None
    residuals: tuple[Residual, ...] = ()
    incidents: tuple[tuple[str, float], ...] = ()
    alternatives: tuple[str, ...] = ()

    def record(self) -> Firmware:
        """The record of diagnosis.json."""
        cause = None if self.cause is None else f"{self.cause}: {self.sentence}"
        return Firmware(self.replayed, self.bit_exact, self.first_difference_s, cause)


def replay_firmware(log: RunLog, table: ControllerTable, others: Sequence[ControllerTable] = ()) -> FirmwareReplay:
    """Run the generated law of `table` on the log's angles and references from rest, and explain any difference.

    `others` are further tables that may have flown. Raises BadInput when the log names a table that is not `table`, or `table`
    is one that no law can be made from.
    """
    _demand_own(log, table)
    if not has_replayable_columns(log):
        sentence = "the log lacks a reference or an angle that the law takes"
        return FirmwareReplay(False, False, None, "not_replayable", sentence)
    flight = flight_of(log, table)
    replayed_V = _replayed(flight, table)
    residuals = _residuals(log, flight, replayed_V)
    first = _first_difference(flight, replayed_V)
    if first is None and not flight.missing:
        return FirmwareReplay(True, True, None, None, None, residuals)
    at_s = None if first is None else float(flight.t_s[first])
    told = explain(flight, table, others)
    if told is None:
        return FirmwareReplay(True, False, at_s, NOT_FOUND, _unexplained(residuals), residuals)
    if told.cause is None and at_s is None:
        return FirmwareReplay(True, True, None, None, None, residuals)
    if told.cause is None:
        return FirmwareReplay(True, False, at_s, LOG_ROUNDING, ANGLES_ROUNDED, residuals)
    return FirmwareReplay(True, False, at_s, told.cause, told.sentence, residuals, told.incidents, told.alternatives)


def _demand_own(log: RunLog, table: ControllerTable) -> None:
    if log.table_digest is not None and log.table_digest != table.digest:
        raise BadInput(
            "controller table",
            "run log",
            f"table {table.digest[:16]}",
            f"table {log.table_digest[:16]}, which the log names",
            "give the table that flew",
        )


def _replayed(flight: Flight, table: ControllerTable) -> Array:
    """The generated C on the log: u (n, 2) in V."""
    host = HostLaw(generate_law(table))
    inputs = np.hstack([flight.reference_rad, flight.angle_rad]).astype(np.float32)[:, np.newaxis].view(np.uint32)
    _, outputs = host.run(host.start(np.ascontiguousarray(inputs[0, :, 2:])), np.ascontiguousarray(inputs))
    return outputs[:, 0].view(np.float32).astype(float)


def _first_difference(flight: Flight, replayed_V: Array) -> int | None:
    """The first sample whose logged input is another float32 than the replayed one."""
    differs = (flight.logged_V.astype(np.float32) != replayed_V.astype(np.float32)) & ~np.isnan(flight.logged_V)
    rows = np.flatnonzero(differs.any(axis=1))
    return int(rows[0]) if rows.size else None


def _residuals(log: RunLog, flight: Flight, replayed_V: Array) -> tuple[Residual, ...]:
    present = ~np.isnan(flight.logged_V[:, 0])
    result = []
    for name, logged, own in zip(log.columns.inputs, flight.logged_V[present].T, replayed_V[present].T, strict=True):
        error = logged - own
        ulp = np.abs(error) / np.spacing(np.abs(own).astype(np.float32)).astype(float)
        different = int(np.sum(logged.astype(np.float32) != own.astype(np.float32)))
        rms_V = float(np.sqrt(np.mean(error**2)))
        result.append(Residual(name, different, float(np.abs(error).max()), rms_V, float(ulp.max())))
    return tuple(result)


def _unexplained(residuals: Sequence[Residual]) -> str:
    different = max(entry.samples_different for entry in residuals)
    greatest = max(residuals, key=lambda entry: entry.max_V)
    size = f"up to {greatest.max_V:.3g} V ({greatest.max_ulp:.3g} units of the last place)"
    hint = (
        ", the size of rounding: another compiler, processor or order of operations"
        if greatest.max_V < ROUNDING_V
        else ""
    )
    return f"none of the firmwares that were tried leaves no difference; {different} samples differ, {size}{hint}"
