"""Variables of a MATLAB file as plain arrays."""

import io
from collections.abc import Mapping
from typing import Any

import numpy as np
import scipy.io
from numpy.typing import NDArray

from records.errors import BadInput

Array = NDArray[np.float64]


def variables(content: bytes, where: str) -> Mapping[str, Any]:
    """Variables by name; a struct reads as an object with its fields. Raises BadInput when the content is no MATLAB file."""
    try:
        return dict(scipy.io.loadmat(io.BytesIO(content), squeeze_me=True, struct_as_record=False))
    except (ValueError, TypeError, NotImplementedError, OSError) as error:
        raise BadInput("recording", where, f"no MATLAB file ({error})", "a MATLAB 5 file", "fetch it again") from error


def array(found: Mapping[str, Any], name: str, where: str) -> Array:
    """The variable `name` as floats in the shape that it has; raises BadInput when it is not there or holds no numbers."""
    try:
        return np.asarray(found[name], dtype=float)
    except (KeyError, TypeError, ValueError) as error:
        raise BadInput(f"variable {name!r}", where, "none of numbers", "an array", "fetch the file again") from error


def stream(found: Mapping[str, Any], name: str, where: str) -> tuple[Array, Array]:
    """Time stamps (n,) and values (n,) of a struct with the fields `timestamp` and `value`; raises BadInput where it has them not."""
    try:
        struct = found[name]
        return np.atleast_1d(np.asarray(struct.timestamp, float)), np.atleast_1d(np.asarray(struct.value, float))
    except (KeyError, AttributeError, TypeError, ValueError) as error:
        raise BadInput(f"struct {name!r}", where, "none", ".timestamp and .value", "fetch the file again") from error
