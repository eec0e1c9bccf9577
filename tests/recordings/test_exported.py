"""MATLAB and MDF4 files become run logs with their own times; what is missing, mis-scaled or broken is refused by name."""

import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.io import savemat

from recordings.channels import Channel, Choice, log_of_channels
from recordings.exported import import_file
from records.errors import BadInput
from records.log import load_log
from sim.columns import log_columns
from sim.plants import MODELS
from twinlaw.command import main

CE150 = log_columns(MODELS["ce150"]())
T_S = np.arange(50) * 0.01
RUN = {
    "t_s": T_S,
    "u_M_V": 5.0 + T_S,
    "u_T_V": np.full(50, 1.8),
    "psi_rad": np.sin(T_S),
    "phi_rad": np.cos(T_S),
}


def _saved(path: Path, **changes: Any) -> Path:
    savemat(path, {name: value for name, value in {**RUN, **changes}.items() if value is not None})
    return path


def test_vectors_named_as_the_columns_become_the_same_log(tmp_path: Path) -> None:
    _saved(tmp_path / "run.mat", psi_ref_rad=np.zeros(50), table_digest="ab" * 32, remark="of no use")
    out = tmp_path / "run.csv"
    assert main(["import", str(tmp_path / "run.mat"), "--out", str(out), "--json"]) == 0
    log = load_log(out, CE150)
    for name, values in RUN.items():
        np.testing.assert_array_equal(log.column(name), values)
    assert (log.loop, log.sample_period_s, log.table_digest) == ("closed", 0.01, "ab" * 32)
    assert list(log.extra) == ["psi_ref_rad"]


def test_a_struct_and_foreign_names_with_factors_are_taken(tmp_path: Path) -> None:
    savemat(
        tmp_path / "rig.mat",
        {"run": {"time": T_S, "um": RUN["u_M_V"], "ut": RUN["u_T_V"], "El": np.degrees(RUN["psi_rad"]), "a*b": T_S}},
    )
    columns = ["t_s=time", "u_M_V=um", "u_T_V=ut", "psi_rad=El*0.017453292519943295", "phi_rad=a*b"]
    out = tmp_path / "run.csv"
    arguments = [word for column in columns for word in ("--column", column)]
    assert main(["import", str(tmp_path / "rig.mat"), *arguments, "--loop", "open", "--out", str(out)]) == 0
    log = load_log(out, CE150)
    np.testing.assert_allclose(log.column("psi_rad"), RUN["psi_rad"], rtol=1e-15, atol=0)
    np.testing.assert_array_equal(log.column("phi_rad"), T_S)
    assert log.loop == "open"


def test_outputs_on_clocks_of_their_own_leave_gaps_and_inputs_are_held() -> None:
    late = Channel(np.array([0.0, 0.02, 0.03]), np.array([1.0, 3.0, 4.0]))
    channels = {
        "u_M_V": Channel(np.array([-1.0, 0.015]), np.array([5.0, 6.0]), "V"),
        "u_T_V": Channel(np.array([0.0]), np.array([2.0])),
        "psi_rad": Channel(np.array([0.0, 0.01, 0.02 + 1e-12]), np.array([0.1, 0.2, 0.3]), "rad"),
        "phi_rad": late,
    }
    log = log_of_channels(channels, CE150, "here")
    np.testing.assert_array_equal(log.t_s, [0.0, 0.01, 0.02, 0.03])
    np.testing.assert_array_equal(log.y, [[0.1, 1.0], [0.2, np.nan], [0.3, 3.0], [np.nan, 4.0]])
    np.testing.assert_array_equal(log.u, [[5.0, 2.0], [5.0, 2.0], [6.0, 2.0], [6.0, 2.0]])
    assert (log.loop, log.sample_period_s) == ("open", 0.01)


