"""Tables of text: their header, what stands beside it, several recordings in one file, packed ones."""

import gzip
import shlex
from pathlib import Path

import numpy as np
import pytest

from recordings.channels import Span
from recordings.importing import import_file
from recordings.mapping.mapping import ColumnMapping
from records.errors import BadInput
from tests.recordings.here import imported_here
from tests.recordings.runs import RUN, T_S


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
    assert any("times begin again at 1 place:" in told and "from 3 s here" in told for told in done.found)
    assert any("the header stands again in line 202" in told for told in done.found)
    second = imported_here(tmp_path / "run.csv", ColumnMapping(), Span(3.0)).log
    np.testing.assert_allclose(second.column("psi_rad"), 0.5 * t_s, atol=1e-12)


@pytest.mark.parametrize("ending", [".mat", ".parquet", ".npz", ".mf4", ".xlsx", ".ulg"])
def test_a_table_of_text_under_the_ending_of_another_kind_is_read_and_said(tmp_path: Path, ending: str) -> None:
    log = tmp_path / f"run{ending}"
    log.write_text("t_s,u_M_V,u_T_V,psi_rad,phi_rad\n" + "\n".join(f"{t:.2f},5,1,{t:.2f},0" for t in T_S))
    done = import_file(log, ColumnMapping())
    np.testing.assert_allclose(done.log.column("psi_rad"), T_S, atol=0.005)
    assert f"the ending '{ending}': taken as a table of text" in done.found


@pytest.mark.parametrize("ending", [".mat", ".npy", ".json", ".csv"])
def test_a_file_of_one_format_under_the_ending_of_another_is_refused_by_what_it_is(tmp_path: Path, ending: str) -> None:
    log = tmp_path / f"run{ending}"
    log.write_bytes(b"PAR1\x15\x04\x15\x80\0\x01\xff")
    with pytest.raises(BadInput, match=r"got a Parquet file.*give it its own ending"):
        import_file(log, ColumnMapping())


