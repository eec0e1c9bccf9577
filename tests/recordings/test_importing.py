"""Files of other tools become run logs with their own times and in SI units; what is missing, mis-scaled or broken is refused by name."""

import gzip
import shlex
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.io import savemat
from scipy.sparse import csc_matrix

from recordings.channels import Channel, Span, log_of_channels
from recordings.importing import import_file
from recordings.mapping.mapping import ColumnMapping
from records.errors import BadInput
from records.log import load_log
from sim.columns import log_columns
from sim.plants import MODELS
from tests.recordings.here import imported_here
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
        "u_M_V": Channel(np.array([-1.0, 0.015]), np.array([5.0, 6.0])),
        "u_T_V": Channel(np.array([0.0]), np.array([2.0])),
        "psi_rad": Channel(np.array([0.0, 0.01, 0.02 + 1e-12]), np.array([0.1, 0.2, 0.3])),
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
        (_without("t_s"), r"column 't_s': got u_M_V, u_T_V, psi_rad, phi_rad, .*--column t_s=NAME"),
        (_without("phi_rad"), r"columns phi_rad: got t_s, u_M_V, u_T_V, psi_rad, .*--column phi_rad=SIGNAL"),
        ({"phi_rad": np.zeros(49)}, r"column 'phi_rad': got 49 values where t_s has 50"),
        ({"t_s": T_S[::-1]}, r"times of psi_rad: got 0\.48 s in row 2 after 0\.49 s"),
        ({"t_s": np.where(T_S == 0.1, np.nan, T_S)}, "times of psi_rad: got nan s in row 11"),
        ({"u_M_V": np.where(T_S > 0.2, np.nan, 5.0)}, r"column 'u_M_V': got no number at 0\.21 s, in 29 of 50 rows"),
        ({"loop": "sideways"}, "text 'loop': got 'sideways'"),
    ],
)
def test_a_wrong_matlab_file_is_refused_by_name(tmp_path: Path, changes: dict[str, Any], message: str) -> None:
    with pytest.raises(BadInput, match=message):
        imported_here(_saved(tmp_path / "run.mat", **changes), ColumnMapping())


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
    whole = _saved(tmp_path / "whole.mat").read_bytes()
    for length in range(0, len(whole), 97):
        (tmp_path / "cut.mat").write_bytes(whole[:length])
        with pytest.raises(BadInput):
            imported_here(tmp_path / "cut.mat", ColumnMapping())


def test_an_input_that_begins_too_late_is_refused() -> None:
    channels = {name: Channel(T_S, values) for name, values in RUN.items() if name != "t_s"}
    channels["u_M_V"] = Channel(T_S[5:], RUN["u_M_V"][5:])
    with pytest.raises(
        BadInput, match=r"column 'u_M_V': got its first sample at 0\.05 s, expected one by 0 s.*--from 0\.05"
    ):
        log_of_channels(channels, CE150, "here")
    assert log_of_channels(channels, CE150, "here", span=Span(0.05)).t_s[0] == 0.05


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


def _mapped(**columns: str) -> ColumnMapping:
    return ColumnMapping(columns=columns)


CELLS = np.empty((1, 5), object)
CELLS[0] = list(RUN.values())
FOUR = {"u_M_V": "u_M_V", "u_T_V": "u_T_V", "psi_rad": "psi_rad", "phi_rad": "phi_rad"}
MATRIX = np.vstack([RUN[name] for name in RUN])
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
    "cells": ({"log": CELLS}, {name: f"log({place})" for place, name in enumerate(RUN, start=1)}),
    "ticks of 16 bits": ({**{name: RUN[name] for name in FOUR}, "millis": (T_S * 1e3).round() % 65536}, {}),
}  # fmt: skip


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_of_matlab_file_gives_the_run(kind: str, tmp_path: Path) -> None:
    saved, said = KINDS[kind]
    savemat(tmp_path / "run.mat", saved)
    log = imported_here(tmp_path / "run.mat", _mapped(**said)).log
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


