"""NumPy's files: named arrays, records, dates; Python's objects are left closed.

Truth in every file: rows 10 ms apart, u = 5 V + k mV and psi = -0.25 + 0.001 k rad; tolerance: none, but for dates, in ns.
"""

from pathlib import Path

import numpy as np
import pytest

from recordings.formats.numpy_arrays import read
from recordings.layout import FOUND
from records.errors import BadInput

ROWS = 40
T_S, U_V, PSI_RAD = 0.01 * np.arange(ROWS), 5.0 + 0.001 * np.arange(ROWS), -0.25 + 0.001 * np.arange(ROWS)
RECORDS = np.rec.fromarrays([T_S, U_V, PSI_RAD], names="t_s,u_V,psi_rad")


@pytest.mark.parametrize("name", ["arrays.npz", "records.npz", "records.npy"])
def test_arrays_and_fields_of_records_are_signals_with_their_clock(name: str, tmp_path: Path) -> None:
    path = tmp_path / name
    if name == "arrays.npz":
        np.savez(path, t_s=T_S, u_V=U_V, psi_rad=PSI_RAD, Ts=0.01, rig="CE150")
    elif name == "records.npz":
        np.savez_compressed(path, log=RECORDS)
    else:
        np.save(path, RECORDS)
    found = read(path, FOUND)
    scope = "log." if name == "records.npz" else ""
    np.testing.assert_array_equal(found.signals[f"{scope}psi_rad"].values, PSI_RAD)
    assert found.signals[f"{scope}u_V"].clock == f"{scope}t_s"
    if name == "arrays.npz":
        assert (float(found.singles["Ts"].values), found.texts["rig"]) == (0.01, "CE150")


def test_a_matrix_stays_one_and_dates_are_seconds(tmp_path: Path) -> None:
    dates = np.datetime64("2024-05-22T23:59:59.9") + (1e6 * T_S).astype("timedelta64[us]")
    np.savez(tmp_path / "log.npz", time=dates, data=np.column_stack([U_V, PSI_RAD]))
    signals = read(tmp_path / "log.npz", FOUND).signals
    np.testing.assert_allclose(signals["time"].values, T_S, atol=1e-9)
    assert (signals["data"].values.shape, signals["data"].clock) == ((ROWS, 2), "time")


def test_objects_and_other_files_are_refused(tmp_path: Path) -> None:
    np.save(tmp_path / "log.npy", np.array([{"u_V": 5.0}], dtype=object), allow_pickle=True)
    (tmp_path / "log.npz").write_bytes(b"PK\x03\x04" + bytes(50))
    for name in ("log.npy", "log.npz"):
        with pytest.raises(BadInput, match="no whole file of arrays"):
            read(tmp_path / name, FOUND)
    with pytest.raises(BadInput, match="No such file"):
        read(tmp_path / "none.npz", FOUND)
