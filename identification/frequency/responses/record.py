"""A run log as evenly spaced readings, in the form from which spectra are made."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from records.errors import BadInput
from records.log import RunLog
from sim.columns import reference_name

Array = NDArray[np.float64]
MOVED = 1e-9  # a signal whose range is below that is constant


@dataclass(frozen=True, eq=False)
class Record:
    """Inputs u (n, inputs), held from one row to the next, outputs y (n, outputs), and what was swept, r (n, inputs).

    In an open loop r is u. In a closed one noise comes back through u, and r are the references, which it does not reach, of all outputs
    until `with_instruments` has chosen. `loop` is "open" or "closed", `bridged` the share of samples of each output that was measured of
    which nothing was read.
    """

    name: str
    period_s: float
    u: Array
    y: Array
    r: Array
    loop: str = "open"
    bridged: Mapping[str, float] = field(default_factory=dict)

    @property
    def duration_s(self) -> float:
        """From the first row to the end of the last one's hold."""
        return self.period_s * float(self.u.shape[0])


def record_of(log: RunLog, name: str, outputs: Sequence[str]) -> Record:
    """A log's readings of `outputs` on an even grid: lines between readings (also across NaN), inputs and references held.

    Raises BadInput for a log without two readings of an output.
    """
    count = round(float(log.t_s[-1] - log.t_s[0]) / log.sample_period_s) + 1
    grid_s = log.t_s[0] + log.sample_period_s * np.arange(count)
    held = np.clip(np.searchsorted(log.t_s, grid_s + 0.5 * log.sample_period_s) - 1, 0, log.t_s.size - 1)
    y = np.column_stack([_line(log, output, grid_s, name) for output in outputs])
    references = [reference_name(output) for output in log.columns.outputs]
    r = log.u
    if log.loop == "closed" and sum(name in log.extra for name in references) >= log.u.shape[1] > 0:
        r = np.column_stack([_held(log.extra.get(name, np.zeros(log.t_s.size))) for name in references])
    u = log.u[held]
    bridged = {output: max(0.0, 1.0 - np.isfinite(log.column(output)).sum() / count) for output in outputs}
    return Record(name, log.sample_period_s, u, y, u if r is log.u else r[held], log.loop, bridged)


def _held(values: Array) -> Array:
    """Where a number is missing the one before it, at the beginning the first; 0 where there is none at all."""
    good = np.flatnonzero(np.isfinite(values))
    if not good.size:
        return np.zeros(values.size)
    return np.asarray(values[good[np.clip(np.searchsorted(good, np.arange(values.size), "right") - 1, 0, None)]])


def _line(log: RunLog, output: str, grid_s: Array, name: str) -> Array:
    values = log.column(output)
    good = np.isfinite(values)
    if good.sum() < 2:
        raise BadInput(f"column {output!r}", name, f"{int(good.sum())} readings", "a record of it", "give another log")
    return np.asarray(np.interp(grid_s, log.t_s[good], values[good]))


def with_instruments(records: Sequence[Record]) -> tuple[Record, ...]:
    """The records with as many references that move as there are inputs, or where none of a closed loop moves at all, with u for r: the
    sweep was on the inputs. The loops need not be those of the first outputs: of a cart behind a belt it is the cart's reference.

    Raises BadInput where some references move and others do not: then the loop hides what the input of the others does.
    """
    closed = [record for record in records if record.r is not record.u]
    moves = np.max([np.ptp(record.r, axis=0) for record in closed], axis=0) > MOVED if closed else np.zeros(0, bool)
    if not np.any(moves):
        return tuple(replace(entry, r=entry.u) for entry in records)
    count = records[0].u.shape[1]
    if np.sum(moves) < count:
        got = f"reference {int(np.flatnonzero(~moves)[0]) + 1} of {moves.size} moves in none of them"
        names = ", ".join(record.name for record in records)
        raise BadInput("references", names, got, "each swept on its own", "add a record in which it is swept")
    chosen = np.flatnonzero(moves)[:count]
    return tuple(entry if entry.r is entry.u else replace(entry, r=entry.r[:, chosen]) for entry in records)
