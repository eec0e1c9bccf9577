"""LabVIEW's TDMS files as npTDMS writes them, through the command's own path to a run log."""

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from recordings.importing import import_file
from recordings.mapping.mapping import ColumnMapping
from records.errors import BadInput
from tests.recordings.runs import RUN, T_S

nptdms = pytest.importorskip("nptdms")
BEGIN = np.datetime64("2024-05-01T12:00:00.000000")
STEP_S = 0.01
LATE_ROWS = 3  # by which the encoders begin after the outputs


def _write(path: Path, *segments: list[Any]) -> Path:
    with nptdms.TdmsWriter(path) as writer:
        for channels in segments:
            writer.write_segment(channels)
    return path


def _waveform(group: str, name: str, values: np.ndarray, unit: str, late_rows: int = 0) -> Any:
    begin = BEGIN + np.timedelta64(round(1e6 * STEP_S * late_rows), "us")
    stated = {"wf_increment": STEP_S, "wf_start_time": begin, "unit_string": unit}
    return nptdms.ChannelObject(group, name, values, properties=stated)


def _of_a_task(rows: slice) -> list[Any]:
    inputs = [_waveform("ao", name, RUN[name][rows], "V") for name in ("u_M_V", "u_T_V")]
    angles = [(name, np.degrees(RUN[f"{name}_rad"][LATE_ROWS:][rows])) for name in ("psi", "phi")]
    return [*inputs, *(_waveform("encoder", name, values, "deg", LATE_ROWS) for name, values in angles)]


def test_waveforms_in_segments_are_the_run_each_from_its_own_begin(tmp_path: Path) -> None:
    path = _write(tmp_path / "run.tdms", _of_a_task(slice(0, 20)), _of_a_task(slice(20, None)))
    log = import_file(path, ColumnMapping()).log
    np.testing.assert_allclose(log.t_s, T_S[LATE_ROWS:], atol=1e-9)
    for name in ("u_M_V", "u_T_V", "psi_rad", "phi_rad"):
        np.testing.assert_allclose(log.column(name), RUN[name][LATE_ROWS:], rtol=1e-9)


@pytest.mark.parametrize("dated", [False, True])
def test_channels_beside_one_of_times_are_the_run(dated: bool, tmp_path: Path) -> None:
    times = BEGIN + np.round(1e6 * T_S).astype("timedelta64[us]") if dated else T_S
    channels = [nptdms.ChannelObject("rig", name, RUN[name]) for name in RUN if name != "t_s"]
    log = import_file(
        _write(tmp_path / "run.tdms", [nptdms.ChannelObject("rig", "Time", times), *channels]), ColumnMapping()
    ).log
    np.testing.assert_allclose(log.t_s, T_S, atol=1e-9)
    np.testing.assert_allclose(log.column("psi_rad"), RUN["psi_rad"])


def test_a_file_that_was_cut_short_says_so(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    path = _write(tmp_path / "run.tdms", _of_a_task(slice(0, 20)), _of_a_task(slice(20, None)))
    whole = path.read_bytes()
    path.write_bytes(whole[:-40])
    done = import_file(path, ColumnMapping())
    assert np.isnan(done.log.column("phi_rad")[-1])  # the last channel lacks what was cut off
    assert any("cut short" in told for told in done.found)
    path.write_bytes(whole[:60])
    with pytest.raises(BadInput, match=re.escape("a whole .tdms file")):
        import_file(path, ColumnMapping())
    assert capfd.readouterr().err == ""