def _without(name: str) -> dict[str, Any]:
    return {name: None}


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (_without("t_s"), r"variable 't_s': got u_M_V, u_T_V, psi_rad, phi_rad, .*--column t_s=NAME"),
        (_without("phi_rad"), r"channel 'phi_rad': got u_M_V, u_T_V, psi_rad, .*--column phi_rad=CHANNEL"),
        ({"phi_rad": np.zeros(49)}, r"variable 'phi_rad': got 49 values at 50 times"),
        ({"t_s": T_S[::-1]}, "times of an output: got times that stand still, go back"),
        ({"t_s": np.where(T_S == 0.1, np.nan, T_S)}, "times of an output"),
        ({"u_M_V": np.where(T_S > 0.2, np.nan, 5.0)}, r"column 'u_M_V': got nan at sample 21"),
        ({"loop": "sideways"}, "text 'loop': got 'sideways'"),
    ],
)
def test_a_wrong_matlab_file_is_refused_by_name(tmp_path: Path, changes: dict[str, Any], message: str) -> None:
    with pytest.raises(BadInput, match=message):
        import_file(_saved(tmp_path / "run.mat", **changes), "ce150", {}, None)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (None, "No such file"),
        (b"", "no whole .mat file"),
        (b"MATLAB 7.3 MAT-file, made by hand".ljust(124) + b"\x00\x02IM" + bytes(400), "version 7.3"),
        (bytes(range(256)) * 8, "no whole .mat file"),
    ],
    ids=["missing", "empty", "version 7.3", "rubbish"],
)
def test_a_file_that_is_no_matlab_file_is_refused(tmp_path: Path, content: bytes | None, message: str) -> None:
    if content is not None:
        (tmp_path / "run.mat").write_bytes(content)
    with pytest.raises(BadInput, match=message):
        import_file(tmp_path / "run.mat", "ce150", {}, None)


def test_a_truncated_matlab_file_is_refused_at_every_length(tmp_path: Path) -> None:
    whole = _saved(tmp_path / "whole.mat").read_bytes()
    for length in range(0, len(whole), 97):
        (tmp_path / "cut.mat").write_bytes(whole[:length])
        with pytest.raises(BadInput):
            import_file(tmp_path / "cut.mat", "ce150", {}, None)


def test_a_channel_in_another_unit_is_refused_without_its_factor() -> None:
    channels = {name: Channel(T_S, values) for name, values in RUN.items() if name != "t_s"}
    channels["psi_rad"] = Channel(T_S, np.degrees(RUN["psi_rad"]), "deg")
    with pytest.raises(BadInput, match=r"unit of channel 'psi_rad': got 'deg', expected rad; .*\*FACTOR"):
        log_of_channels(channels, CE150, "here")
    log = log_of_channels(channels, CE150, "here", choices={"psi_rad": Choice("psi_rad", np.pi / 180.0)})
    np.testing.assert_allclose(log.column("psi_rad"), RUN["psi_rad"], rtol=1e-15, atol=0)
    with pytest.raises(BadInput, match="column 'theta_rad': got an unknown column, expected one of u_M_V"):
        log_of_channels(channels, CE150, "here", choices={"theta_rad": Choice("psi_rad")})


def test_an_input_that_begins_too_late_is_refused() -> None:
    channels = {name: Channel(T_S, values) for name, values in RUN.items() if name != "t_s"}
    channels["u_M_V"] = Channel(T_S[5:], RUN["u_M_V"][5:], "V")
    with pytest.raises(BadInput, match=r"column 'u_M_V': got its first sample at 0\.05 s, expected one by 0 s"):
        log_of_channels(channels, CE150, "here")


def test_without_asammdf_an_mdf4_file_is_one_clear_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, "asammdf", None)
    (tmp_path / "run.mf4").write_bytes(b"MDF     ")
    assert main(["import", str(tmp_path / "run.mf4"), "--out", str(tmp_path / "run.csv")]) == 2
    said = capsys.readouterr().err
    assert "[mdf4]" in said
    assert len(said.splitlines()) == 1
    assert not (tmp_path / "run.csv").exists()


def test_an_mdf4_file_with_two_clocks_becomes_a_log(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    asammdf = pytest.importorskip("asammdf", reason="the optional extra mdf4 is not installed")
    recording = asammdf.MDF()
    angles = [asammdf.Signal(RUN[name], T_S, name=name, unit="rad") for name in ("psi_rad", "phi_rad")]
    slow = [asammdf.Signal(RUN[name][::5], T_S[::5], name=name, unit="V") for name in ("u_M_V", "u_T_V")]
    recording.append(angles)
    recording.append(slow)
    recording.save(tmp_path / "run.mf4")
    recording.close()
    out = tmp_path / "run.csv"
    assert main(["import", str(tmp_path / "run.mf4"), "--out", str(out), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["rows"] == 50
    log = load_log(out, CE150)
    np.testing.assert_allclose(log.t_s, T_S, atol=1e-9)
    np.testing.assert_array_equal(log.column("psi_rad"), RUN["psi_rad"])
    np.testing.assert_array_equal(log.column("u_M_V"), np.repeat(RUN["u_M_V"][::5], 5))
    (tmp_path / "rubbish.mf4").write_bytes(b"no MDF at all" * 100)
    assert main(["import", str(tmp_path / "rubbish.mf4"), "--out", str(tmp_path / "none.csv")]) == 2
    assert "no MDF" in capsys.readouterr().err
