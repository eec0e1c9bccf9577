"""Tables of text as loggers and spreadsheets leave them: the same numbers come out of every layout, and the layout is told."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from recordings.formats.text.cells import number_and_unit
from recordings.formats.text.delimited import read
from recordings.layout import TextLayout
from records.errors import BadInput

T_S = np.arange(12) * 0.01
NAMES = ("t_s", "u_V", "q_m")
NUMBERS = np.column_stack([T_S, 1.5 + 0.25 * np.sin(9.0 * T_S), -0.125 * T_S])
TEXTS = [[f"{value:.7f}" for value in row] for row in NUMBERS]


def _rows(separator: str, rows: Sequence[Sequence[str]] = TEXTS, end: str = "\n") -> str:
    return "".join(separator.join(row) + end for row in rows)


def _comma(rows: Sequence[Sequence[str]]) -> list[list[str]]:
    return [[cell.replace(".", ",") for cell in row] for row in rows]


LAYOUTS = {
    "comma": (_rows(",", [NAMES, *TEXTS]).encode(), "separated by comma"),
    "semicolon": (_rows(";", [NAMES, *TEXTS]).encode(), "separated by semicolon"),
    "decimal comma": (_rows(";", [NAMES, *_comma(TEXTS)]).encode(), "semicolon with decimal commas"),
    "tab and decimal comma": (_rows("\t", [NAMES, *_comma(TEXTS)]).encode(), "tab with decimal commas"),
    "blanks": (_rows("   ", [NAMES, *TEXTS]).encode(), "blanks"),
    "bar": (_rows(" | ", [NAMES, *TEXTS]).encode(), "bar"),
    "mark, line ends of Windows": (b"\xef\xbb\xbf" + _rows(",", [NAMES, *TEXTS], "\r\n").encode(), "utf-8 by its mark"),
    "line ends of an old Mac": (_rows(",", [NAMES, *TEXTS], "\r").encode(), "comma"),
    "UTF-16": (_rows("\t", [NAMES, *TEXTS]).encode("utf-16"), "utf-16 by its mark"),
    "UTF-32": (_rows("\t", [NAMES, *TEXTS]).encode("utf-32"), "utf-32 by its mark"),
    "bars around": (("|" + "|\n|".join("|".join(row) for row in [NAMES, ("--", "--", "--"), *TEXTS]) + "|\n").encode(), "bar"),
    "UTF-16 without a mark": (_rows("\t", [NAMES, *TEXTS]).encode("utf-16-le"), "tab"),
    "sep=": (b"sep=;\n" + _rows(";", [NAMES, *_comma(TEXTS)]).encode(), "semicolon"),
    "quotes": (_rows(",", [[f'"{cell}"' for cell in row] for row in [NAMES, *_comma(TEXTS)]]).encode(), "comma"),
    "numpy.savetxt": (b"# t_s u_V q_m\n" + _rows(" ", TEXTS).encode(), "header in line 1"),
    "comments between": (_rows(",", [NAMES]).encode() + b"% armed\n" + _rows(",").encode() + b"# end\n", "2 lines of comment"),
    "preamble": (b"Rig;7\nDate;2024-05-22\nRate;100;;\n\n" + _rows(";", [NAMES, *TEXTS]).encode(), "before 5 are passed over"),
    "units below the names": (_rows(",", [NAMES, ("s", "V", "m"), *TEXTS]).encode(), "units in line 2: s,V,m"),
    "cells of several lines": (b'"t_s\n[s]","u_V\n[V]","q_m\n\n\n[m]"\r\n' + _rows(",").encode(), "header in line 1: "),
    "inches in a name": (_rows(",", [(*NAMES, '4" wheel'), *((*row, "1") for row in TEXTS)]).encode(), 'wheel'),
    "separators behind": (_rows(",", [(*NAMES, ""), *((*row, "") for row in TEXTS)]).encode(), "comma"),
    "an index before": (_rows(",", [("", *NAMES), *((str(k), *row) for k, row in enumerate(TEXTS))]).encode(), "line 1: ,t_s,u_V"),
    "a text beside": (_rows(",", [(*NAMES, "state"), *((*row, "FLY") for row in TEXTS)]).encode(), "comma"),
    "a remark below": (_rows(",", [NAMES, *TEXTS]).encode() + b"END OF LOG\n", "from line 14 on: 'END OF LOG'"),
    "cut short": (_rows(",", [NAMES, *TEXTS]).encode() + b"0.12,1.", "line 14, the last, is cut short (2 cells of 3)"),
    "Windows letters": (_rows(",", [(*NAMES, "Höhe"), *((*row, "1") for row in TEXTS)]).encode("cp1252"), "Windows-1252"),
    "names and rows split differently": (b"t_s, u_V, q_m\n" + _rows(" ", TEXTS).encode(), "blanks"),
    "LabVIEW": (
        b"LabVIEW Measurement\t\nSeparator\tTab\n***End_of_Header***\t\n\nSamples\t12\t12\t\n***End_of_Header***\t\t\t\n"
        + _rows("\t", [(*NAMES, "Comment"), *((*row, "") for row in _comma(TEXTS))]).encode(),
        "header in line 7",
    ),
    "R": (_rows(" ", [NAMES, *((str(k), *row) for k, row in enumerate(TEXTS, start=1))]).encode(), "header in line 1"),
    "a logger without power": (_rows(",", [NAMES, *TEXTS]).encode() + bytes(70), "comma"),
    "units in the cells": (_rows(";", [NAMES, *([row[0], f"{row[1]} V", f"{row[2]}m"] for row in TEXTS)]).encode(), "semicolon"),
    "a summary below": (_rows(",", [NAMES, *TEXTS]).encode() + b"Max,1.75,0\nMin,1.2,-0.1\n", "from line 14 on: 'Max,1.75,0'"),
    "sums below": (_rows(",", [NAMES, *TEXTS, [f"{total:.4f}" for total in NUMBERS.sum(axis=0)]]).encode(), "the sums of"),
    "means below": (_rows(",", [NAMES, *TEXTS, [f"{mean:.4f}" for mean in NUMBERS.mean(axis=0)]]).encode(), "the means of"),
    "exponents of Fortran": (_rows(" ", [NAMES, *[[f"{float(c):.9E}".replace("E", "D") for c in r] for r in TEXTS]]).encode(), ""),
}  # fmt: skip


def test_the_last_row_of_a_rig_at_rest_by_a_clock_since_1970_is_no_row_of_means(tmp_path: Path) -> None:
    # Truth: 20 rows, of which each is within a hundredth of the mean of all.
    rows = [f"{1767225600.0 + 0.01 * row:.2f},5.0,{0.5 + 1e-4 * (row % 2):.4f}" for row in range(20)]
    (tmp_path / "log.csv").write_text("\n".join(["t_s,u_V,q_m", *rows]) + "\n", encoding="utf-8")
    assert len(read(tmp_path / "log.csv", TextLayout()).signals["q_m"].values) == 20


@pytest.mark.parametrize("name", LAYOUTS)
def test_every_layout_gives_the_same_numbers_and_is_told(name: str, tmp_path: Path) -> None:
    content, told = LAYOUTS[name]
    (tmp_path / "log.csv").write_bytes(content)
    found = read(tmp_path / "log.csv", TextLayout())
    for place, column in enumerate(NAMES):
        np.testing.assert_allclose(found.signals[column].values, NUMBERS[:, place], atol=1e-7)
        assert found.signals[column].clock == (None if column == "t_s" else "t_s")
    assert told in "; ".join(found.found)


@pytest.mark.parametrize(
    ("heading", "name", "unit"),
    [
        ("psi [deg]", "psi", "deg"),
        ("Time(s)", "Time", "s"),
        ("U / V", "U", "V"),
        ("angle in deg", "angle", "deg"),
        ("angle, °", "angle", "°"),
        ("Drehzahl / Umdrehungen pro Minute", "Drehzahl", "Umdrehungen pro Minute"),
        ("ángulo {grados}", "ángulo", "grados"),
        ("rate <rad·s⁻¹>", "rate", "rad·s⁻¹"),
        ("q/(°/s)", "q", "°/s"),
        ("Winkel in [Grad]", "Winkel", "Grad"),
        ("Vinkel i grader", "Vinkel", "grader"),
        ("Angle en degrés", "Angle", "degrés"),
        ("motor i [A]", "motor i", "A"),
        ("q_deg/s", "q", "deg/s"),
        ("n_min⁻¹", "n", "min⁻¹"),
        ("u_M / V", "u_M", "V"),
        ("u_M in V", "u_M", "V"),
        ("psi_ref/deg", "psi_ref", "deg"),
        ("speed [furlong]", "speed", "furlong"),
        ("gain (old)", "gain (old)", ""),
        ("psi_deg", "psi_deg", ""),
    ],
)  # fmt: skip
def test_a_heading_is_a_name_and_a_unit(heading: str, name: str, unit: str, tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_text(_rows(";", [("t_s", heading), *(row[:2] for row in TEXTS)]))
    signal = read(tmp_path / "log.csv", TextLayout()).signals[name]
    assert (signal.unit, signal.heading) == (unit, heading)


THOUSANDS = {
    "Germany": ("1.234,5;-2.000.000;3.456;999,25", 3456.0),
    "Switzerland": ("1'234.5;-2'000'000;3'456;999.25", 3456.0),
    "France": ("1\u202f234,5;-2\u202f000\u202f000;3\u202f456;999,25", 3456.0),
    "America": ("1,234.5;-2,000,000;3,456;999.25", 3456.0),
    "no thousands": ("1234.5;-2000000;3.456;999.25", 3.456),
}


@pytest.mark.parametrize("country", THOUSANDS)
def test_thousands_that_stand_apart_are_one_number(country: str, tmp_path: Path) -> None:
    """Truth: 1234.5, -2000000, 3456 and 999.25; 3.456 means a thousand times more only where other cells show it."""
    row, third = THOUSANDS[country]
    (tmp_path / "log.csv").write_text("a;b;c;d\n" + 9 * f"{row}\n")
    found = read(tmp_path / "log.csv", TextLayout())
    assert [found.signals[name].values[0] for name in "abcd"] == [1234.5, -2e6, third, 999.25]
    assert ("thousands apart" in found.found[0]) == (third > 1000.0)


def test_quoted_cells_may_have_commas_between_thousands(tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_text("a,b\n" + 9 * '"1,234.5","12.25"\n')
    assert read(tmp_path / "log.csv", TextLayout()).signals["a"].values[0] == 1234.5


def test_hexadecimal_counts_are_numbers(tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_text("t_s,counts\n" + "".join(f"0.{k},{hex(4090 + k)}\n" for k in range(9)))
    np.testing.assert_array_equal(
        read(tmp_path / "log.csv", TextLayout()).signals["counts"].values, 4090.0 + np.arange(9)
    )


def test_times_of_day_are_seconds_since_the_first_past_midnight_too(tmp_path: Path) -> None:
    stamps = [
        "2024-05-22 23:59:59.980",
        "2024-05-22 23:59:59.990",
        "2024-05-23 00:00:00.000",
        "2024-05-23 00:00:00.010",
    ]
    (tmp_path / "log.csv").write_text("When,q_m\n" + "".join(f"{stamp},1\n" for stamp in stamps))
    found = read(tmp_path / "log.csv", TextLayout()).signals
    np.testing.assert_allclose(found["When"].values, T_S[:4], atol=1e-9)
    assert found["q_m"].clock == "When"


@pytest.mark.parametrize(
    "stamps",
    [
        ["58:59.980", "58:59.990", "59:00.000", "59:00.010"],  # of a spreadsheet
        ["20240522T235959.980", "20240522T235959.990", "20240523T000000.000", "20240523T000000.010"],
        [f"Wed May 22 23:59:{rest} 2024" for rest in ("58.980", "58.990", "59.000", "59.010")],
        [f"22/05/2024-23:59:{rest}" for rest in ("58.980", "58.990", "59.000", "59.010")],
        [f"22 May 2024 11:59:{rest} PM" for rest in ("58.980", "58.990", "59.000", "59.010")],
    ],
)
def test_times_of_day_in_other_forms_are_seconds_since_the_first(stamps: list[str], tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_text("When,q_m\n" + "".join(f"{stamp},1\n" for stamp in stamps))
    np.testing.assert_allclose(read(tmp_path / "log.csv", TextLayout()).signals["When"].values, T_S[:4], atol=1e-9)


def test_a_bad_cell_and_a_row_of_another_width_are_faults_of_their_rows_with_their_lines(tmp_path: Path) -> None:
    rows = [list(row) for row in TEXTS]
    rows[3][2], rows[5], rows[7] = "0.1.2", rows[5][:2], [*rows[7], "9"]
    rows[9][2] = "NaN"
    (tmp_path / "log.csv").write_text(_rows(",", [NAMES, *rows]))
    signal = read(tmp_path / "log.csv", TextLayout()).signals["q_m"]
    assert [told.partition(" cells sep")[0] for told in signal.faults.values()] == [
        "line 5: '0.1.2' among",
        "line 7: 2 cells of 3,",
        "line 9: 4 cells of 3,",
    ]
    assert list(signal.faults) == [3, 5, 7]
    assert np.flatnonzero(np.isnan(signal.values)).tolist() == [3, 5, 7, 9]


def test_names_that_are_the_same_hide_nothing(tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_text(_rows(",", [("t_s", "q_m", "q_m"), *TEXTS]))
    assert list(read(tmp_path / "log.csv", TextLayout()).signals) == ["t_s", "c2.q_m", "c3.q_m"]


def test_what_the_user_says_of_the_layout_is_taken(tmp_path: Path) -> None:
    """Truth: by itself the comma would be found, with more cells a row."""
    (tmp_path / "log.csv").write_text("9,9,9,9,9,9\n" + _rows(";", [("t_s", "q_m"), ("0,0", "1,5"), ("0,1", "2,5")]))
    found = read(tmp_path / "log.csv", TextLayout(";", ",", 1)).signals
    np.testing.assert_array_equal(found["q_m"].values, [1.5, 2.5])


@pytest.mark.parametrize(
    ("content", "told"),
    [
        (b"", "an empty file"),
        (b"t_s,u_V,q_m\n", "'t_s,u_V,q_m', and no row of numbers"),
        (b"hello\nworld\n", "'hello'"),
        (b"1,2,3,4,5,6,7,8,9,10,11,12\n", "1 row of 12 cells without a header"),
        (b"PK\x03\x04" + bytes(90), "zipped file"),
        (bytes(range(256)) * 9, "no text"),
        (None, "No such file"),
    ],
)
def test_a_file_that_is_no_table_is_refused_with_what_it_begins_with(
    content: bytes | None, told: str, tmp_path: Path
) -> None:
    if content is not None:
        (tmp_path / "log.csv").write_bytes(content)
    with pytest.raises(BadInput, match=told):
        read(tmp_path / "log.csv", TextLayout())


@pytest.mark.parametrize(
    ("cell", "decimal", "found"),
    [
        ("4.9 V", ".", ("4.9", "V")),
        ("12 V", ".", ("12", "V")),
        ("1 234.5 mV", ".", ("1234.5", "mV")),
        ("-1,234.5 mV", ".", ("-1234.5", "mV")),
        ("1.234,5mV", ",", ("1234,5", "mV")),
        ("1,234 V", ".", None),  # a decimal comma as well as thousands
        ("1 2 V", ".", None),
    ],
)
def test_a_number_with_its_unit_may_have_its_thousands_apart(
    cell: str, decimal: str, found: tuple[str, str] | None
) -> None:
    assert number_and_unit(cell, decimal) == found
