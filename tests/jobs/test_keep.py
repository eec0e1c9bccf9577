"""What keeps answers: whole or not there, and never for another question."""

from pathlib import Path

import numpy as np
import pytest

from jobs.job import Job, canonical
from jobs.keep import STAMP, Folders
from tests.jobs import doing
from tests.jobs.doing import Throw


def test_a_key_tells_function_record_and_code_apart() -> None:
    jobs = [
        (Job("a", doing.thrown, Throw(1, 2)), "code"),
        (Job("a", doing.thrown, Throw(2, 1)), "code"),
        (Job("a", doing.thrown, Throw(1, 2, 999)), "code"),
        (Job("a", doing.late, Throw(1, 2)), "code"),
        (Job("a", doing.thrown, Throw(1, 2)), "other code"),
    ]
    assert len({job.key(code) for job, code in jobs}) == len(jobs)
    assert Job("b", doing.thrown, Throw(1, 2)).key("code") == jobs[0][0].key("code")


def test_plain_data_that_differ_have_other_bytes() -> None:
    values = [None, 0, 1, True, 0.0, -0.0, 1.0, "1", b"1", (), (1,), (1, 1), ((1,), 1), {}, {"a": 1}, {"a": (1,)}, "a1"]
    values += [
        np.zeros(2),
        np.zeros((1, 2)),
        np.zeros((2, 1)),
        np.zeros(2, np.int64),
        np.array([0.0, -0.0]),
        np.zeros(0),
    ]
    assert len({canonical(value) for value in values}) == len(values)
    assert canonical({"a": 1, "b": 2}) == canonical({"b": 2, "a": 1})
    with pytest.raises(TypeError, match="set"):
        canonical({1, 2})
    with pytest.raises(TypeError, match="ndarray"):
        canonical(np.array([None]))


def test_a_folder_of_files_comes_back_only_whole_and_for_its_own_key(tmp_path: Path) -> None:
    keep = Folders(tmp_path, "a.txt")
    keep.save("case", "key", {"a.txt": "one", "b.txt": "two"}, 0.5)
    assert keep.load("case", "key") == {"a.txt": "one"}
    assert keep.load("case", "another key") is None
    assert keep.load("another case", "key") is None
    (tmp_path / "case" / "b.txt").write_text("tw")
    assert keep.load("case", "key") is None
    (tmp_path / "case" / "b.txt").unlink()
    assert keep.load("case", "key") is None


def test_a_new_answer_leaves_no_file_of_the_old_one_but_all_others(tmp_path: Path) -> None:
    keep = Folders(tmp_path, "a.txt")
    keep.save("case", "old", doing.folder_of_files("long"), 0.0)
    (tmp_path / "case" / "mine.txt").write_text("a person's own")
    keep.save("case", "new", doing.folder_of_files("short"), 0.0)
    assert {path.name for path in (tmp_path / "case").iterdir()} == {"a.txt", "b.txt", "mine.txt", STAMP}
    assert keep.load("case", "old") is None
