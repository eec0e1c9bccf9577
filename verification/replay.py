"""A recorded run as a stimulus for every execution of the law, and the law's answer against what the log says was sent."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from codegen.fixed.formats import law_formats
from records.errors import BadInput
from records.log import RunLog
from records.loops import Loop
from records.table import ControllerTable
from records.verification import Equality
from verification.equality import BatchStepper, first_output
from verification.fixed_stimuli import words_from_floats
from verification.stimuli import Stimulus

Array = NDArray[np.float64]
Bits = NDArray[np.uint32]

# Measured angles, whatever the rig calls them: elevation (pitch) first, azimuth (yaw) second.
ANGLES = (("psi_rad", "phi_rad"), ("theta_rad", "psi_rad"))


@dataclass(frozen=True)
class Replay:
    """A log's references and angles, and the inputs [n, loops] that it says `table` sent, all as the arithmetic's words.

    `sent` is None where another law, or none, flew.
    """

    stimulus: Stimulus
    sent: Bits | None
    loops: tuple[Loop, ...]


def replay_of(log: RunLog, table: ControllerTable, path: Path, arithmetic: str = "float32") -> Replay:
    """The log at `path` as a replay in an arithmetic; a log without references is replayed with references at zero.

    Raises BadInput when it names another controller table, or has not the measured angles of its loops.
    """
    if log.table_digest is not None and log.table_digest != table.digest:
        raise BadInput(
            "run log",
            str(path),
            f"a flight of table {log.table_digest[:16]}",
            f"one of table {table.digest[:16]}",
            "give the table that flew with --table, or a log of this table",
        )
    angles = _angles(log, path, table)
    names = [loop.reference for loop in table.loops]
    references = [log.extra.get(name, np.zeros(len(log.t_s))) for name in names]
    is_own = log.table_digest is not None and set(names) <= log.extra.keys()
    inputs, sent = _as_words(np.stack([*references, *angles], axis=-1), log.u, table, arithmetic)
    stimulus = Stimulus(path.name, inputs[:1, len(names) :].copy(), inputs[:, np.newaxis].copy())
    return Replay(stimulus, sent if is_own else None, table.loops)


def replayed_equality(replay: Replay, law: BatchStepper) -> Equality | None:
    """Rows of the log whose inputs are not, bit for bit, what `law` sends from rest at the first row; None without such inputs."""
    if replay.sent is None:
        return None
    _, outputs = law.run(law.start(replay.stimulus.angles), replay.stimulus.inputs)
    sent = replay.sent[:, np.newaxis]
    unequal: NDArray[np.bool_] = np.not_equal(sent, outputs)
    mismatches = int(unequal.any(axis=(1, 2)).sum())
    first = first_output(replay.stimulus, unequal, (sent, outputs), replay.loops) if mismatches else None
    return Equality(("log", law.name), law.arithmetic, len(unequal), mismatches, first)


def _as_words(angles_rad: Array, u_V: Array, table: ControllerTable, arithmetic: str) -> tuple[Bits, Bits]:
    if arithmetic == "float32":
        as_floats = (np.ascontiguousarray(values, np.float32).view(np.uint32) for values in (angles_rad, u_V))
        inputs, sent = as_floats
        return inputs, sent
    formats = law_formats(table)
    return words_from_floats(angles_rad, formats.angle_places), words_from_floats(u_V, formats.voltage_places)


def _angles(log: RunLog, path: Path, table: ControllerTable) -> list[Array]:
    own = tuple(loop.output for loop in table.loops)
    known = (own, *(names for names in ANGLES if len(names) == len(own) and names != own))
    for names in known:
        if set(names) <= set(log.columns.outputs):
            return [log.column(name) for name in names]
    expected = " or ".join(" and ".join(names) for names in known)
    remedy = "replay a log of the angles that the table's loops measure"
    raise BadInput("run log", str(path), f"columns {', '.join(log.columns.outputs)}", expected, remedy)
