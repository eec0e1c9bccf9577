"""A run log as MDF4: every number, time and unit comes back through the importer's own reader."""

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from recordings.formats.mdf import read
from recordings.formats.mdf4_export import mdf4_bytes
from recordings.layout import FOUND
from recordings.mapping.mapping import ColumnMapping
from records.errors import BadInput
from records.log import RunLog, save_log
from records.logs.sidecar import facts_of_sidecar
from records.text.units import unit_of
from sim.columns import log_columns
from sim.plants import MODELS
from tests.recordings.here import imported_here
from twinlaw.command import main

T_S = np.array([0.0, 0.01, 0.0203, 0.04])


def log() -> RunLog:
    """Four samples with a jittered time, a gap, a NaN and the board's sequence numbers."""
    y = np.array([[0.1, -0.2], [np.nan, -0.21], [0.12, -0.22], [0.13, -0.23]])
    u = np.array([[1.0, 2.0], [1.5, 2.5], [9.75, -10.0], [0.0, 0.0]])
    extra = {"omega_M_rad_s": np.arange(4.0)}
    seq = np.array([7, 8, 9, 11])
    return RunLog(log_columns(MODELS["ce150"]()), 0.01, "closed", T_S, u, y, extra, seq, table_digest="ab" * 32)


def test_units_are_those_of_the_names() -> None:
    named = {"u_M_V": "V", "psi_rad": "rad", "omega_M_rad_s": "rad/s", "q_m": "m", "seq": "", "M": ""}
    assert {name: unit_of(name) for name in named} == named


def test_what_was_exported_reads_back_exactly(tmp_path: Path) -> None:
    pytest.importorskip("asammdf", reason="the optional extra mdf4 is not installed")
    (tmp_path / "run.mf4").write_bytes(mdf4_bytes(log()))
    channels = read(tmp_path / "run.mf4", FOUND).signals
    for name in ("u_M_V", "u_T_V", "psi_rad", "phi_rad", "omega_M_rad_s"):
        np.testing.assert_array_equal(channels[name].values, log().column(name))
        np.testing.assert_array_equal(channels[channels[name].clock or ""].values, T_S)
        assert channels[name].unit == unit_of(name)
    np.testing.assert_array_equal(channels["seq"].values, [7, 8, 9, 11])


def test_the_way_back_keeps_digest_loop_and_locked_axes(tmp_path: Path) -> None:
    """Truth: the sidecar of the log that was exported; a comment of another tool says nothing."""
    pytest.importorskip("asammdf", reason="the optional extra mdf4 is not installed")
    held = replace(log(), locked=("azimuth",), loop="open")
    (tmp_path / "run.mf4").write_bytes(mdf4_bytes(held))
    back = imported_here(tmp_path / "run.mf4", ColumnMapping()).log
    assert (back.table_digest, back.loop, back.locked) == (held.table_digest, "open", ("azimuth",))
    with pytest.raises(BadInput, match="give the log and the plant of one rig"):
        imported_here(tmp_path / "run.mf4", ColumnMapping(plant="quanser_aero"))


def test_a_comment_that_is_no_sidecar_says_nothing() -> None:
    columns = log_columns(MODELS["ce150"]())
    for comment in ("", "<CNcomment><TX>test bench 3</TX></CNcomment>", 'schema = "another/1"', "a = ["):
        assert facts_of_sidecar(comment, "a comment", columns) == {}


def test_the_verb_writes_beside_the_log_and_refuses_another_ending(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    save_log(tmp_path / "run.csv", log())
    assert main(["export", str(tmp_path / "run.csv"), "--out", str(tmp_path / "run.xlsx")]) == 2
    assert "NAME.mf4" in capsys.readouterr().err
    pytest.importorskip("asammdf", reason="the optional extra mdf4 is not installed")
    assert main(["export", str(tmp_path / "run.csv")]) == 0
    assert (tmp_path / "run.mf4").stat().st_size > 0


def test_without_asammdf_it_is_one_clear_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "asammdf", None)
    with pytest.raises(BadInput, match="mdf4"):
        mdf4_bytes(log())


@pytest.mark.soak
def test_a_file_that_was_cut_short_is_one_clear_line(tmp_path: Path) -> None:
    """Truth: the error alone; the package complains a second time when it collects what it had half opened."""
    pytest.importorskip("asammdf", reason="the optional extra mdf4 is not installed")
    whole = mdf4_bytes(log())
    (tmp_path / "run.mf4").write_bytes(whole[: len(whole) // 2])
    command = [sys.executable, "-m", "twinlaw.command", "import", str(tmp_path / "run.mf4")]
    done = subprocess.run([*command, "--out", str(tmp_path / "run.csv")], capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1, done.stderr
    assert not (tmp_path / "run.csv").exists()
