"""Lines of a serial monitor and of printf: stamps and names around the numbers; a table keeps its own.

Truth in every file: rows 10 ms apart, u = 1.5 + 0.01 k V and psi = -0.2 + 0.001 k rad; tolerance: the digits written.
"""

from pathlib import Path

import numpy as np
import pytest

from recordings.formats.text.delimited import read
from recordings.formats.text.lines import Line
from recordings.formats.text.monitor import as_table
from recordings.layout import FOUND

ROWS = 40
T_S, U_V, PSI_RAD = 0.01 * np.arange(ROWS), 1.5 + 0.01 * np.arange(ROWS), -0.2 + 0.001 * np.arange(ROWS)
STAMPS = [f"14:05:59.{10 * k:03d}" for k in range(ROWS)]


def lines(form: str) -> str:
    each = zip(STAMPS, T_S, U_V, PSI_RAD, strict=True)
    return "".join(form.format(s=s, t=f"{t:.2f}", u=f"{u:.4f}", p=f"{p:.4f}") + "\n" for s, t, u, p in each)


FILES = {
    "Arduino's plotter": lines("time:{t}\tu_V:{u}\tpsi_rad:{p}"),
    "printf": lines("time={t}, u_V={u}, psi_rad={p}"),
    "after a greeting": "rig 2 ready\n" + lines("time={t} u_V={u} psi_rad={p}"),
    "a stamp in front of names": lines("{s} -> u_V:{u},psi_rad:{p}"),
    "a stamp in brackets": lines("[2024-05-22 {s}] u_V: {u} psi_rad: {p}"),
    "seconds in brackets": lines("[{t}] u_V={u}; psi_rad={p}"),
    "a stamp in front of a table": f"{STAMPS[0]} -> u_V,psi_rad\n" + lines("{s} -> {u},{p}"),
}


@pytest.mark.parametrize("name", FILES)
def test_what_stands_around_the_numbers_becomes_times_and_names(name: str, tmp_path: Path) -> None:
    (tmp_path / "log.txt").write_text(FILES[name])
    found = read(tmp_path / "log.txt", FOUND)
    np.testing.assert_allclose(found.signals["u_V"].values, U_V, atol=1e-9)
    np.testing.assert_allclose(found.signals["psi_rad"].values, PSI_RAD, atol=1e-9)
    assert found.signals["u_V"].clock == "time"
    np.testing.assert_allclose(found.signals["time"].values, T_S, atol=1e-9)
    assert any("in front of each" in told for told in found.found)


@pytest.mark.parametrize(("name", "told"), [("printf", False), ("a stamp in front of a table", True)])
def test_cells_and_a_heading_are_told_where_the_file_has_them(name: str, told: bool, tmp_path: Path) -> None:
    (tmp_path / "log.txt").write_text(FILES[name])
    found = read(tmp_path / "log.txt", FOUND).found
    assert any(entry.startswith(("cells separated", "header in line")) for entry in found) is told


def test_a_line_without_one_of_the_names_has_no_number_for_it(tmp_path: Path) -> None:
    (tmp_path / "log.txt").write_text(FILES["printf"].replace(", u_V=1.6000", ""))
    values = read(tmp_path / "log.txt", FOUND).signals["u_V"].values
    assert np.flatnonzero(np.isnan(values)).tolist() == [10]


@pytest.mark.parametrize(
    "text",
    [
        lines("{s},{u},{p}"),
        lines("{s} {u} {p}"),
        lines("2024-05-22T{s}Z,2024-05-22T{s}Z,{u}"),
        lines("{t},{u},mode=2 state=3"),
        lines("u={u},{p}"),
    ],
)
def test_a_table_is_left_as_it_is(text: str) -> None:
    given = [Line(place, line) for place, line in enumerate(text.splitlines(), start=1)]
    assert as_table(given) == (given, ())