def test_a_packed_table_is_read_and_half_of_one_is_refused(tmp_path: Path) -> None:
    text = "t_s,u_M_V,u_T_V,psi_rad,phi_rad\n" + "\n".join(f"{t:.2f},5,1,{t},0" for t in T_S)
    packed = gzip.compress(text.encode())
    (tmp_path / "run.csv.gz").write_bytes(packed)
    np.testing.assert_allclose(import_file(tmp_path / "run.csv.gz", ColumnMapping()).log.column("psi_rad"), T_S)
    (tmp_path / "half.csv.gz").write_bytes(packed[: len(packed) // 2])
    with pytest.raises(BadInput, match=r"no whole \.gz file"):
        import_file(tmp_path / "half.csv.gz", ColumnMapping())


def test_times_that_are_text_are_shown_as_they_stand(tmp_path: Path) -> None:
    rows = [f"'{1000 + k},{k % 10},5,1.8,0,0.1" for k in range(9)]
    (tmp_path / "run.csv").write_text("\n".join(["t_ms,k,u_M_V,u_T_V,psi_rad,phi_rad", *rows]))
    with pytest.raises(BadInput, match=r"t_ms \(text, as line 2: \"'1000\""):
        imported_here(tmp_path / "run.csv", ColumnMapping())


def test_signals_that_are_written_each_in_rows_of_its_own_are_the_run(tmp_path: Path) -> None:
    """Truth: u_M, u_T, psi and phi in turn, 1 ms apart, one a row; the last column is empty in the first 500 rows of the file."""
    t_s = 0.01 * np.arange(300)
    u_V, psi = 5.0 + np.sin(9.0 * t_s), 0.1 * t_s**2
    turns = [(0.0, "{},,,,"), (0.001, ",1.5,,,"), (0.002, ",,{},,"), (0.003, ",,,0.25,")]
    numbers = (u_V, u_V, psi, psi)
    rows = [
        f"{t + late:.3f}," + form.format(f"{of[k]:.9f}")
        for k, t in enumerate(t_s)
        for (late, form), of in zip(turns, numbers, strict=True)
    ]
    rows[900] += "7"
    (tmp_path / "run.csv").write_text("t_s,u_M_V,u_T_V,psi_rad,phi_rad,psi_ref_rad\n" + "\n".join(rows))
    done = imported_here(tmp_path / "run.csv", ColumnMapping())
    np.testing.assert_allclose(done.log.t_s[::2], t_s + 0.002, atol=1e-9)
    np.testing.assert_allclose(done.log.column("psi_rad")[::2], psi, atol=1e-9)
    np.testing.assert_allclose(done.log.column("u_M_V")[::2], u_V, atol=1e-9)
    np.testing.assert_allclose(done.log.column("phi_rad")[1::2], 0.25)
    assert "u_M_V has a number in 300 of 1200 rows, and holds it until the next" in done.found
    assert "psi_ref_rad" in done.log.extra


def test_an_input_that_was_not_logged_for_a_while_is_not_held(tmp_path: Path) -> None:
    rows = [f"{0.01 * k:.2f},{'' if 100 <= k < 200 else 5},1,{0.001 * k},0" for k in range(260)]
    (tmp_path / "run.csv").write_text("t_s,u_M_V,u_T_V,psi_rad,phi_rad\n" + "\n".join(rows))
    with pytest.raises(BadInput, match=r"no number at 1 s, in 100 of 260 rows"):
        imported_here(tmp_path / "run.csv", ColumnMapping())


def long_form(heads: str, form: str) -> str:
    """u_M, u_T, psi and phi at each of 100 instants, a row each."""
    t_s = 0.01 * np.arange(100)
    names = {"u_M_V": 5.0 + t_s, "u_T_V": 0.0 * t_s, "psi_rad": 0.1 * t_s**2, "phi_rad": -t_s}
    rows = (
        form.format(t=f"{t:.2f}", n=name, v=f"{of[k]:.9f}") for k, t in enumerate(t_s) for name, of in names.items()
    )
    return "\n".join([heads, *rows])


@pytest.mark.parametrize(
    ("heads", "form"), [("time,name,value", "{t},{n},{v}"), ("_value;_field;_time", "{v};{n};{t}")]
)
def test_a_table_of_a_signal_a_row_is_the_run(heads: str, form: str, tmp_path: Path) -> None:
    (tmp_path / "run.csv").write_text(long_form(heads, form))
    done = imported_here(tmp_path / "run.csv", ColumnMapping())
    t_s = 0.01 * np.arange(100)
    np.testing.assert_allclose(done.log.t_s, t_s, atol=1e-9)
    np.testing.assert_allclose(done.log.column("psi_rad"), 0.1 * t_s**2, atol=1e-9)
    np.testing.assert_allclose(done.log.column("u_M_V"), 5.0 + t_s, atol=1e-9)
    assert any("a signal a row, by its name under" in told for told in done.found)


def test_a_state_that_stays_is_no_name_of_a_signal(tmp_path: Path) -> None:
    rows = "\n".join(f"{0.01 * k:.2f},{'IDLE' if k < 50 else 'FLY'},{0.001 * k}" for k in range(100))
    (tmp_path / "run.csv").write_text(f"t_s,state,psi_rad\n{rows}")
    done = imported_here(tmp_path / "run.csv", ColumnMapping({"u_M_V": "0", "u_T_V": "0", "phi_rad": "0"}))
    np.testing.assert_allclose(done.log.column("psi_rad"), 0.001 * np.arange(100))


def _rows(**cells: str) -> list[str]:
    """Rows of a run as text of six decimals; `cells` are what stands in row N, column psi_rad, as rN."""
    made = [f"{t:.2f},{5 + t:.6f},1.800000,{10 + t:.6f},{20 - t:.6f}" for t in T_S]
    for name, cell in cells.items():
        row = int(name[1:])
        made[row] = ",".join([*made[row].split(",")[:3], cell, made[row].split(",")[4]])
    return made


HEAD = "t_s,u_M_V,u_T_V,psi_rad,phi_rad\n"


@pytest.mark.parametrize("cell", ["#NV", "#WERT!", "#VALEUR!", "#¡DIV/0!", "#REF!", "."])
def test_what_a_spreadsheet_writes_for_no_value_in_any_language_is_none(cell: str, tmp_path: Path) -> None:
    (tmp_path / "run.csv").write_text(HEAD + "\n".join(_rows(r7=cell)) + "\n", encoding="utf-8")
    psi_rad = imported_here(tmp_path / "run.csv", ColumnMapping()).log.column("psi_rad")
    assert np.flatnonzero(np.isnan(psi_rad)).tolist() == [7]


@pytest.mark.parametrize("separator", [",", ";", "\t", " "])
@pytest.mark.parametrize(
    "cell",
    [
        "#DIV/0!",
        "#N/A",
        "#REF!",
        "#NAME?",
        "#VALUE!",
        "#NUM!",
        "#NULL!",
        "#NV",
        "#N/D",
        "#WERT!",
        "#¡DIV/0!",
        "#¿NOMBRE?",
        "#ERROR!",
    ],
)
def test_a_row_that_begins_with_a_spreadsheet_s_error_lacks_that_cell_only(
    cell: str, separator: str, tmp_path: Path
) -> None:
    """Truth: the row stands at its time, the last cell, with the other output; none is a comment."""
    rows = [f"{10 + t:.6f},{20 - t:.6f},{5 + t:.6f},1.800000,{t:.2f}" for t in T_S]
    rows[7] = f"{cell},{rows[7].partition(',')[2]}"
    table = "\n".join(["psi_rad,phi_rad,u_M_V,u_T_V,t_s", *rows]) + "\n"
    (tmp_path / "run.csv").write_text(table.replace(",", separator), encoding="utf-8")
    done = imported_here(tmp_path / "run.csv", ColumnMapping())
    assert np.flatnonzero(np.isnan(done.log.column("psi_rad"))).tolist() == [7]
    np.testing.assert_allclose(done.log.column("phi_rad"), 20.0 - T_S, atol=1e-6)
    assert not any("comment" in told for told in done.found)


@pytest.mark.parametrize(
    "remark", ["#WARNING! the rotor stands", "#NOTE, begin, of, the, step", "# 1,2,3,4,5", "#ERROR", "## 3 4"]
)
def test_a_remark_between_rows_is_none_of_them(remark: str, tmp_path: Path) -> None:
    rows = _rows()
    (tmp_path / "run.csv").write_text(HEAD + "\n".join([*rows[:7], remark, *rows[7:]]) + "\n")
    done = imported_here(tmp_path / "run.csv", ColumnMapping())
    np.testing.assert_allclose(done.log.column("psi_rad"), 10.0 + T_S, atol=1e-6)
    assert "1 line of comment" in done.found


@pytest.mark.parametrize("minus", ["−", "–", "﹣", "－"])
def test_a_typesetter_s_minus_is_a_minus(minus: str, tmp_path: Path) -> None:
    (tmp_path / "run.csv").write_text(HEAD + "\n".join(_rows(r7=f"{minus}3.5")) + "\n", encoding="utf-8")
    assert imported_here(tmp_path / "run.csv", ColumnMapping()).log.column("psi_rad")[7] == -3.5


@pytest.mark.parametrize("heading", ["psi_[deg]", "psi <deg>", "psi - deg", "psi: [deg]", "psi_ (°)"])
def test_a_heading_may_set_its_unit_apart_in_other_ways(heading: str, tmp_path: Path) -> None:
    (tmp_path / "run.csv").write_text(HEAD.replace("psi_rad", heading) + "\n".join(_rows()) + "\n", encoding="utf-8")
    psi_rad = imported_here(tmp_path / "run.csv", ColumnMapping()).log.column("psi_rad")
    np.testing.assert_allclose(psi_rad, np.radians(10.0 + T_S), atol=1e-6)


@pytest.mark.parametrize("name", ["Datum", "Date", "Zeitstempel"])
def test_a_spreadsheet_s_days_under_the_name_of_a_date_are_the_clock(name: str, tmp_path: Path) -> None:
    rows = [f"{45418.0 + 10.0 * t / 86400.0:.10f},{row.partition(',')[2]}" for t, row in zip(T_S, _rows(), strict=True)]
    (tmp_path / "run.csv").write_text(HEAD.replace("t_s", name) + "\n".join(rows) + "\n")
    log = imported_here(tmp_path / "run.csv", ColumnMapping()).log
    np.testing.assert_allclose(log.t_s, 10.0 * T_S, atol=2e-5)  # a double holds a date's days to 1e-5 s


def test_a_sum_without_a_label_behind_an_empty_line_is_no_row(tmp_path: Path) -> None:
    (tmp_path / "run.csv").write_text(HEAD + "\n".join(_rows()) + "\n\n,5.1,1.8,10.2,19.8\n")
    done = imported_here(tmp_path / "run.csv", ColumnMapping())
    np.testing.assert_allclose(done.log.t_s, T_S)
    assert any("left out, from line 53 on" in told for told in done.found)


def test_a_sum_that_has_no_time_is_no_row(tmp_path: Path) -> None:
    (tmp_path / "run.csv").write_text(HEAD + "\n".join(_rows()) + "\n,5.1,1.8,10.2,19.8\n")
    done = imported_here(tmp_path / "run.csv", ColumnMapping())
    np.testing.assert_allclose(done.log.t_s, T_S)
    assert "1 row without a time at the end left out" in done.found


def test_the_step_that_is_proposed_for_stamps_of_whole_seconds_is_that_of_the_rows(tmp_path: Path) -> None:
    """Truth: rows 0.1 s apart from 0.5 s on, written down with whole seconds: 5 rows of 0, 10 of 1, 5 of 2."""
    rows = [f"{int(0.5 + 0.1 * row + 1e-9)},5,1.8,{row},{row}" for row in range(20)]
    (tmp_path / "run.csv").write_text(HEAD + "\n".join(rows) + "\n")
    with pytest.raises(BadInput, match=r"t_s=0\.1\*row"):
        imported_here(tmp_path / "run.csv", ColumnMapping())


@pytest.mark.parametrize(("cut", "rows"), [(0, 50), (3, 49), (8, 49)])
def test_a_last_row_that_ends_within_a_number_is_left_out(cut: int, rows: int, tmp_path: Path) -> None:
    """Truth: no line end stands behind the last row; its last number has all of its digits, or lacks some, or all."""
    text = HEAD + "\n".join(_rows())
    (tmp_path / "run.csv").write_text(text[: len(text) - cut])
    done = imported_here(tmp_path / "run.csv", ColumnMapping())
    assert len(done.log.t_s) == rows
    assert any("line 51, the last" in told for told in done.found) == (rows == 49)


@pytest.mark.parametrize(("last", "rows"), [("0.6", 50), ("0", 49)])
def test_a_last_number_of_fewer_decimals_stays_where_it_goes_on_from_those_above(
    last: str, rows: int, tmp_path: Path
) -> None:
    """Truth: without a last line end, an azimuth printed without its last zeros, 0.0125 rad further in each row: up to 0.6 rad, or cut
    short."""
    azimuth = [f"{0.6 + 0.0125 * (place - 49):g}" for place in range(49)] + [last]
    lines = [f"{row.rpartition(',')[0]},{cell}" for row, cell in zip(_rows(), azimuth, strict=True)]
    (tmp_path / "run.csv").write_text(HEAD + "\n".join(lines))
    assert len(imported_here(tmp_path / "run.csv", ColumnMapping()).log.t_s) == rows


def test_zero_bytes_that_a_crash_left_between_rows_are_passed_over_and_a_row_that_they_cut_is_told(
    tmp_path: Path,
) -> None:
    rows = [f"{row}\n".encode() for row in _rows()]
    (tmp_path / "run.csv").write_bytes(HEAD.encode() + b"".join(rows[:20]) + bytes(300) + b"".join(rows[20:]))
    done = imported_here(tmp_path / "run.csv", ColumnMapping())
    np.testing.assert_allclose(done.log.t_s, T_S)
    assert any("300 zero bytes within the text, first in line 22" in told for told in done.found)
    (tmp_path / "run.csv").write_bytes(HEAD.encode() + b"".join(rows[:20])[:-4] + bytes(300) + b"".join(rows[20:])[5:])
    done = imported_here(tmp_path / "run.csv", ColumnMapping())
    np.testing.assert_allclose(done.log.t_s, np.delete(T_S, [19, 20]))
    assert any("the rows that they cut are left out" in told for told in done.found)
    (tmp_path / "run.csv").write_bytes(bytes(range(256)) * 20)
    with pytest.raises(BadInput, match="bytes that are no text"):
        imported_here(tmp_path / "run.csv", ColumnMapping())


@pytest.mark.parametrize(
    "stamps",
    [
        [f"{t:.3f}" for t in T_S],
        [f"2026-03-01T23:59:59.{round(1e3 * t):03d}Z" for t in T_S],
    ],
)
def test_stamps_of_a_parquet_file_may_be_texts_and_other_texts_are_none(
    stamps: list[str | None], tmp_path: Path
) -> None:
    pa, parquet = pytest.importorskip("pyarrow"), pytest.importorskip("pyarrow.parquet")
    columns = {**RUN, "t_s": stamps, "phi_rad": [f"{phi!r}" for phi in RUN["phi_rad"].tolist()], "state": ["up"] * 50}
    parquet.write_table(pa.table(columns), tmp_path / "run.parquet")
    log = imported_here(tmp_path / "run.parquet", ColumnMapping()).log
    np.testing.assert_allclose(log.t_s, T_S, atol=1e-9)
    np.testing.assert_array_equal(log.column("phi_rad"), RUN["phi_rad"])
