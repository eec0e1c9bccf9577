"""Records of arrays as what JSON can hold, and back by their declared types, to the last bit."""

import base64
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import Any, get_args, get_origin, get_type_hints

import numpy as np

from jobs.job import Answer

_DOUBLE = np.dtype("<f8")


def plain(value: Any) -> Answer:
    """A dataclass, mapping, tuple, list, array of doubles, number or text, of whatever depth; raises TypeError for anything else."""
    if value is None or isinstance(value, bool | int | float | str):
        return value
    if isinstance(value, np.ndarray) and value.dtype == np.float64:
        content = base64.b64encode(np.ascontiguousarray(value, _DOUBLE).tobytes()).decode("ascii")
        return {"shape": list(value.shape), "base64": content}
    if isinstance(value, tuple | list):
        return [plain(entry) for entry in value]
    if isinstance(value, Mapping):
        return {str(key): plain(entry) for key, entry in value.items()}
    if is_dataclass(value) and not isinstance(value, type):
        return {entry.name: plain(getattr(value, entry.name)) for entry in fields(value)}
    raise TypeError(f"an answer holds {type(value).__name__}, which has no plain form")


def typed(kind: Any, content: Answer) -> Any:
    """What `plain` made `content` of, a value of the type `kind`: float, Array, tuple[X, ...], Mapping[str, X], a dataclass of these."""
    origin, inside = get_origin(kind), get_args(kind)
    if origin is np.ndarray:
        return np.frombuffer(base64.b64decode(content["base64"]), _DOUBLE).reshape(content["shape"]).copy()
    if origin is tuple:
        return tuple(typed(inside[0], entry) for entry in content)
    if origin is not None and issubclass(origin, Mapping):
        return {key: typed(inside[1], entry) for key, entry in content.items()}
    if is_dataclass(kind):
        hints = get_type_hints(kind)
        return kind(**{name: typed(hints[name], entry) for name, entry in content.items()})  # type: ignore[operator]
    return content