def test_an_expression_of_times_takes_each_columns_own_times(tmp_path: Path) -> None:
    """Truth: psi and phi have clocks of their own, both in ms; the inputs lie on that of psi."""
    late = T_S + 0.003
    stamped = {
        name: {"Time": 1e3 * (late if name == "phi_rad" else T_S), "Data": RUN[name], "Name": name} for name in FOUR
    }
    savemat(tmp_path / "run.mat", stamped)
    log = imported_here(
        tmp_path / "run.mat", _mapped(t_s="psi_rad.Time*0.001", phi_rad="phi_rad.Data", psi_rad="psi_rad.Data")
    ).log
    rows = ~np.isnan(log.column("phi_rad"))
    np.testing.assert_allclose(log.t_s[rows], late, atol=1e-12)
    assert log.sample_period_s == pytest.approx(0.01)


@pytest.mark.parametrize(
    ("said", "told"),
    [
        ({"psi_rad": "psi_rad*0"}, "a factor of 0"),
        ({"psi_rad": "psi_rad*nan"}, "no finite number"),
        ({"psi_rad": "psi_rad*gain"}, r"name 'gain': got t_s, u_M_V"),
        ({"psi_rad": "psi_rad(:,2)"}, "an array of 50, expected one row or column"),
        ({"psi_rad": "K"}, "6 values where t_s has 50"),
        ({"psi_rad": "K + psi_rad"}, "one clock|samples in one expression"),
        ({"psi_rad": "gains"}, r"a matrix of 3 x 3, .*gains\(:,1\)"),
        ({"psi_rad": "u_M_V"}, ""),
        ({"t_s": "-t_s"}, "times that increase"),
        ({"t_s": "K"}, "50 values at 6 times"),
        ({"t_s": "0.01"}, "a constant"),
        ({"psi_rad": "log(-1 - psi_rad*psi_rad)"}, "no finite number from it"),
        ({"theta_rad": "psi_rad"}, "an unknown column"),
    ],
)  # fmt: skip
def test_a_mapping_that_gives_no_column_is_refused(said: dict[str, str], told: str, tmp_path: Path) -> None:
    savemat(tmp_path / "run.mat", {**RUN, "K": np.arange(6.0), "gains": np.eye(3)})
    if not told:  # one letter at a name's end is no unit where it does not fit
        assert imported_here(tmp_path / "run.mat", _mapped(**said)).log.column("psi_rad")[0] == 5.0
        return
    with pytest.raises(BadInput, match=told):
        imported_here(tmp_path / "run.mat", _mapped(**said))


def test_a_part_is_cut_before_anything_is_checked(tmp_path: Path) -> None:
    """Truth: rows 30 on are unusable in four ways; up to 0.2 s nothing of that counts."""
    bad = {**RUN, "u_M_V": np.where(T_S > 0.3, np.nan, RUN["u_M_V"]), "t_s": np.where(T_S > 0.4, 0.0, T_S)}
    log = imported_here(
        _saved(tmp_path / "run.mat", **{**bad, "t_s": np.where(T_S > 0.4, 1.0, T_S)}), ColumnMapping(), Span(0.05, 0.2)
    ).log
    np.testing.assert_allclose(log.t_s, T_S[5:21])
    rows = [f"{t:.2f},5,1,{'x' if t > 0.3 else 0.1 * t:},0" for t in T_S]
    (tmp_path / "run.csv").write_text("t_s,u_M_V,u_T_V,psi_rad,phi_rad\n" + "\n".join(rows))
    assert len(imported_here(tmp_path / "run.csv", ColumnMapping(), Span(until_s=0.2)).log.t_s) == 21
    with pytest.raises(
        BadInput, match=r"line 33.*'psi_rad': got 'x' among cells separated by comma \(and 18 more\).* it is at 0\.31 s"
    ):
        imported_here(tmp_path / "run.csv", ColumnMapping())
    with pytest.raises(BadInput, match=r"--from, --until.*0 rows.*0 s to 0\.49 s"):
        imported_here(tmp_path / "run.csv", ColumnMapping(), Span(7.0))


