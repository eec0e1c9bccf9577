"""Truth: a record that went through JSON is the record that set out, arrays to the last bit."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, fields

import numpy as np
import pytest
from numpy.typing import NDArray

from jobs.plain import plain, typed

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Part:
    """What a record holds of its own kind."""

    name: str
    count: int
    size: float


@dataclass(frozen=True, eq=False)
class Whole:
    """Every kind of field that has a plain form."""

    part: Part
    parts: tuple[Part, ...]
    by_name: Mapping[str, Array]
    lists: Mapping[str, tuple[float, ...]]
    matrix: Array
    empty: Array


def test_a_record_comes_back_to_the_last_bit() -> None:
    odd = np.array([[np.nan, -0.0, np.inf], [5e-324, 0.1 + 0.2, -1.0 / 3.0]])
    part = Part("a", 3, 0.1 + 0.2)
    whole = Whole(part, (part, Part("b", -1, -0.0)), {"x": odd.T}, {"y": (1.0, 2.5)}, odd, np.zeros((0, 4)))
    back = typed(Whole, json.loads(json.dumps(plain(whole))))
    for array, again in ((odd.T, back.by_name["x"]), (odd, back.matrix), (whole.empty, back.empty)):
        assert again.shape == array.shape
        assert again.tobytes() == np.ascontiguousarray(array).tobytes()
        again += 1.0  # it can be written to, as the first could
    for first, again in zip((part, *whole.parts), (back.part, *back.parts), strict=True):
        assert [getattr(first, entry.name) for entry in fields(Part)] == [
            getattr(again, entry.name) for entry in fields(Part)
        ]
    assert back.lists == {"y": (1.0, 2.5)}


def test_what_would_not_come_back_is_refused() -> None:
    for value in ({1, 2}, np.zeros(2, np.float32), 1j, np.int64(3)):
        with pytest.raises(TypeError, match=type(value).__name__):
            plain([value])
