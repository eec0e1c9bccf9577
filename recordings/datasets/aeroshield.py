"""AeroShield: text and MATLAB files without a time column; RMS volts and radians.

Two rates: the rig's later runs are sampled every 10 ms, the two oldest (Identification_Data, Validation_Data) every 15 ms, as the
repository's identification script says; their free swings agree with the later ones only so.
"""

from collections.abc import Mapping

import numpy as np

from recordings.datasets.matlab import array, variables
from recordings.datasets.recording import Array, Load, Recording, limit_notes, missing_notes
from recordings.datasets.texts import cells, number, texts

DRIVE_LIMIT_V = 3.7
_MATLAB: Mapping[str, tuple[str, str, float]] = {  # angle, voltage, sample period
    "Identification_Data": ("yrad", "u", 0.015),
    "Validation_Data": ("yradval", "uval", 0.015),
    "Identification_Data2": ("yrad", "u", 0.01),
    "Validation_Data2": ("yradval", "uval", 0.01),
}
_OPEN_TEXT: Mapping[str, int] = {"ident_data": 5, "val_data": 5}  # decimals that the logger printed
_CLOSED_TEXT: Mapping[str, int] = {"LQ_mega": 3, "EMPC_due": 3, "EMPC_mega_N5": 3, "EMPC_uno": 3}

RECORDS = (*_OPEN_TEXT, *_MATLAB, *_CLOSED_TEXT)


def read(record: str, load: Load) -> Recording:
    """A run of the AeroShield; times are counted from the sample period, as no file holds any."""
    columns, sample_period_s, notes = _matlab(record, load) if record in _MATLAB else _text(record, load)
    t_s = np.arange(columns["u_V"].size, dtype=np.float64) * np.float64(sample_period_s)
    return Recording(
        t_s=t_s,
        columns=columns,
        sample_period_s=sample_period_s,
        loop="closed" if record in _CLOSED_TEXT else "open",
        notes=(
            f"no time was recorded: rows are {sample_period_s * 1e3:g} ms apart by the rig's program",
            "u_V is an RMS voltage; the board gives the duty (u_V / 3.7 V)^2 in steps of 1/255",
            *notes,
            *limit_notes("u_V", columns["u_V"], -np.inf, DRIVE_LIMIT_V),
        ),
    )


def _matlab(record: str, load: Load) -> tuple[dict[str, Array], float, tuple[str, ...]]:
    file = f"{record}.mat"
    angle, voltage, sample_period_s = _MATLAB[record]
    found = variables(load(file), file)
    return {"u_V": array(found, voltage, file), "theta_rad": array(found, angle, file)}, sample_period_s, ()


def _text(record: str, load: Load) -> tuple[dict[str, Array], float, tuple[str, ...]]:
    """Columns y, u of an open loop, r, y, u of a closed one. A reference that lost a character on its way is NaN."""
    file = f"{record}.txt"
    decimals = {**_OPEN_TEXT, **_CLOSED_TEXT}[record]
    header, rows = cells(load(file).replace(b",", b" "), None, file)
    names = {"u_V": "u", "theta_rad": "y", **({"theta_ref_rad": "r"} if "r" in header else {})}
    columns = {name: _printed(texts(header, rows, key, file), decimals, file) for name, key in names.items()}
    notes = [f"numbers are rounded to {decimals} decimals"]
    for name, values in columns.items():
        notes += missing_notes(name, values)
    return columns, 0.01, tuple(notes)


def _printed(column: list[str], decimals: int, file: str) -> Array:
    """Numbers that the logger printed with a fixed count of decimals: fewer mean that the serial line lost a character."""
    whole = [len(text.rpartition(".")[2]) == decimals for text in column]
    numbers = [number(text, file, line) for line, text in enumerate(column, start=2)]
    return np.where(whole, numbers, np.nan)
