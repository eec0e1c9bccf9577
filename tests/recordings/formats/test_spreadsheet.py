"""Workbooks as Excel and LibreOffice write them, through the command's own path to a run log."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any
from xml.sax.saxutils import escape
from zipfile import ZipFile

import numpy as np
import pytest

from recordings.importing import import_file
from recordings.mapping.mapping import ColumnMapping
from records.errors import BadInput
from tests.recordings.runs import RUN, T_S

pytest.importorskip("python_calamine")
DAY_S = 86400.0
NOON = 45413.5  # as Excel counts days: 1 May 2024, 12:00
NAMES = list(RUN)
ROWS = list(zip(*RUN.values(), strict=True))
PLAIN: list[Sequence[Any]] = [NAMES, *ROWS]
IN_OTHER_UNITS: list[Sequence[Any]] = [
    ["Rig 7, without its cover"],
    [],
    ["Time", "u_M", "u_T", "psi", "phi"],
    ["ms", "mV", "V", "deg", "rad"],
    *[(1e3 * t, 1e3 * u_m, u_t, np.degrees(psi), phi) for t, u_m, u_t, psi, phi in ROWS],
    ["Max", None, 1.8],
]
OF_THE_INSPECTOR: list[Sequence[Any]] = [
    ["time", *NAMES[1:]],
    [None, *["Type: double"] * 4],
    [None, "Units: V", "Units: V", "Units: rad", "Units: rad"],
    [None, *["Interp: zoh"] * 4],
    *ROWS,
]


def _sheet(rows: Sequence[Sequence[Any]], style: int) -> str:
    """A sheet's XML; the first cell of a row of numbers has the style."""
    lines = []
    for number, row in enumerate(rows, start=1):
        cells = []
        for column, value in enumerate(row):
            place = f"{chr(65 + column)}{number}"
            if isinstance(value, str):
                cells.append(f'<c r="{place}" t="inlineStr"><is><t>{escape(value)}</t></is></c>')
            elif value is not None:
                cells.append(f'<c r="{place}" s="{0 if column else style}"><v>{float(value)!r}</v></c>')
        lines.append(f'<row r="{number}">{"".join(cells)}</row>')
    space = "http://schemas.openxmlformats.org/spreadsheetml/2006/main"
    return f'<worksheet xmlns="{space}"><sheetData>{"".join(lines)}</sheetData></worksheet>'


def excel(path: Path, style: int = 0, **sheets: Sequence[Sequence[Any]]) -> None:
    """Style 1 is a date with a time of day, 2 a span of time."""
    main, office = "http://schemas.openxmlformats.org/spreadsheetml/2006/main", "http://schemas.openxmlformats.org"
    linked = f"{office}/officeDocument/2006/relationships"
    names = list(enumerate(sheets, start=1))
    of_sheets = "".join(f'<sheet name="{name}" sheetId="{n}" r:id="r{n}"/>' for n, name in names)
    links = "".join(
        f'<Relationship Id="r{n}" Type="{linked}/worksheet" Target="worksheets/sheet{n}.xml"/>' for n, _ in names
    )
    links += f'<Relationship Id="s" Type="{linked}/styles" Target="styles.xml"/>'
    formats = "".join(f'<xf numFmtId="{number}" applyNumberFormat="1"/>' for number in (0, 22, 46))
    relations = f'xmlns="{office}/package/2006/relationships"'
    with ZipFile(path, "w") as book:
        book.writestr("[Content_Types].xml", f'<Types xmlns="{office}/package/2006/content-types"/>')
        book.writestr(
            "_rels/.rels",
            f'<Relationships {relations}><Relationship Id="r" Type="{linked}/officeDocument" Target="xl/workbook.xml"/></Relationships>',
        )
        book.writestr(
            "xl/workbook.xml", f'<workbook xmlns="{main}" xmlns:r="{linked}"><sheets>{of_sheets}</sheets></workbook>'
        )
        book.writestr("xl/_rels/workbook.xml.rels", f"<Relationships {relations}>{links}</Relationships>")
        book.writestr(
            "xl/styles.xml", f'<styleSheet xmlns="{main}"><cellXfs count="3">{formats}</cellXfs></styleSheet>'
        )
        for (number, _), rows in zip(names, sheets.values(), strict=True):
            book.writestr(f"xl/worksheets/sheet{number}.xml", _sheet(rows, style))


