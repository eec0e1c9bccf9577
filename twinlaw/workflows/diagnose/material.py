"""What a diagnosis begins with: plant and logs read, the logs looked at, the controller's own code run on them again."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from diagnosis.diagnose import Material
from logcheck.breaks import unbroken
from logcheck.integrity import LogIntegrity, as_read, as_sent, demand, examine
from logcheck.stamps import from_their_start
from logcheck.stretches import stretches
from records.diagnosis import Firmware
from records.errors import BadInput
from records.log import RunLog, load_log
from records.plant import load_plant
from records.reasons import Note
from records.table import ControllerTable
from replay.firmware import INPUT_UNKNOWN, FirmwareReplay, demand_causal
from replay.table import replay_log, table_of, timed_by_table
from sim.added_effects import without_effects
from sim.bind import BoundPlant, bind
from sim.columns import log_columns
from sim.substeps import fastest_rad_s
from toolchain.memory import keep_freed_memory
from twinlaw.pages.diagnose.firmware import KIND


def read_material(plant: Path, logs: Sequence[Path], holdout: Sequence[Path]) -> tuple[BoundPlant, Material]:
    """What a diagnosis begins with; raises BadInput where plant or logs cannot be used."""
    keep_freed_memory()
    bound = bind(load_plant(plant))
    return bound, material_of(bound, logs, holdout)


def material_of(bound: BoundPlant, logs: Sequence[Path], holdout: Sequence[Path]) -> Material:
    """The same of a plant that is loaded; raises BadInput where the logs cannot be used."""
    return _material(without_effects(bound), logs, holdout)


def _material(bound: BoundPlant, logs: Sequence[Path], holdout: Sequence[Path]) -> Material:
    columns = log_columns(bound.model)
    read = [timed_by_table(load_log(path, columns), path) for path in (*logs, *holdout)]
    split = len(logs)
    names = [path.stem for path in (*logs, *holdout)]
    if len(set(names[split:])) != len(names[split:]):
        raise BadInput("hold-out logs", "--holdout", "two of one name", "names that differ", "rename one")
    integrity = examine(read[:split], bound, holdout=read[split:], names=names)
    demand(integrity)
    paths = (*logs, *holdout)
    replays = [_replayed(*entry) for entry in zip(read, paths, integrity.logs, strict=True)]
    for path, replay in zip(paths, replays, strict=True):
        if replay is not None:
            demand_causal(path, replay)
    firmware, told = _firmware(paths, replays)
    timed, counted = from_their_start([as_read(*entry) for entry in zip(read, integrity.logs, strict=True)], names)
    used, begins = [~entry.excluded for entry in integrity.logs], [entry.begins for entry in integrity.logs]
    whole = unbroken(timed[:split], used[:split], begins[:split], names[:split])
    checked = unbroken(timed[split:], used[split:], begins[split:], names[split:])
    rate_rad_s = fastest_rad_s(bound, np.zeros(len(bound.model.states)))
    parts = stretches(whole.logs, whole.used, whole.names, rate_rad_s)
    flown = [_flown(*entry) for entry in zip(read[split:], holdout, replays[split:], strict=True)]
    tables = dict(zip(names[split:], flown, strict=True))
    return Material(
        logs=parts.logs,
        names=parts.names,
        holdout=checked.logs,
        holdout_names=checked.of,
        used=[*parts.used, *checked.used],
        firmware=firmware,
        notes=(*integrity.notes, *told, *counted, *whole.notes, *checked.notes, *parts.notes),
        tables=[tables.get(name) for name in checked.names],  # behind a break nobody knows the law's state
    )


def _replayed(log: RunLog, path: Path, looked: LogIntegrity) -> FirmwareReplay | None:
    """The firmware run again on what it was given: all that was logged or, where that is not it, what was read."""
    whole = replay_log(as_sent(log, looked), path, begins=looked.begins)
    if whole is None or whole.bit_exact or not looked.unread.any() or whole.cause == INPUT_UNKNOWN:
        return whole
    read = replay_log(as_sent(as_read(log, looked), looked), path, begins=looked.begins)
    return whole if read is not None and read.record().differs else read


def _flown(log: RunLog, path: Path, replay: FirmwareReplay | None) -> ControllerTable | None:
    """The table whose law flew a hold-out log; None where another firmware did: its error in the closed loop is not the model's."""
    own = table_of(log, path)
    return None if replay is not None and replay.record().differs else own


def _firmware(
    paths: Sequence[Path], replays: Sequence[FirmwareReplay | None]
) -> tuple[Firmware | None, tuple[Note, ...]]:
    """What running the controller's code again shows, of the first log where it differs, and a note for every log that it tells of."""
    found = [(path.name, replay) for path, replay in zip(paths, replays, strict=True) if replay is not None]
    if not found:
        return None, ()
    worst = min((replay for _, replay in found), key=lambda replay: (replay.bit_exact, replay.replayed))
    return worst.record(), tuple(
        Note(KIND, name, {}, f"{name}: {replay.sentence}") for name, replay in found if replay.sentence
    )
