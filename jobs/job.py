"""A job: a function by its name, a record that holds all its answer depends on, and the key under which the answer is kept."""

import hashlib
import struct
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields, is_dataclass
from typing import Any

import numpy as np

Answer = Any  # what JSON can hold: str, int, float, bool, None, lists and mappings of these


@dataclass(frozen=True, eq=False)
class Job:
    """`function(record)`, called `name` where a person reads of it.

    `function` is a module's own, found by its name in another process; `record` is plain data (see `canonical`) with its own seed
    where there is chance, so that neither order nor company changes the answer, which is what JSON can hold.
    """

    name: str
    function: Callable[[Any], Answer]
    record: Any

    def key(self, code: str) -> str:
        """A hash of function, record and `code`, the digest of what it is computed by (jobs.code)."""
        told = f"{self.function.__module__}:{self.function.__qualname__}\0{code}\0"
        return hashlib.sha256(told.encode() + canonical(self.record)).hexdigest()[:32]


@dataclass(frozen=True, eq=False)
class Done:
    """One job's end: its answer, or in `failure` the sentence why there is none; the seconds that it took, 0 if it was kept before."""

    name: str
    answer: Answer
    failure: str | None
    time_s: float
    kept: bool = False


def canonical(value: Any) -> bytes:
    """The bytes of plain data, other for other data: None, bool, int, float, str, bytes, arrays of numbers; tuples, lists, mappings,
    dataclasses of these.

    Raises TypeError for anything else, since what cannot be told apart must not share an answer.
    """
    if value is None or isinstance(value, bool | int):
        return _framed(type(value).__name__, repr(value).encode())
    if isinstance(value, float):
        return _framed("float", struct.pack("<d", value))
    if isinstance(value, str):
        return _framed("str", value.encode())
    if isinstance(value, bytes):
        return _framed("bytes", value)
    if isinstance(value, np.ndarray) and value.dtype.kind in "biuf":
        return _framed(f"array {value.dtype.str} {value.shape}", value.tobytes())
    if isinstance(value, tuple | list):
        return _framed("list", b"".join(map(canonical, value)))
    if isinstance(value, Mapping):
        pairs = sorted((canonical(key), canonical(entry)) for key, entry in value.items())
        return _framed("mapping", b"".join(key + entry for key, entry in pairs))
    if is_dataclass(value) and not isinstance(value, type):
        inside = {entry.name: getattr(value, entry.name) for entry in fields(value)}
        return _framed(type(value).__qualname__, canonical(inside))
    raise TypeError(f"a job's record holds {type(value).__name__}, which is no plain data")


def _framed(kind: str, content: bytes) -> bytes:
    return f"{kind} {len(content)} ".encode() + content
