"""Constants that decide: each can be asked for unit, reason and data, computes as the number that it is, and is used."""

import copy
import pickle
import re
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

import diagnosis.decisions
import identification.thresholds
import logcheck.thresholds
import replay.thresholds
from records.deciding import Count, Decides, Limit, Limits, deciding

ROOT = Path(__file__).resolve().parents[2]
TABLES = (diagnosis.decisions, identification.thresholds, logcheck.thresholds, replay.thresholds)


@pytest.mark.parametrize("module", TABLES, ids=lambda module: str(module.__name__))
def test_every_constant_has_unit_reason_and_data_and_a_user(module: ModuleType) -> None:
    package, _, name = module.__name__.rpartition(".")
    code = "\n".join(path.read_text(encoding="utf-8") for path in sorted((ROOT / package).rglob("*.py")))
    asked = set(re.findall(rf"\b{name}\.(\w+)", code))
    rows = dict(deciding(vars(module)))
    assert len(rows) > 10
    for key, constant in rows.items():
        assert constant.unit, key
        assert len(constant.reason) > 10, key
        assert constant.data, key
        assert key in asked or code.count(key) > 1, f"nobody uses {key}"


def test_a_constant_computes_as_its_number_and_keeps_what_is_known_of_it() -> None:
    half = Limit(0.5, "nats", "because", "seed 1")
    assert 2.0 * half == 1.0
    np.testing.assert_array_equal(half * np.arange(3.0), [0.0, 0.5, 1.0])
    assert [1, 2, 3, 4][: Count(3, "rows", "because")] == [1, 2, 3]
    assert tuple(Limits((1.0, 2.0), "s", "because")) == (1.0, 2.0)
    for same in (copy.copy(half), pickle.loads(pickle.dumps(half))):
        assert isinstance(same, Decides)
        assert (same, same.unit, same.reason, same.data) == (0.5, "nats", "because", "seed 1")