def test_a_column_that_nobody_asked_for_does_not_stand_in_the_way(tmp_path: Path) -> None:
    """Truth: the reference begins late and has a text in it; it is NaN there, and said to be."""
    rows = [f"{t:.2f},5,1,{t},0,{'-' if t < 0.1 else 'x' if t > 0.45 else 1}" for t in T_S]
    (tmp_path / "run.csv").write_text("t_s,u_M_V,u_T_V,psi_rad,phi_rad,psi_ref_rad\n" + "\n".join(rows))
    done = imported_here(tmp_path / "run.csv", ColumnMapping())
    assert np.flatnonzero(np.isnan(done.log.extra["psi_ref_rad"])).tolist() == [*range(10), 46, 47, 48, 49]
    assert "psi_ref_rad has no sample in 14 of 50 rows" in done.found
    savemat(
        tmp_path / "run.mat", {**RUN, "a": {"psi_ref_rad": T_S}, "b": {"psi_ref_rad": T_S}, "phi_ref_rad": np.zeros(7)}
    )
    done = imported_here(tmp_path / "run.mat", ColumnMapping())
    assert not done.log.extra
    assert any("psi_ref_rad is left out: it could be a.psi_ref_rad or b.psi_ref_rad" in told for told in done.found)
    assert any("phi_ref_rad is left out" in told for told in done.found)


def test_times_of_a_calendar_are_counted_from_the_first(tmp_path: Path) -> None:
    done = imported_here(_saved(tmp_path / "run.mat", t_s=T_S + 1_716_398_564.0), ColumnMapping(), Span(until_s=0.205))
    np.testing.assert_allclose(done.log.t_s, T_S[:21], atol=1e-6)
    assert any("counted from the first" in told for told in done.found)


@pytest.mark.parametrize(("per_second", "name"), [(1e3, "stamp"), (1e6, "stamp"), (1e9, "stamp"), (1e3, "t_s")])
def test_dates_in_parts_of_a_second_are_told_by_their_size(per_second: float, name: str, tmp_path: Path) -> None:
    stamps = {"t_s": None, name: np.round((T_S + 1_716_398_564.0) * per_second)}
    done = imported_here(_saved(tmp_path / "run.mat", **stamps), ColumnMapping())
    np.testing.assert_allclose(done.log.t_s, T_S, atol=1e-3 if per_second == 1e3 else 1e-6)


def test_a_sparse_vector_is_a_vector_and_a_sparse_matrix_is_left_alone(tmp_path: Path) -> None:
    sparse = {"psi_rad": csc_matrix(RUN["psi_rad"][:, None]), "K": csc_matrix(np.eye(3))}
    done = imported_here(_saved(tmp_path / "run.mat", **sparse), ColumnMapping())
    np.testing.assert_array_equal(done.log.column("psi_rad"), RUN["psi_rad"])


@pytest.mark.parametrize(
    ("factor", "unit"), [("0.001", "milliseconds"), ("1e-6", "microseconds"), ("1e-9", "nanoseconds")]
)
def test_times_that_look_like_parts_of_a_second_are_remarked(factor: str, unit: str, tmp_path: Path) -> None:
    done = imported_here(_saved(tmp_path / "run.mat", t_s=T_S / float(factor)), ColumnMapping())
    told = f"rows are {0.01 / float(factor):g} s apart: if times are in {unit}, say --column t_s=...*{factor}"
    assert told in done.found


def test_rows_minutes_apart_by_the_dates_of_a_file_are_not_remarked(tmp_path: Path) -> None:
    """Truth: five minutes between rows, by dates: no millisecond is meant."""
    rows = "".join(f"2026-10-07 09:{minute:02d}:00;1;0;{minute / 100};0\n" for minute in range(0, 60, 5))
    (tmp_path / "log.csv").write_text("When;u_M_V;u_T_V;psi_rad;phi_rad\n" + rows)
    done = imported_here(tmp_path / "log.csv", ColumnMapping())
    assert done.log.sample_period_s == 300.0
    assert not any("apart" in told for told in done.found)


@pytest.mark.parametrize("suffix", [".mat", ".parquet"])
def test_a_column_without_samples_is_named(suffix: str, tmp_path: Path) -> None:
    if suffix == ".parquet":
        parquet, pa = pytest.importorskip("pyarrow.parquet"), pytest.importorskip("pyarrow")
        parquet.write_table(pa.table({name: pa.array([], type=pa.float64()) for name in RUN}), tmp_path / "run.parquet")
    else:
        _saved(tmp_path / "run.mat", phi_rad=np.zeros(0))
    told = {".mat": r"psi_rad, phi_rad \(empty\)", ".parquet": "column 'u_M_V': got no sample of u_M_V"}[suffix]
    with pytest.raises(BadInput, match=told):
        imported_here(tmp_path / f"run{suffix}", ColumnMapping())


