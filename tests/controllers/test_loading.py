"""A table read back from its file is the table that was written, whichever controller it is of, and nothing else is."""

import json
from pathlib import Path

import pytest

from controllers.loading import generate, load, load_scheduled, row_of
from records.errors import BadInput
from tests.controllers.rows import ROWS, designed


@pytest.mark.parametrize("name", ROWS)
def test_a_table_comes_back_from_its_file_and_makes_the_same_c(name: str, tmp_path: Path) -> None:
    row, table = designed(name)
    path = tmp_path / "controller.json"
    path.write_text(row.text(table))
    again, back = load(path)
    assert (again.name, row_of(back).name, back.digest) == (name, name, table.digest)
    assert generate(back, "float32") == row.generate(table)


def test_a_table_that_was_changed_by_hand_is_refused_with_both_digests(tmp_path: Path) -> None:
    row, table = designed("pid")
    content = json.loads(row.text(table))
    content["elevation"]["gains"]["k_p_V_rad"] *= 1.01
    path = tmp_path / "controller.json"
    path.write_text(json.dumps(content))
    with pytest.raises(BadInput, match=rf"digest.*{table.digest[:16]}.*design it again"):
        load(path)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"controller": "mpc"}, "'mpc'.*scheduled, instantaneous, pid"),
        ({"elevation": 3}, "elevation"),
        ({"azimuth": {}}, "azimuth"),
    ],
)
def test_a_foreign_table_is_refused_by_what_is_foreign(change: dict[str, object], said: str, tmp_path: Path) -> None:
    row, table = designed("fuzzy")
    path = tmp_path / "controller.json"
    path.write_text(json.dumps({**json.loads(row.text(table)), **change}))
    with pytest.raises(BadInput, match=said):
        load(path)


def test_what_only_the_scheduled_law_has_is_refused_for_others_with_what_to_do(tmp_path: Path) -> None:
    row, table = designed("lqg")
    path = tmp_path / "controller.json"
    path.write_text(row.text(table))
    with pytest.raises(BadInput, match=r"'lqg'.*scheduled law's: poles.*twinlaw validate"):
        load_scheduled(path, "poles")
    with pytest.raises(BadInput, match=r"'lqg'.*fixed.*float32"):
        generate(table, "fixed")
