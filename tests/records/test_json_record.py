"""A record as JSON and back: its annotations say how, and what does not fit them is named by file, key and index."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import pytest

from records.errors import BadInput
from records.text.json_record import plain, record_of


@dataclass(frozen=True)
class Part:
    from_: float
    flag: bool = True


@dataclass(frozen=True)
class Whole:
    name: str
    parts: tuple[Part, ...]
    pair: tuple[float, float] | None
    by_name: Mapping[str, Part]
    free: Mapping[str, Any] = field(default_factory=dict)
    part: Part | None = None


WHOLE = Whole("a", (Part(1.0), Part(2.0, False)), (3.0, 4.0), {"b": Part(5.0)}, {"c": [1, "d"]}, Part(6.0))


def test_what_is_written_is_read_back() -> None:
    content = json.loads(json.dumps(plain(WHOLE)))
    assert content["parts"] == [{"from": 1.0, "flag": True}, {"from": 2.0, "flag": False}]
    assert record_of(Whole, content, "file") == WHOLE


def test_what_has_a_default_may_lack_and_what_may_be_none_be_null() -> None:
    content: dict[str, Any] = {"name": "a", "parts": [], "pair": None, "by_name": {}}
    assert record_of(Whole, content, "file") == Whole("a", (), None, {})


@pytest.mark.parametrize(
    ("changed", "told"),
    [
        ({"name": ""}, "file.name: text"),
        ({"parts": {}}, "file.parts: list"),
        ({"parts": [{"from": 1.0}, {"from": "x"}]}, r"file.parts\[1\].from: number"),
        ({"pair": [1.0]}, "file.pair: list: got 1 entries, expected 2"),
        ({"by_name": {"b": {"from": 1.0, "flag": 1}}}, "file.by_name.b.flag: flag"),
        ({"by_name": {"b": {}}}, "file.by_name.b: key 'from'"),
        ({"by_name": []}, "file.by_name: a table"),
        ({"other": 1}, "key 'other'"),
    ],
)
def test_what_does_not_fit_is_named_with_its_place(changed: dict[str, Any], told: str) -> None:
    content = {**json.loads(json.dumps(plain(WHOLE))), **changed}
    with pytest.raises(BadInput, match=told):
        record_of(Whole, content, "file")
