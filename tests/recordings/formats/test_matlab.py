"""Every kind of .mat file that a run may be saved in; what is missing, broken or ambiguous is refused by name."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.io import savemat
from scipy.sparse import csc_matrix

from recordings.mapping.mapping import ColumnMapping
from records.errors import BadInput
from records.log import load_log
from tests.recordings.here import imported_here
from tests.recordings.runs import CE150, FOUR, RUN, T_S, mapped, save_run
from twinlaw.command import main


def test_vectors_named_as_the_columns_become_the_same_log(tmp_path: Path) -> None:
    save_run(tmp_path / "run.mat", psi_ref_rad=np.zeros(50), table_digest="ab" * 32, remark="of no use")
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


def test_an_array_of_structures_with_a_number_each_is_a_log(tmp_path: Path) -> None:
    """As a loop of `log(k).psi_rad = ...` fills it."""
    kinds = [(name, object) for name in (*RUN, "mode")]
    rows = zip(*RUN.values(), ["hold"] * len(T_S), strict=True)
    savemat(tmp_path / "run.mat", {"log": np.array(list(rows), dtype=kinds)})
    out = tmp_path / "run.csv"
    assert main(["import", str(tmp_path / "run.mat"), "--loop", "open", "--out", str(out)]) == 0
    log = load_log(out, CE150)
    for name, values in RUN.items():
        np.testing.assert_array_equal(log.column(name), values)


def _without(name: str) -> dict[str, Any]:
    return {name: None}


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (_without("t_s"), r"column 't_s': got u_M_V, u_T_V, psi_rad, phi_rad, .*--column t_s=NAME"),
        (_without("phi_rad"), r"columns phi_rad: got t_s, u_M_V, u_T_V, psi_rad, .*--column phi_rad=SIGNAL"),
        ({"phi_rad": np.zeros(49)}, r"column 'phi_rad': got 49 values where t_s has 50"),
        ({"t_s": np.tile(T_S[:5], 10)}, r"times of psi_rad: got 0 s in row 6 after 0\.04 s"),
        ({"t_s": np.where(T_S == 0.1, np.nan, T_S)}, "times of psi_rad: got no time in row 11"),
        ({"u_M_V": np.where(T_S > 0.2, np.nan, 5.0)}, r"column 'u_M_V': got no number at 0\.21 s, in 29 of 50 rows"),
        ({"loop": "sideways"}, "text 'loop': got 'sideways'"),
    ],
)
def test_a_wrong_matlab_file_is_refused_by_name(tmp_path: Path, changes: dict[str, Any], message: str) -> None:
    with pytest.raises(BadInput, match=message):
        imported_here(save_run(tmp_path / "run.mat", **changes), ColumnMapping())


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (None, "No such file"),
        (b"", "no whole .mat file"),
        (b"MATLAB 7.3 MAT-file, made by hand".ljust(124) + b"\x00\x02IM" + bytes(400), "no whole HDF5"),
        (bytes(range(256)) * 8, "no whole .mat file"),
    ],
    ids=["missing", "empty", "version 7.3", "rubbish"],
)
def test_a_file_that_is_no_matlab_file_is_refused(tmp_path: Path, content: bytes | None, message: str) -> None:
    if content is not None:
        (tmp_path / "run.mat").write_bytes(content)
    with pytest.raises(BadInput, match=message):
        imported_here(tmp_path / "run.mat", ColumnMapping())


def test_a_truncated_matlab_file_is_refused_at_every_length(tmp_path: Path) -> None:
    whole = save_run(tmp_path / "whole.mat").read_bytes()
    for length in range(0, len(whole), 97):
        (tmp_path / "cut.mat").write_bytes(whole[:length])
        with pytest.raises(BadInput):
            imported_here(tmp_path / "cut.mat", ColumnMapping())


CELLS = np.empty((1, 5), object)
CELLS[0] = list(RUN.values())
MATRIX = np.vstack([RUN[name] for name in RUN])
FIVE = list(RUN)
NAMES = np.array(FIVE, object)
SCOPE = np.zeros(4, dtype=[("values", "O"), ("label", "O")])
for place, name in enumerate(FOUR):
    SCOPE[place] = (RUN[name][:, None], name)

# What is saved, and what is said of it; the numbers must be those of RUN.
KINDS: dict[str, tuple[dict[str, Any], dict[str, str]]] = {
    "another vector beside": ({**RUN, "K": np.arange(6.0), "gains": np.eye(3), "note": "x", "model": {"a": np.arange(7.0)}}, {}),
    "one structure": ({"run": RUN}, {}),
    "structures in a structure": ({"data": {"log": RUN}}, {}),
    "columns and rows": ({name: values[:, None] if name < "q" else values[None, :] for name, values in RUN.items()}, {}),
    "three dimensions": ({name: values.reshape(1, 1, -1) for name, values in RUN.items()}, {}),
    "time in ms": ({**RUN, "t_s": T_S * 1e3}, {"t_s": "t_s*0.001"}),
    "time_ms": ({**{name: RUN[name] for name in FOUR}, "time_ms": T_S * 1e3}, {}),
    "dSPACE by its names": (
        {"e": {"X": {"Name": "time", "Data": T_S}, "Y": [{"Name": f"Model Root/{name}", "Data": RUN[name]} for name in FOUR]}},
        {},
    ),
    "cells of signals with names": ({"logs": [{"signalName": name, "time": T_S, "data": RUN[name]} for name in FOUR]}, {}),
    "a scope by its labels": ({"Scope": {"time": T_S, "signals": SCOPE, "blockName": "m/Scope"}}, {}),
    "a scope by its places": (
        {"Scope": {"time": T_S, "signals": SCOPE}},
        {name: f"Scope.signals({place}).values" for place, name in enumerate(FOUR, start=1)},
    ),
    "structures with time": (
        {f"s{name}": {"time": T_S, "signals": {"values": RUN[name], "label": ""}} for name in FOUR},
        {name: f"s{name}.signals.values" for name in FOUR},
    ),
    "structure with time, wide": (
        {"S": {"time": T_S, "signals": {"values": MATRIX[1:].T}}},
        {name: f"S.signals.values(:,{place})" for place, name in enumerate(FOUR, start=1)},
    ),
    "a matrix of To File": ({"ans": MATRIX}, {name: f"ans({place},:)" for place, name in enumerate(RUN, start=1)}),
    "tout and yout": (
        {"tout": T_S, "yout": MATRIX[1:].T},
        {name: f"yout(:,{place})" for place, name in enumerate(FOUR, start=1)},
    ),
    "timeseries": ({f"{name}_ts": {"Name": name, "Time": T_S, "Data": RUN[name]} for name in FOUR}, {}),
    "timeseries by their fields": (
        {f"x{place}": {"Time": T_S, "Data": RUN[name]} for place, name in enumerate(FOUR)},
        {name: f"x{place}.Data" for place, name in enumerate(FOUR)},
    ),
    "degrees and millivolts": (
        {"time": T_S, "um_mV": 1e3 * RUN["u_M_V"], "ut_mV": 1e3 * RUN["u_T_V"]}
        | {name: np.degrees(RUN[f"{name[:3]}_rad"]) for name in ("psi_deg", "phi_deg")},
        {"u_M_V": "um_mV", "u_T_V": "ut_mV", "phi_rad": "phi_deg*pi/180"},
    ),
    "a negative sign": ({**RUN, "psi_rad": -RUN["psi_rad"]}, {"psi_rad": "-psi_rad"}),
    "no times at all": ({name: RUN[name] for name in FOUR}, {"t_s": "row*0.01"}),
    "a sample period alone": ({**{name: RUN[name] for name in FOUR}, "Ts": 0.01}, {"t_s": "Ts*row"}),
    "names beside a matrix": ({"log": MATRIX.T, "names": NAMES, "K": np.eye(5), "sizes": np.ones((2, 5))}, {}),
    "names beside rows": ({"log": MATRIX, "names": NAMES}, {}),
    "importdata": ({"S": {"data": MATRIX.T, "colheaders": NAMES, "textdata": NAMES}}, {}),
    "a char matrix of names": ({"tout": T_S, "yout": MATRIX[1:].T, "names": np.array(FIVE[1:])}, {}),
    "names with units beside": (
        {"log": MATRIX.T * 1e3, "names": np.array(["t", "u_M", "u_T", "psi", "phi [mrad]"], object)}
        | {"units": np.array(["ms", "mV", "mV", "mrad", "mrad"], object)},
        {},
    ),
    "cells": ({"log": CELLS}, {name: f"log({place})" for place, name in enumerate(RUN, start=1)}),
    "ticks of 16 bits": ({**{name: RUN[name] for name in FOUR}, "millis": (T_S * 1e3).round() % 65536}, {}),
}  # fmt: skip


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_of_matlab_file_gives_the_run(kind: str, tmp_path: Path) -> None:
    saved, said = KINDS[kind]
    savemat(tmp_path / "run.mat", saved)
    log = imported_here(tmp_path / "run.mat", mapped(**said)).log
    for name, values in RUN.items():
        np.testing.assert_allclose(log.column(name), values, rtol=1e-14, atol=1e-15)
    assert log.sample_period_s == 0.01


def test_version_4_is_read(tmp_path: Path) -> None:
    savemat(tmp_path / "run.mat", RUN, format="4")
    np.testing.assert_array_equal(
        imported_here(tmp_path / "run.mat", ColumnMapping()).log.column("psi_rad"), RUN["psi_rad"]
    )


def test_structures_with_the_same_fields_are_named_and_a_group_is_taken(tmp_path: Path) -> None:
    """Truth: run2 is half of run1; neither may win silently, whatever their order."""
    half = {**RUN, "psi_rad": 0.5 * RUN["psi_rad"], "t_s": T_S + 5.0}
    savemat(tmp_path / "two.mat", {"run1": RUN, "run2": half})
    with pytest.raises(
        BadInput, match=r"run1\.psi_rad .* or run2\.psi_rad .*--column psi_rad=run1\.psi_rad, or --group run1"
    ):
        imported_here(tmp_path / "two.mat", ColumnMapping())
    second = imported_here(tmp_path / "two.mat", ColumnMapping(group="run2")).log
    np.testing.assert_array_equal(second.column("psi_rad"), half["psi_rad"])
    assert second.t_s[0] == 5.0  # its own times with it
    with pytest.raises(BadInput, match="nothing under 'run3'"):
        imported_here(tmp_path / "two.mat", ColumnMapping(group="run3"))


def test_a_sparse_vector_is_a_vector_and_a_sparse_matrix_is_left_alone(tmp_path: Path) -> None:
    sparse = {"psi_rad": csc_matrix(RUN["psi_rad"][:, None]), "K": csc_matrix(np.eye(3))}
    done = imported_here(save_run(tmp_path / "run.mat", **sparse), ColumnMapping())
    np.testing.assert_array_equal(done.log.column("psi_rad"), RUN["psi_rad"])


def test_complex_numbers_without_an_imaginary_part_are_real_and_others_are_refused(tmp_path: Path) -> None:
    path = save_run(tmp_path / "run.mat", psi_rad=RUN["psi_rad"] + 0j)
    np.testing.assert_array_equal(imported_here(path, ColumnMapping()).log.column("psi_rad"), RUN["psi_rad"])
    with pytest.raises(BadInput, match="complex numbers"):
        imported_here(save_run(tmp_path / "run.mat", psi_rad=RUN["psi_rad"] + 0.1j), ColumnMapping())


def test_the_label_of_a_scope_s_signal_names_its_values_and_not_its_dimensions(tmp_path: Path) -> None:
    """Truth: To Workspace saves one signal whose values lie along the third axis, with label and dimensions beside them."""
    signals = {"values": RUN["psi_rad"].reshape(1, 1, -1), "dimensions": np.array([1, 1]), "label": "psi_rad"}
    path = save_run(tmp_path / "run.mat", psi_rad=None, elevation={"time": T_S, "signals": signals})
    np.testing.assert_array_equal(imported_here(path, ColumnMapping()).log.column("psi_rad"), RUN["psi_rad"])


def test_of_several_matrices_it_is_told_how_many_vectors_each_holds(tmp_path: Path) -> None:
    """Truth: two scopes of two signals each, as Simulink's structure with time has them."""
    scopes = {
        name: {"time": T_S, "signals": {"values": np.column_stack([RUN[column] for column in columns])}}
        for name, columns in (("In", ("u_M_V", "u_T_V")), ("Out", ("psi_rad", "phi_rad")))
    }
    savemat(tmp_path / "run.mat", scopes)
    with pytest.raises(BadInput) as refused:
        imported_here(tmp_path / "run.mat", ColumnMapping())
    assert "In.signals.values(:,1..2)" in refused.value.got
    assert "Out.signals.values(:,1..2)" in refused.value.got


