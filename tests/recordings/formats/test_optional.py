"""Formats that a package of an extra reads: HDF5, MDF4, Parquet; and what is said where it is not installed."""

import sys
from pathlib import Path

import numpy as np
import pytest

from recordings.mapping.mapping import ColumnMapping
from records.errors import BadInput
from tests.recordings.here import imported_here
from tests.recordings.runs import RUN, T_S, save_run
from twinlaw.command import main


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


@pytest.mark.parametrize("suffix", [".mat", ".parquet"])
def test_a_column_without_samples_is_named(suffix: str, tmp_path: Path) -> None:
    if suffix == ".parquet":
        parquet, pa = pytest.importorskip("pyarrow.parquet"), pytest.importorskip("pyarrow")
        parquet.write_table(pa.table({name: pa.array([], type=pa.float64()) for name in RUN}), tmp_path / "run.parquet")
    else:
        save_run(tmp_path / "run.mat", phi_rad=np.zeros(0))
    told = {".mat": r"psi_rad, phi_rad \(empty\)", ".parquet": "column 'u_M_V': got no sample of u_M_V"}[suffix]
    with pytest.raises(BadInput, match=told):
        imported_here(tmp_path / f"run{suffix}", ColumnMapping())


def test_hdf5_s_units_and_tables_of_rows_are_read(tmp_path: Path) -> None:
    h5py = pytest.importorskip("h5py")
    rows = np.zeros(50, dtype=[("time", "f8"), ("phi_rad", "f8")])
    rows["time"], rows["phi_rad"] = T_S, RUN["phi_rad"]
    with h5py.File(tmp_path / "run.h5", "w") as file:
        file["log"] = rows
        for name, factor, unit in (
            ("time", 1e3, "ms"),
            ("u_M", 1e3, "mV"),
            ("u_T", 1.0, "V"),
            ("psi", 180.0 / np.pi, "deg"),
        ):
            column = {"time": "t_s", "u_M": "u_M_V", "u_T": "u_T_V", "psi": "psi_rad"}[name]
            file[f"rig/{name}"] = factor * RUN[column]
            file[f"rig/{name}"].attrs["units"] = unit
    log = imported_here(tmp_path / "run.h5", ColumnMapping({"u_M_V": "u_M", "u_T_V": "u_T", "psi_rad": "psi"})).log
    for name, values in RUN.items():
        np.testing.assert_allclose(log.column(name), values, atol=1e-12)