def test_counts_convert_by_the_turn(tmp_path: Path) -> None:
    changes = {"psi_rad": None, "psi_counts": np.arange(50.0)}
    path = _saved(tmp_path / "run.mat", **changes)
    with pytest.raises(BadInput, match="--per-turn N"):
        imported_here(path, ColumnMapping())
    log = imported_here(path, ColumnMapping(per_turn=4096.0)).log
    np.testing.assert_allclose(log.column("psi_rad"), np.arange(50.0) * 2.0 * np.pi / 4096.0)


def test_without_a_mapping_the_columns_are_named_and_one_is_proposed_that_works(tmp_path: Path) -> None:
    table = "Time [ms];Main motor (mV);Tail motor (mV);Elevation [deg];Azimuth [deg]\n"
    rows = "".join(f"{1e3 * t:g};{5e3 + t};1800;{10 * t};{-5 * t}\n" for t in T_S)
    (tmp_path / "rig.csv").write_text(table + rows)
    with pytest.raises(BadInput, match=r"Elevation \[deg\].*separated by semicolon") as refused:
        imported_here(tmp_path / "rig.csv", ColumnMapping())
    words = shlex.split(refused.value.remedy.partition("for example ")[2])
    said = dict(word.split("=", 1) for word in words if word != "--column")
    log = imported_here(tmp_path / "rig.csv", ColumnMapping(columns=said)).log
    np.testing.assert_allclose(log.column("psi_rad"), np.radians(10.0 * T_S), atol=1e-9)
    np.testing.assert_allclose(log.column("u_M_V"), 5.0 + 1e-3 * T_S, atol=1e-9)
    np.testing.assert_allclose(log.t_s, T_S, atol=1e-9)


def test_what_begins_before_the_inputs_is_left_out_and_said(tmp_path: Path) -> None:
    """Truth: u_M is known from 0.05 s on; asked for from 0.1 s on nothing is lost, and nothing said."""
    rows = [f"{t:.2f},{5 if t > 0.045 else ''},1,{t},0" for t in T_S]
    (tmp_path / "run.csv").write_text("t_s,u_M_V,u_T_V,psi_rad,phi_rad\n" + "\n".join(rows))
    done = imported_here(tmp_path / "run.csv", ColumnMapping())
    np.testing.assert_allclose(done.log.t_s, T_S[5:])
    assert "u_M_V begins at 0.05 s: 5 samples of the outputs in front of it are left out" in done.found
    assert not any(
        "begins at" in told for told in imported_here(tmp_path / "run.csv", ColumnMapping(), Span(0.1)).found
    )


def test_recordings_behind_one_another_are_counted_on_and_a_part_is_one_of_them(tmp_path: Path) -> None:
    """Truth: two runs of 2 s from 0 on, each with its header; the second half as far, on a clock that begins again."""
    t_s = 0.01 * np.arange(200)
    head = "t_s,u_M_V,u_T_V,psi_rad,phi_rad\n"
    runs = ["\n".join(f"{t:.2f},5,1,{share * t},0" for t in t_s) + "\n" for share in (1.0, 0.5)]
    (tmp_path / "run.csv").write_text(head + runs[0] + head + runs[1])
    done = imported_here(tmp_path / "run.csv", ColumnMapping())
    np.testing.assert_allclose(done.log.t_s, [*t_s, *(t_s + 3.0)], atol=1e-12)
    assert any("times begin again 1 times" in told and "from 3 s here" in told for told in done.found)
    assert any("the header stands again in line 202" in told for told in done.found)
    second = imported_here(tmp_path / "run.csv", ColumnMapping(), Span(3.0)).log
    np.testing.assert_allclose(second.column("psi_rad"), 0.5 * t_s, atol=1e-12)


