"""All recordings by dataset and name, as run logs."""

import re
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from recordings.datasets import (
    aeroshield,
    aeroshield_two_clocks,
    antx_2dof_drone,
    emps,
    maglev_coil,
    pamh_aeropendulum,
    quanser_aero,
    torque_limited_pendulum,
)
from recordings.datasets.files import verified_bytes
from recordings.datasets.recording import Importer, Recording
from recordings.datasets.registry import Dataset, dataset
from records.errors import BadInput
from records.log import RunLog
from records.logs.source import Source
from sim.columns import log_columns
from sim.plants import MODELS

IMPORTERS: Mapping[str, Importer] = {
    "quanser_aero": quanser_aero,
    "aeroshield": aeroshield,
    "antx_2dof_drone": antx_2dof_drone,
    "emps": emps,
    "pamh_aeropendulum": pamh_aeropendulum,
    "aeroshield_two_clocks": aeroshield_two_clocks,
    "maglev_coil": maglev_coil,
    "torque_limited_pendulum": torque_limited_pendulum,
}


def records(name: str) -> tuple[str, ...]:
    """The records of the dataset called `name`; raises BadInput for an unknown one."""
    return IMPORTERS[dataset(name).name].RECORDS


def import_record(name: str, record: str, folder: Path | None = None) -> RunLog:
    """The record of a dataset as a run log of the plant of the same name, SI units, true times.

    `record` is a name of `records(name)`, its file's path, or a beginning that only one record has. `folder` holds one folder per
    dataset (default: TWINLAW_DATASETS, else ../shared/datasets of the checkout). Raises BadInput for an unknown dataset or record,
    a missing file, or one whose SHA-256 is not the published one.
    """
    source = dataset(name)
    known = _resolve(source, record)
    recording = IMPORTERS[name].read(known, lambda file: verified_bytes(source, file, folder))
    return _log(source, known, recording)


def _resolve(source: Dataset, record: str) -> str:
    """The one record that is meant: by its whole name, its path, or its beginning; signs between letters do not count."""
    names = IMPORTERS[source.name].RECORDS
    plain = {known: _letters(known) for known in names}
    stem = re.sub(r"\.(mat|txt|csv)$", "", record)
    for wanted in (_letters(stem), _letters(stem.rsplit("/", 1)[-1])):
        same = [known for known in names if plain[known] == wanted]
        alike = same or [known for known in names if wanted and plain[known].startswith(wanted)]
        if len(alike) == 1:
            return alike[0]
    raise BadInput(
        "record", f"dataset {source.name}", repr(record), f"one of {', '.join(names)}", "choose one of these"
    )


def _letters(name: str) -> str:
    return re.sub(r"[^a-z0-9]", "", name.lower())


def _log(source: Dataset, record: str, recording: Recording) -> RunLog:
    columns = log_columns(MODELS[source.name]())
    return RunLog(
        columns=columns,
        sample_period_s=recording.sample_period_s,
        loop=recording.loop,
        t_s=recording.t_s,
        u=np.column_stack([recording.columns[name] for name in columns.inputs]),
        y=np.column_stack([recording.columns[name] for name in columns.outputs]),
        extra={name: recording.columns[name] for name in columns.optional if name in recording.columns},
        locked=recording.locked,
        source=Source(
            dataset=source.name,
            record=record,
            repository=source.repository,
            commit=source.commit,
            licence=source.licence,
            simulated=recording.simulated,
            notes=recording.notes,
        ),
    )