def test_names_beside_a_matrix_are_told_and_taken_only_where_one_array_of_them_fits_one_matrix(tmp_path: Path) -> None:
    """Truth: the columns by their places and by their names are the same ones; two matrices, or two arrays of names, are asked for."""
    named = {"log": MATRIX.T, "names": NAMES}
    savemat(tmp_path / "run.mat", named)
    done = imported_here(tmp_path / "run.mat", mapped(psi_rad="log(:,4)"))
    np.testing.assert_array_equal(done.log.column("psi_rad"), RUN["psi_rad"])
    assert done.found[0] == "log has the columns that names names: t_s, u_M_V, u_T_V, psi_rad, phi_rad"
    for other in ({"second": MATRIX.T}, {"others": np.array(list("abcde"), object)}):
        savemat(tmp_path / "two.mat", named | other)
        with pytest.raises(BadInput, match="columns t_s, u_M_V"):
            imported_here(tmp_path / "two.mat", ColumnMapping())


@pytest.mark.parametrize("stated", [str, lambda unit: {"Name": unit}])
def test_a_timeseries_as_a_structure_keeps_the_units_of_its_data_and_times(
    stated: Callable[[str], object], tmp_path: Path
) -> None:
    """Truth: what MATLAB's get(ts) holds: degrees beside the data, as a text or as Simulink's unit, milliseconds beside the times."""
    angles = ("psi_rad", "phi_rad")
    saved = {
        name: {
            "Time": 1e3 * T_S,
            "TimeInfo": {"Units": "milliseconds", "Start": 0.0},
            "Data": np.degrees(RUN[name]) if name in angles else RUN[name],
            "DataInfo": {"Units": stated("deg" if name in angles else "V"), "UserData": np.zeros((0, 0))},
        }
        for name in FOUR
    }
    savemat(tmp_path / "run.mat", saved)
    log = imported_here(tmp_path / "run.mat", ColumnMapping()).log
    for name, values in RUN.items():
        np.testing.assert_allclose(log.column(name), values, rtol=1e-12, atol=1e-12)