def test_a_packed_table_is_read_and_half_of_one_is_refused(tmp_path: Path) -> None:
    text = "t_s,u_M_V,u_T_V,psi_rad,phi_rad\n" + "\n".join(f"{t:.2f},5,1,{t},0" for t in T_S)
    packed = gzip.compress(text.encode())
    (tmp_path / "run.csv.gz").write_bytes(packed)
    np.testing.assert_allclose(import_file(tmp_path / "run.csv.gz", ColumnMapping()).log.column("psi_rad"), T_S)
    (tmp_path / "half.csv.gz").write_bytes(packed[: len(packed) // 2])
    with pytest.raises(BadInput, match="no whole gzip file"):
        import_file(tmp_path / "half.csv.gz", ColumnMapping())


TURNED = {**RUN, "psi_rad": np.sin(9.0 * T_S), "phi_rad": np.cos(T_S)}


@pytest.mark.parametrize(
    ("times", "first_s"),
    [
        (np.round(T_S * 1e3 + 65436.0) % 65536, 65.436),  # millis() of 16 bits
        (739377.0 + T_S / 86400.0, 0.0),  # MATLAB's datenum
        (45418.0 + T_S / 86400.0, 0.0),  # a spreadsheet's days
    ],
)
def test_ticks_that_ran_over_and_dates_in_days_become_seconds(
    times: np.ndarray, first_s: float, tmp_path: Path
) -> None:
    named = {name: values for name, values in RUN.items() if name != "t_s"}
    savemat(tmp_path / "run.mat", {**named, "millis" if first_s else "time": times})
    log = imported_here(tmp_path / "run.mat", ColumnMapping()).log
    np.testing.assert_allclose(log.t_s, first_s + T_S, atol=2e-5)  # a double holds a date's days to 1e-5 s


def test_an_angle_within_one_turn_and_counts_of_16_bits_are_counted_on_and_that_is_said(tmp_path: Path) -> None:
    counts = np.round(TURNED["phi_rad"] * 4096.0 / (2.0 * np.pi) - 600.0)
    named = {name: TURNED[name] for name in ("t_s", "u_M_V", "u_T_V")}
    saved = {**named, "psi_deg": np.degrees(TURNED["psi_rad"]) % 360.0, "phi_counts": counts % 65536}
    savemat(tmp_path / "run.mat", saved)
    done = imported_here(tmp_path / "run.mat", ColumnMapping(per_turn=4096.0))
    np.testing.assert_allclose(done.log.column("psi_rad"), TURNED["psi_rad"], atol=1e-12)
    np.testing.assert_allclose(done.log.column("phi_rad"), counts * 2.0 * np.pi / 4096.0, atol=1e-12)
    assert any("leaps of a whole turn" in told for told in done.found)
    typed = imported_here(tmp_path / "run.mat", ColumnMapping({"psi_rad": "psi_deg*pi/180"}, per_turn=4096.0))
    assert typed.log.column("psi_rad").max() > 6.0
    assert any("unwrap(...) around it" in told for told in typed.found)


def test_samples_whose_time_does_not_rise_are_left_out_and_a_clock_that_mostly_stands_is_refused(
    tmp_path: Path,
) -> None:
    stamps = T_S.copy()
    stamps[[7, 30]] = stamps[6], stamps[20]
    savemat(tmp_path / "run.mat", {**RUN, "t_s": stamps})
    done = imported_here(tmp_path / "run.mat", ColumnMapping())
    np.testing.assert_array_equal(done.log.t_s, np.delete(T_S, [7, 30]))
    assert "psi_rad: 2 samples whose time does not rise left out, first at 0.06 s" in done.found
    savemat(tmp_path / "run.mat", {**RUN, "t_s": np.floor(T_S * 20.0) / 20.0})
    with pytest.raises(
        BadInput, match=r"expected times that increase; say --column t_s=0\.0[01]\d*\*row for rows so far apart"
    ):
        imported_here(tmp_path / "run.mat", ColumnMapping())


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


def test_times_that_are_text_are_shown_as_they_stand(tmp_path: Path) -> None:
    rows = [f"'{1000 + k},{k % 10},5,1.8,0,0.1" for k in range(9)]
    (tmp_path / "run.csv").write_text("\n".join(["t_ms,k,u_M_V,u_T_V,psi_rad,phi_rad", *rows]))
    with pytest.raises(BadInput, match=r"t_ms \(text, as line 2: \"'1000\""):
        imported_here(tmp_path / "run.csv", ColumnMapping())
