"""A file that finds no room is not there at all, and what was there before stays."""

import subprocess
import sys
from pathlib import Path

import pytest

from records.errors import BadInput
from records.files import place_of, write_together
from tests.test_project import ROOT

# A limit of this process on the size of files stands for a full disk; Python ignores the signal and meets the error.
PROGRAM = """
import resource, sys
from pathlib import Path
from records.errors import BadInput
from records.files import write_atomic
resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))
try:
    write_atomic(Path(sys.argv[1]), "x" * 2000)
except BadInput as error:
    print(error)
"""


def test_a_file_without_room_leaves_what_was_there_and_says_to_make_room(tmp_path: Path) -> None:
    path = tmp_path / "kept.json"
    path.write_text("before", encoding="utf-8")
    command = [sys.executable, "-c", PROGRAM, str(path)]
    done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT, check=True)
    assert done.stdout.startswith(f"{path}: output file: got ")
    assert "make room" in done.stdout
    assert [(entry.name, entry.read_text()) for entry in tmp_path.iterdir()] == [("kept.json", "before")]


def test_files_that_belong_together_are_all_new_or_all_old(tmp_path: Path) -> None:
    """Truth: the second cannot be written, as its folder is a file; so the first stays as it was, and nothing lies beside it."""
    (tmp_path / "law.h").write_text("old")
    (tmp_path / "no folder").touch()
    with pytest.raises(BadInput, match="no folder"):
        write_together({tmp_path / "law.h": "new", tmp_path / "no folder" / "law.c": "new"})
    assert (tmp_path / "law.h").read_text() == "old"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["law.h", "no folder"]


def test_a_path_that_leads_round_in_a_circle_is_no_other_place(tmp_path: Path) -> None:
    one, other, plain = (tmp_path / name for name in ("one", "other", "plain.csv"))
    one.symlink_to(other)
    other.symlink_to(one)
    (tmp_path / "link.csv").symlink_to(plain)
    assert place_of(one) != place_of(plain)
    assert place_of(tmp_path / "link.csv") == place_of(plain)
