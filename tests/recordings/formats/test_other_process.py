"""A reader in a program of its own: what it read, what it refuses, and that its death is one line."""

import os
from pathlib import Path

import numpy as np
import pytest
from scipy.io import savemat

from recordings.formats import matlab, other_process
from recordings.importing import import_file
from recordings.layout import FOUND
from recordings.mapping.mapping import ColumnMapping
from records.errors import BadInput


def test_what_is_read_apart_is_what_is_read_here(tmp_path: Path) -> None:
    path = tmp_path / "run.mat"
    savemat(path, {"run": {"t_s": np.arange(5.0), "psi_rad": np.ones(5)}, "loop": "open"})
    there, here = other_process.read("matlab", path, "MATLAB file"), matlab.read(path, FOUND)
    assert (there.texts, list(there.signals)) == (here.texts, list(here.signals))
    np.testing.assert_array_equal(there.signals["run.psi_rad"].values, here.signals["run.psi_rad"].values)
    path.write_bytes(b"no such file")
    with pytest.raises(BadInput, match=r"run\.mat: MATLAB file: got no whole \.mat file"):
        other_process.read("matlab", path, "MATLAB file")


def test_a_file_at_which_the_reader_dies_is_bad_input(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Damaged files make asammdf 8.8 and SciPy 1.17 read beyond their memory about once in a hundred times."""
    (tmp_path / "asammdf.py").write_text("import os, signal\ndef MDF(path): os.kill(os.getpid(), signal.SIGSEGV)\n")
    (tmp_path / "run.mf4").write_bytes(b"MDF     ")
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join((str(tmp_path), os.environ.get("PYTHONPATH", ""))))
    with pytest.raises(BadInput, match="its reader ended with status -11"):
        import_file(tmp_path / "run.mf4", ColumnMapping())
