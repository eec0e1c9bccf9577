"""Tables as simulators, real-time systems and microcontrollers print them, through the command's own path to a run log."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np
import pytest

from recordings.importing import Imported, import_file
from recordings.mapping.mapping import ColumnMapping
from records.errors import BadInput
from tests.recordings.runs import RUN, T_S

NAMES = list(RUN)
ROWS = list(zip(*RUN.values(), strict=True))
NO_NAMES = dict(zip(NAMES, ("c1", "c2", "c3", "c4", "c5"), strict=True))
OF_NODES = {"u_M_V": "V(u_M)", "u_T_V": "V(u_T)", "psi_rad": "V(psi)*1", "phi_rad": "V(phi)*1"}


def _lines(separator: str = ",", begin: str = "", end: str = "") -> str:
    return "".join(f"{begin}{separator.join(f'{value:.9g}' for value in row)}{end}\n" for row in ROWS)


def _of_each_row(form: str) -> str:
    """A line a row, `form` with its time in ms and its signals."""
    return "".join(form.format(ms=round(1e3 * t), u=u, v=v, p=p, q=q) for t, u, v, p, q in ROWS)


def _in_two_units() -> str:
    return "".join(f"{t:.9g},{u:.9g},{v:.9g},{np.degrees(p):.9g},{np.degrees(q):.9g}\n" for t, u, v, p, q in ROWS)


def _control_desk() -> str:
    """Values begin in the line `trace_values`, and stand in the second column and those behind it."""
    first, *others = _lines(begin=",").splitlines()
    above = "type,values\nx_axis,1\ny_axis,,1,1,1,1\npath,,Root/u_M,Root/u_T,Root/psi,Root/phi\n"
    return f"{above}name,time,{','.join(NAMES[1:])}\nunit,s,V,V,rad,rad\ntrace_values{first}\n" + "\n".join(others)


HEADER = f"{','.join(NAMES)}\n"
INSPECTOR = (
    f"time,{','.join(NAMES[1:])}\n,Type: double,Type: double,Type: double,Type: double\n,Units: V,Units: V,Units: rad,Units: rad\n"
    ",Interp: zoh,Interp: zoh,Interp: zoh,Interp: zoh\n,Block Path: m/a,Block Path: m/a,Block Path: m/b,Block Path: m/b\n"
)
TEKTRONIX = (
    "Model,MDO3024\nHorizontal Units,S\nSample Interval,0.01\nVertical Units,V,V,V,V\nVertical Scale,1,1,1,1\nLabel,,,,\n"
    "TIME,u_M,u_T,c,d\n"
)
PRINTED = "[{ms:6d}] u_M_V={u:.9g} V, u_T_V={v:.9g} V, psi_rad={p:.9g} rad, phi_rad={q:.9g} rad\n"
IDF = "I ({ms}) RIG: u_M_V: {u:.9g}, u_T_V: {v:.9g}, psi_rad: {p:.9g}, phi_rad: {q:.9g}\n"
PLOTTED = ">t_ms:{ms}\n>u_M_V:{u:.9g}§V\n>u_T_V:{v:.9g}\n>psi_rad:{p:.9g}|g\n>phi_rad:{q:.9g}\n"
STAMPED = ">u_M_V:{ms}:{u:.9g}\n>u_T_V:{ms}:{v:.9g}\n>psi_rad:{ms}:{p:.9g}\n>phi_rad:{ms}:{q:.9g}\n"

CASES: Mapping[str, tuple[str, dict[str, str]]] = {
    "Data Inspector": (INSPECTOR + _lines(), {}),
    "ControlDesk": (_control_desk(), {}),
    "PLECS": ('"Time / s","Rig:u_M_V","Rig:u_T_V","Rig:psi / deg","Rig:phi / deg"\n' + _in_two_units(), {}),
    "PSIM": (f"{'   '.join(['Time', *NAMES[1:]])}\n{_lines('   ', begin=' ')}", {}),
    "LTspice": ("time\tV(u_M)\tV(u_T)\tV(psi)\tV(phi)\n" + _lines("\t"), OF_NODES),
    "Rohde & Schwarz": ("in s,u_M_V in V,u_T_V in V,psi_rad,phi_rad\n" + _lines(), {}),
    "Tektronix": (TEKTRONIX + _lines(), {"u_M_V": "u_M", "u_T_V": "u_T", "psi_rad": "c*1", "phi_rad": "d*1"}),
    "Teleplot": (_of_each_row(PLOTTED), {}),
    "Teleplot with times": (_of_each_row(STAMPED), {}),
    "ESP-IDF": (_of_each_row(IDF), {}),
    "printf with units": (_of_each_row(PRINTED), {"t_s": "time*0.001"}),
    "lists of Python": (_lines(", ", "[", "],"), NO_NAMES),
    "a matrix of MATLAB": (f"data = [\n{_lines(' ', end=';')}];\n", NO_NAMES),
    "names in single quotes": (",".join(f"'{name}'" for name in NAMES) + "\n" + _lines(), {}),
    "newest first": (HEADER + "\n".join(reversed(_lines().splitlines())), {}),
    "rows by chance": (HEADER + "\n".join(np.random.default_rng(7).permutation(_lines().splitlines())), {}),
    "rows in the order of a column": (
        HEADER + "\n".join(sorted(_lines().splitlines(), key=lambda row: row.split(",")[3])),
        {},
    ),
    "times of two zones": (
        f"stamp,{','.join(NAMES[1:])}\n"
        + "".join(
            f"2024-03-31T{'01:59:59' if k < 25 else '03:00:00'}.{(750 + 10 * k) % 1000:03d}{'+01:00' if k < 25 else '+02:00'},"
            + ",".join(f"{value:.9g}" for value in row[1:])
            + "\n"
            for k, row in enumerate(ROWS)
        ),
        {},
    ),
}


def _imported(path: Path, text: str, columns: Mapping[str, str]) -> Imported:
    path.write_text(text, encoding="utf-8")
    return import_file(path, ColumnMapping(columns=dict(columns)))


def _is_the_run(done: Imported) -> None:
    np.testing.assert_allclose(done.log.t_s - done.log.t_s[0], T_S, atol=1e-9)
    for name in NAMES[1:]:
        np.testing.assert_allclose(done.log.column(name), RUN[name], atol=1e-8)


@pytest.mark.parametrize("case", CASES)
def test_the_table_gives_the_run_in_si_units(case: str, tmp_path: Path) -> None:
    """Truth: the run, to the nine digits that are printed."""
    text, columns = CASES[case]
    _is_the_run(_imported(tmp_path / "run.txt", text, columns))


def test_each_signal_of_the_data_inspector_keeps_its_own_times(tmp_path: Path) -> None:
    """Truth: psi and phi at every second instant, each under the column of times in front of it."""
    lines = [f"{t:.9g},{u:.9g},{v:.9g},{2 * t:.9g},{np.sin(2 * t):.9g},{np.cos(2 * t):.9g}" for t, u, v, _, _ in ROWS]
    head = "time,u_M_V,u_T_V,time,psi_rad,phi_rad\n,Units: V,Units: V,,Units: rad,Units: rad\n"
    log = _imported(tmp_path / "run.csv", head + "\n".join(lines), {}).log
    np.testing.assert_allclose(log.t_s, 2.0 * T_S, atol=1e-9)
    np.testing.assert_allclose(log.column("psi_rad"), np.sin(2.0 * T_S), atol=1e-8)


@pytest.mark.parametrize("ending", ["tab", "out", "1"])
def test_text_under_an_ending_of_its_own_is_a_table(ending: str, tmp_path: Path) -> None:
    done = _imported(tmp_path / f"run.{ending}", HEADER + _lines(), {})
    _is_the_run(done)
    assert any("taken as a table of text" in told for told in done.found)


@pytest.mark.parametrize("message", ["WARN: no answer of the sensor", "E,sensor", "calibrating ..."])
def test_lines_of_text_between_the_rows_are_passed_over_and_said(message: str, tmp_path: Path) -> None:
    rows = _lines().splitlines(keepends=True)
    done = _imported(tmp_path / "run.csv", HEADER + "".join([*rows[:20], f"{message}\n", *rows[20:]]), {})
    _is_the_run(done)
    assert f"1 line of text between the rows passed over, first line 22: {message!r}" in done.found


def test_a_row_of_words_in_place_of_numbers_is_no_message(tmp_path: Path) -> None:
    rows = _lines().splitlines(keepends=True)
    with pytest.raises(BadInput, match=r"line 22.*'ERR'"):
        _imported(tmp_path / "run.csv", HEADER + "".join([*rows[:20], "ERR,ERR,ERR,ERR,ERR\n", *rows[20:]]), {})


def _in_thousandths(digits: Callable[[float], str], angle: Callable[[float], str]) -> str:
    head = "t_ms;u_M_mV;u_T_mV;psi_rad;phi_rad\n"
    return head + "".join(
        ";".join([digits(9e2 + 1e4 * t), digits(1e3 * u), digits(1e3 * v), angle(p), angle(q)]) + "\n"
        for t, u, v, p, q in ROWS
    )


def _apart(value: float) -> str:
    return f"{value:,.0f}".replace(",", ".")


@pytest.mark.parametrize(
    ("angle", "tolerance"), [(lambda v: f"{v:.6f}".replace(".", ","), 1e-6), (lambda v: f"{v:.0f}", 0.5)]
)
def test_a_point_that_parts_thousands_is_no_decimal_point(
    angle: Callable[[float], str], tolerance: float, tmp_path: Path
) -> None:
    """Truth: times from 900 ms on, 5000 mV and more; beside decimal commas, and where no number has a decimal sign."""
    log = _imported(tmp_path / "run.csv", _in_thousandths(_apart, angle), {}).log
    np.testing.assert_allclose(log.t_s, 0.9 + 10.0 * T_S, atol=1e-9)
    np.testing.assert_allclose(log.column("u_M_V"), RUN["u_M_V"], atol=1e-9)
    np.testing.assert_allclose(log.column("psi_rad"), RUN["psi_rad"], atol=tolerance)


def test_a_column_that_may_have_thousands_apart_is_told_where_others_have_decimal_points(tmp_path: Path) -> None:
    rows = [f"{0.01 * k:.2f};{999 if k < 2 else f'1.00{k % 10}'};1.8;0.1;0.2\n" for k in range(20)]
    done = _imported(tmp_path / "run.csv", HEADER.replace(",", ";") + "".join(rows), {})
    assert "1.002 beside 999 is read with a decimal point; if it parts the thousands, say --decimal ," in done.found


REFUSED: Mapping[str, tuple[str, Sequence[str], str]] = {
    "candump -l": ("run.log", [f"({1.7e9 + t:.6f}) can0 123#13880000" for t in T_S], "CAN bus.*cantools"),
    "candump": ("run.txt", ["  can0  123   [4]  13 88 00 00" for _ in T_S], "CAN bus.*cantools"),
    "Vector": (
        "run.asc",
        ["base hex  timestamps absolute", *[f"   {t:.6f} 1  123  Rx  d 4 13 88 00 00" for t in T_S]],
        "CAN bus",
    ),
    "PEAK": ("run.trc", ["1)  0.1  Rx  0300  4  13 88 00 00" for _ in T_S], "CAN bus"),
    "ArduPilot": ("run.log", ["FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns"], "mavlogdump"),
    "Octave": ("run.mat", ["# Created by Octave 8.4.0", "# name: psi_rad", "# type: matrix", "0"], "save -v7"),
    "ROS 2's echo": ("run.txt", [f"psi: {t}\n---" for t in T_S], "topic echo --csv"),
    "InfluxDB": ("run.csv", ["#group,false", ",result,table,_time,_value,_field", ",,0,1,2,psi_rad"], "pivot"),
    "a page": ("run.csv", ["<!DOCTYPE html>", "<table></table>"], "HTML"),
    "XML": ("run.csv", ['<?xml version="1.0"?>', "<log/>"], "XML"),
    "Data Inspector's session": ("run.mldatx", ["PK"], r"Simulink\.sdi\.exportRun"),
    "a pickle": ("run.pkl", ["no matter"], r"numpy\.savez"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_is_no_table_is_named_with_what_to_type(case: str, tmp_path: Path) -> None:
    name, lines, told = REFUSED[case]
    with pytest.raises(BadInput, match=told):
        _imported(tmp_path / name, "\n".join(lines) + "\n", {})
