"""A kept bound is the bound itself, belongs to one image and is never trusted when damaged."""

from pathlib import Path

import pytest

from records.errors import BadInput
from tests.verification.static_bound.static_programs import program
from verification.static_bound import kept, kept_bound, static_bound


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(kept, "CACHE_DIR", tmp_path)
    return tmp_path / "bounds"


def test_a_kept_bound_is_found_again_without_the_analysis(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    elf = program().read_bytes()
    first = kept_bound(elf, "outer")
    monkeypatch.setattr(kept, "static_bound", None)
    assert first == kept_bound(elf, "outer") == static_bound(elf, "outer")


def test_another_image_or_function_is_bounded_anew(folder: Path) -> None:
    elf = program().read_bytes()
    bounds = [kept_bound(elf, "outer"), kept_bound(elf, "inner"), kept_bound(elf + b"\0", "outer")]
    assert len(list(folder.iterdir())) == 3
    assert bounds[0] == bounds[2] != bounds[1]


@pytest.mark.parametrize("damage", ["", "{", "[]", "{}", '{"path": [], "loops": [{}]}'])
def test_a_damaged_file_is_worked_out_again(folder: Path, damage: str) -> None:
    elf = program().read_bytes()
    whole = kept_bound(elf, "outer")
    [path] = folder.iterdir()
    path.write_text(damage, encoding="utf-8")
    assert kept_bound(elf, "outer") == whole
    assert kept_bound(elf, "outer") == whole


def test_what_has_no_bound_leaves_no_file(folder: Path) -> None:
    with pytest.raises(BadInput):
        kept_bound(program().read_bytes(), "nowhere")
    assert not folder.exists()
