"""`twinlaw import --from --until --every`: the rows of a part, unchanged, and no log where there are none."""

from pathlib import Path

import numpy as np
import pytest
from scipy.io import savemat

from twinlaw.command import main


@pytest.fixture
def recording(tmp_path: Path) -> Path:
    """A MATLAB file of 1 s at 100 Hz whose angle tells the row."""
    path = tmp_path / "run.mat"
    t_s = np.arange(0.0, 1.0, 0.01)
    savemat(path, {"t_s": t_s, "u_V": np.ones_like(t_s), "q_m": 1e-3 * np.arange(t_s.size)})
    return path


def test_a_part_holds_the_rows_between_its_times(recording: Path, tmp_path: Path) -> None:
    out = tmp_path / "part.csv"
    times = ["--from", "0.195", "--until", "0.405"]
    assert main(["import", str(recording), "--plant", "emps", *times, "--out", str(out)]) == 0
    rows = np.loadtxt(out, delimiter=",", skiprows=1)
    assert rows[:, 0] == pytest.approx(np.arange(0.20, 0.405, 0.01))
    assert rows[:, -1] == pytest.approx(1e-3 * np.arange(20, 41))


def test_one_row_in_so_many_has_its_own_sample_period(recording: Path, tmp_path: Path) -> None:
    out = tmp_path / "part.csv"
    part = ["--from", "0.2", "--every", "5"]
    assert main(["import", str(recording), "--plant", "emps", *part, "--out", str(out)]) == 0
    assert np.loadtxt(out, delimiter=",", skiprows=1)[:, -1] == pytest.approx(1e-3 * np.arange(20, 100, 5))
    assert "sample_period_s = 0.05\n" in out.with_suffix(".toml").read_text()


def test_no_rows_between_the_times_is_bad_input(
    recording: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "part.csv"
    assert main(["import", str(recording), "--plant", "emps", "--from", "5", "--out", str(out)]) == 2
    assert "0 rows" in capsys.readouterr().err
    assert not out.exists()
