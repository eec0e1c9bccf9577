"""MATLAB's objects as mat-io writes them, in both versions of the format; what is said where mat-io is not installed."""

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from recordings.formats.matlab_objects import what
from recordings.formats.optional import is_installed
from recordings.mapping.mapping import ColumnMapping
from records.errors import BadInput
from tests.recordings.here import imported_here

pytestmark = pytest.mark.skipif(not is_installed("matio"), reason="no mat-io: pip install --editable '.[matlab]'")

T_S = 0.01 * np.arange(60)
RUN = {"u_M_V": 5.0 + T_S, "u_T_V": 1.0 - T_S, "psi_rad": np.sin(T_S), "phi_rad": np.cos(T_S)}
VERSIONS = ("v7", "v7.3")


def series(values: np.ndarray, unit: str, *, stored: bool) -> Any:
    """A timeseries; MATLAB stores the times of rows at one rate as start, step and number."""
    from matio.utils.matclass import MatlabOpaque

    times = {"Time_": 1e3 * T_S[:, None]} if stored else {"Start_": 0.0, "Increment_": 10.0, "Time_": np.zeros((0, 0))}
    time = MatlabOpaque({"Units": "milliseconds", "Length": float(T_S.size), **times}, "tsdata.timemetadata")
    data = MatlabOpaque({"Units": unit}, "tsdata.datametadata")
    held = {"Name": "unnamed", "Data_": values[:, None], "Time_": np.zeros((0, 0)), "TimeInfo": time, "DataInfo": data}
    return MatlabOpaque(held, "timeseries")


def save(path: Path, held: dict[str, Any], version: str) -> None:
    from matio import save_to_mat  # two seconds of pandas, which every process that only collects is spared

    save_to_mat(str(path), held, version=version)


def is_the_run(path: Path, **columns: str) -> None:
    log = imported_here(path, ColumnMapping(columns=columns)).log
    np.testing.assert_allclose(log.t_s, T_S, atol=1e-12)
    for name, values in RUN.items():
        np.testing.assert_allclose(log.column(name), values, rtol=1e-12, atol=1e-15)


@pytest.mark.parametrize("version", VERSIONS)
def test_a_timeseries_is_the_column_of_its_name_with_its_own_times_and_unit(version: str, tmp_path: Path) -> None:
    saved = {name: series(values, "", stored=name == "u_T_V") for name, values in RUN.items()}
    saved["psi_rad"] = series(np.degrees(RUN["psi_rad"]), "deg", stored=False)
    save(tmp_path / "run.mat", {**saved, "K": np.eye(2)}, version)
    is_the_run(tmp_path / "run.mat")


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("version", VERSIONS)
def test_a_timetable_and_a_table_are_their_columns(version: str, tmp_path: Path) -> None:
    pandas = pytest.importorskip("pandas")
    table = pandas.DataFrame(RUN)
    timed = table.set_index(pandas.to_timedelta(1e3 * T_S, unit="ms"))
    timed.index.name = "Time"
    save(tmp_path / "timed.mat", {"log": timed}, version)
    is_the_run(tmp_path / "timed.mat")
    save(tmp_path / "table.mat", {"log": table}, version)
    is_the_run(tmp_path / "table.mat", t_s="0.01*row")


@pytest.mark.parametrize("version", VERSIONS)
def test_without_the_package_the_line_of_matlab_that_saves_them_readable_is_named(
    version: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    saved = {name: series(values, "", stored=True) for name, values in RUN.items()}
    save(tmp_path / "run.mat", saved, version)
    monkeypatch.setitem(sys.modules, "matio", None)
    with pytest.raises(
        BadInput, match=r"of class timeseries: install .* in MATLAB s\.x\.Time = x\.Time; s\.x\.Data = x\.Data; save\('"
    ):
        imported_here(tmp_path / "run.mat", ColumnMapping())


def test_the_class_of_an_object_says_what_to_type() -> None:
    assert "x = OUTPUT.logsout.get('x').Values" in what("Simulink.SimulationOutput")
    assert "seconds(x.Properties.RowTimes - x.Properties.RowTimes(1))" in what("timetable")
