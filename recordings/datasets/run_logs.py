"""Recordings that are run logs already: RECORD.csv with RECORD.toml beside it, in SI units."""

import tomllib
from collections.abc import Sequence

from recordings.datasets.recording import Load, Recording, gap_notes
from recordings.datasets.texts import cells, column


def read_run_log(record: str, load: Load, names: Sequence[str], notes: Sequence[str]) -> Recording:
    """The run in RECORD.csv, its columns `names`; raises BadInput for a column that is missing and a cell that is no number."""
    file = f"{record}.csv"
    sidecar = tomllib.loads(load(f"{record}.toml").decode())
    header, rows = cells(load(file), ",", file)
    t_s, period_s = column(header, rows, "t_s", file), float(sidecar["sample_period_s"])
    return Recording(
        t_s=t_s,
        columns={name: column(header, rows, name, file) for name in names},
        sample_period_s=period_s,
        loop=sidecar["loop"],
        notes=(*notes, *gap_notes(t_s, period_s)),
    )