def open_document(path: Path, rows: Sequence[Sequence[Any]]) -> None:
    def cell(value: Any) -> str:
        if isinstance(value, str):
            return f'<table:table-cell office:value-type="string"><text:p>{escape(value)}</text:p></table:table-cell>'
        return f'<table:table-cell office:value-type="float" office:value="{float(value)!r}"/>'

    body = "".join(f"<table:table-row>{''.join(map(cell, row))}</table:table-row>" for row in rows)
    space = "urn:oasis:names:tc:opendocument:xmlns"
    spaces = " ".join(f'xmlns:{name}="{space}:{name}:1.0"' for name in ("office", "table", "text"))
    content = f'<office:document-content {spaces}><office:body><office:spreadsheet><table:table table:name="Run">{body}'
    with ZipFile(path, "w") as book:
        book.writestr("mimetype", "application/vnd.oasis.opendocument.spreadsheet")
        book.writestr("META-INF/manifest.xml", f'<manifest:manifest xmlns:manifest="{space}:manifest:1.0"/>')
        book.writestr(
            "content.xml", f"{content}</table:table></office:spreadsheet></office:body></office:document-content>"
        )


def _stamped(start: float) -> list[Sequence[Any]]:
    return [["stamp", *NAMES[1:]], *[(start + row[0] / DAY_S, *row[1:]) for row in ROWS]]


def _as_texts(sign: str) -> list[Sequence[Any]]:
    return [NAMES, *[[f"{value:.9g}".replace(".", sign) for value in row] for row in ROWS]]


CASES: Mapping[str, Callable[[Path], None]] = {
    "plain.xlsx": lambda path: excel(path, Run=PLAIN),
    "plain.ods": lambda path: open_document(path, PLAIN),
    "an old ending.xls": lambda path: excel(path, Run=PLAIN),
    "units and remarks.xlsx": lambda path: excel(path, About=[["Rig", "CE150"]], Run=IN_OTHER_UNITS),
    "away from the corner.xlsx": lambda path: excel(path, Run=[[], [], *[(None, *row) for row in PLAIN]]),
    "Data Inspector.xlsx": lambda path: excel(path, Run=OF_THE_INSPECTOR),
    "dates.xlsx": lambda path: excel(path, 1, Run=_stamped(NOON)),
    "spans.xlsx": lambda path: excel(path, 2, Run=_stamped(0.0)),
    "numbers as texts.xlsx": lambda path: excel(path, Run=_as_texts(".")),
    "numbers as texts with commas.xlsx": lambda path: excel(path, Run=_as_texts(",")),
    "text.xls": lambda path: _write(path, "\n".join("\t".join(map(str, row)) for row in PLAIN)),
}


def _write(path: Path, text: str) -> None:
    path.write_text(text)


@pytest.mark.parametrize("case", CASES)
def test_a_workbook_gives_the_run_in_si_units(case: str, tmp_path: Path) -> None:
    """Truth: the run that was written; dates are kept to a thousandth of a second, texts to nine digits."""
    CASES[case](tmp_path / case)
    log = import_file(tmp_path / case, ColumnMapping()).log
    np.testing.assert_allclose(log.t_s - log.t_s[0], T_S, atol=6e-4 if case.startswith(("dates", "spans")) else 1e-9)
    for name in NAMES[1:]:
        np.testing.assert_allclose(log.column(name), RUN[name], rtol=1e-8)


def test_runs_in_several_sheets_are_asked_for_and_taken_by_name(tmp_path: Path) -> None:
    turned = [NAMES, *[(*row[:3], -row[3], row[4]) for row in ROWS]]
    excel(tmp_path / "two.xlsx", first=PLAIN, second=turned)
    with pytest.raises(BadInput, match=r"first\.psi_rad .* or second\.psi_rad .*--group first"):
        import_file(tmp_path / "two.xlsx", ColumnMapping())
    log = import_file(tmp_path / "two.xlsx", ColumnMapping(group="second")).log
    np.testing.assert_allclose(log.column("psi_rad"), -RUN["psi_rad"], rtol=1e-9)


@pytest.mark.parametrize(
    ("content", "told"),
    [
        (b"PK\x03\x04 half", "no whole workbook"),
        (b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", "no whole workbook"),
        (b"<html><table><tr><td>1</td></tr></table></html>", "a page of HTML"),
    ],
)
def test_what_is_no_workbook_is_told(content: bytes, told: str, tmp_path: Path) -> None:
    (tmp_path / "run.xls").write_bytes(content)
    with pytest.raises(BadInput, match=told):
        import_file(tmp_path / "run.xls", ColumnMapping())


def test_a_workbook_without_numbers_names_its_sheets(tmp_path: Path) -> None:
    excel(tmp_path / "run.xlsx", Notes=[["flew well"]], Plan=[["fly again"]])
    with pytest.raises(BadInput, match=r"sheet Notes: 'flew well'.*sheet Plan"):
        import_file(tmp_path / "run.xlsx", ColumnMapping())
