"""The run that files of other tools hold in tests, and how it is saved."""

from pathlib import Path
from typing import Any

import numpy as np
from scipy.io import savemat

from recordings.mapping.mapping import ColumnMapping
from sim.columns import log_columns
from sim.plants import MODELS

CE150 = log_columns(MODELS["ce150"]())
T_S = np.arange(50) * 0.01
RUN = {
    "t_s": T_S,
    "u_M_V": 5.0 + T_S,
    "u_T_V": np.full(50, 1.8),
    "psi_rad": np.sin(T_S),
    "phi_rad": np.cos(T_S),
}


def save_run(path: Path, **changes: Any) -> Path:
    savemat(path, {name: value for name, value in {**RUN, **changes}.items() if value is not None})
    return path


def mapped(**columns: str) -> ColumnMapping:
    return ColumnMapping(columns=columns)


FOUR = {"u_M_V": "u_M_V", "u_T_V": "u_T_V", "psi_rad": "psi_rad", "phi_rad": "phi_rad"}
