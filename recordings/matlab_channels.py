"""MATLAB's .mat files (up to version 7): vectors that are named like the columns of a run log, beside their times `t_s`."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from scipy.io import loadmat
from scipy.io.matlab import MatReadError

from recordings.channels import Channel
from records.errors import BadInput

TIME_NAME = "t_s"


def read_matlab(path: Path, time_name: str = TIME_NAME) -> tuple[dict[str, Channel], dict[str, str]]:
    """Channels on the common clock `time_name` [s], and texts (loop, table_digest) by name; a struct's fields count as its own.

    Raises BadInput for a file that is missing or no .mat, for version 7.3 (HDF5), for times that are missing, and for a
    vector of another length.
    """
    content = _flat(_load(path))
    numbers = {name: _vector(value) for name, value in content.items() if _is_numeric(value)}
    texts = {name: str(value) for name, value in content.items() if isinstance(value, str)}
    vectors = {name: values for name, values in numbers.items() if values.size > 1}
    if time_name not in vectors:
        there = ", ".join(vectors)[:300] or "no vector at all"
        remedy = "save the times in s under that name, or name them with --column t_s=NAME"
        raise BadInput(f"variable {time_name!r}", str(path), there, "the times of the samples", remedy)
    t_s = vectors.pop(time_name)
    for name, values in vectors.items():
        if values.shape != t_s.shape:
            got = f"{values.size} values at {t_s.size} times"
            raise BadInput(
                f"variable {name!r}", str(path), got, "one value at each time", "save one run, whole vectors"
            )
    return {name: Channel(t_s, values) for name, values in vectors.items()}, texts


def _load(path: Path) -> dict[str, Any]:
    try:
        with path.open("rb") as stream:
            return dict(loadmat(stream, simplify_cells=True))
    except OSError as error:
        raise BadInput(
            "MATLAB file", str(path), error.strerror or str(error), "a readable file", "check the path"
        ) from error
    except NotImplementedError as error:
        raise BadInput(
            "MATLAB file", str(path), "version 7.3 (HDF5)", "version 7 or older", "save it with -v7 in MATLAB"
        ) from error
    except (MatReadError, ValueError, TypeError, EOFError, KeyError, IndexError, MemoryError, ArithmeticError) as error:
        raise BadInput(
            "MATLAB file", str(path), f"no whole .mat file ({error})", "a .mat file", "save it again with -v7"
        ) from error


def _flat(content: Mapping[str, Any]) -> dict[str, Any]:
    """Variables by name, the fields of a struct in place of it."""
    flat: dict[str, Any] = {}
    for name, value in content.items():
        if isinstance(value, dict):
            flat.update(value)
        elif not name.startswith("__"):
            flat[name] = value
    return flat


def _is_numeric(value: Any) -> bool:
    return np.asarray(value).dtype.kind in "biuf"


def _vector(value: Any) -> np.ndarray:
    return np.asarray(value, dtype=float).squeeze().reshape(-1)
