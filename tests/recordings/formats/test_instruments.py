"""Tables of text in the forms of instruments: oscilloscopes and LabVIEW, with units, times and first times where these write them.

Truth in every file: rows STEP_S apart from FIRST_S on, u = 0, 0.5, 1, ... V and y = -2 y0 + k mV, made here; tolerance: the digits written.
"""

from pathlib import Path

import numpy as np
import pytest

from recordings.formats.text.delimited import read
from recordings.layout import FOUND
from recordings.mapping.mapping import ColumnMapping
from recordings.signals import Contents
from records.errors import BadInput
from tests.own_plants import OwnPlant
from tests.recordings.here import imported_here

CIRCUIT = OwnPlant(
    {"T": (0.1, 0.01, "s"), "u_max": (50.0, 0.0, "V")},
    {"y_V": 1e-3},
    """
u, y = symbol("u_V"), symbol("y_V")
return Model(
    name="NAME",
    states=(y,),
    inputs=(u,),
    outputs={"y_V": y},
    parameters=PARAMETERS,
    rates={y: (u - y) / p["T"]},
    axes=(),
    input_limits={u: (-p["u_max"], p["u_max"])},
    places=Places(inputs={"input": InputPlace(u, "V", 9.0)}, axes={}, sensors={"y_sensor": SensorPlace("y_V", "V")}),
)
""",
)
ROWS, STEP_S, FIRST_S = 60, 0.004, -0.02
TIMES_S = FIRST_S + STEP_S * np.arange(ROWS)
U_V = 0.5 * np.arange(ROWS)
Y_MV = 3.0 - 2.0 * np.arange(ROWS)


def _table(separator: str, *columns: np.ndarray, behind: str = "") -> str:
    return "".join(
        separator.join(f"{value:.6e}" for value in row) + behind + "\n" for row in zip(*columns, strict=True)
    )


KEYSIGHT = "x-axis,1,2\nsecond,Volt,mV\n" + _table(",", TIMES_S, U_V, Y_MV)
SIGLENT = "Record Length,Analog:60\nVertical Units,CH1:V,,,\nHorizontal Units,us,,,\nSource,CH1\nSecond,mV\n" + _table(
    ",", TIMES_S, Y_MV
)
RIGOL = f"X,CH1,CH2,Start,Increment,\nSequence,Volt,mV,{FIRST_S:.6e},{STEP_S:.6e}\n" + "".join(
    f"{k},{u:.6e},{y:.6e},\n" for k, (u, y) in enumerate(zip(U_V, Y_MV, strict=True))
)
LABVIEW = (
    "LabVIEW Measurement\t\nSeparator\tTab\nX_Columns\tOne\nDate\t2024/05/22\nTime\t14:41:45.5\n***End_of_Header***\t\n\t\n"
    "Channels\t2\t\t\nSamples\t60\t60\t\nY_Unit_Label\tVolts\tmV\t\nX_Dimension\tTime\tTime\t\nX0\t-0.02\t-0.02\t\n"
    "Delta_X\t0.004\t0.004\t\n***End_of_Header***\t\t\t\nX_Value\tDrive\tBridge\tComment\n"
    + _table("\t", TIMES_S, U_V, Y_MV)
)


def _read(text: str, path: Path) -> Contents:
    path.write_text(text)
    return read(path, FOUND)


def _mapping(folder: Path, **columns: str) -> ColumnMapping:
    return ColumnMapping(columns, str(CIRCUIT.write(folder, "circuit")))


@pytest.mark.parametrize(
    ("text", "clock", "name", "unit"),
    [(KEYSIGHT, "x-axis", "2", "mV"), (SIGLENT, "Source", "CH1", "mV"), (LABVIEW, "X_Value", "Bridge", "mV")],
    ids=["keysight", "siglent", "labview"],
)
def test_the_column_in_a_unit_of_time_is_the_clock_and_units_are_the_files(
    text: str, clock: str, name: str, unit: str, tmp_path: Path
) -> None:
    signal = _read(text, tmp_path / "log.csv").signals[name]
    np.testing.assert_allclose(signal.values, Y_MV, rtol=1e-6)
    assert (signal.clock, signal.unit) == (clock, unit)


def test_labviews_step_is_a_number_of_one_value(tmp_path: Path) -> None:
    assert float(_read(LABVIEW, tmp_path / "log.lvm").singles["Delta_X"].values) == STEP_S


def test_times_of_another_dimension_are_no_times(tmp_path: Path) -> None:
    text = LABVIEW.replace("X_Dimension\tTime\tTime", "X_Dimension\tFrequency\tFrequency")
    assert _read(text, tmp_path / "log.lvm").signals["Drive"].clock is None


def test_what_a_heading_has_beyond_the_rows_is_a_number_of_one_value(tmp_path: Path) -> None:
    found = _read(RIGOL, tmp_path / "log.csv")
    assert {name: float(single.values) for name, single in found.singles.items()} == {
        "Start": FIRST_S,
        "Increment": STEP_S,
    }
    np.testing.assert_allclose(found.signals["CH2"].values, Y_MV, rtol=1e-6)
    assert found.signals["CH2"].unit == "mV"


def test_the_times_are_typed_of_them_and_the_first_row_is_the_first(tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_text(RIGOL)
    columns = {"t_s": "Start+Increment*X", "u_V": "CH1", "y_V": "CH2"}
    log = imported_here(tmp_path / "log.csv", _mapping(tmp_path, **columns)).log
    np.testing.assert_allclose(log.t_s, TIMES_S, atol=1e-9)
    np.testing.assert_allclose(log.y[:, 0], 1e-3 * Y_MV, atol=1e-9)


def test_without_times_they_are_among_what_is_there(tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_text(RIGOL)
    with pytest.raises(BadInput, match=r"Start \(one number\), Increment \(one number\)"):
        imported_here(tmp_path / "log.csv", _mapping(tmp_path, u_V="CH1", y_V="CH2"))


def test_a_row_of_numbers_that_is_short_at_the_head_is_said_to_be_passed_over(tmp_path: Path) -> None:
    text = "time_ms,pwm,count\n1,2\n" + _table(",", 1e3 * (TIMES_S - FIRST_S), U_V, Y_MV)
    assert "line 2 is passed over: '1,2', 2 cells of 3" in _read(text, tmp_path / "log.csv").found


def test_a_factor_of_one_says_that_a_number_is_right_in_spite_of_its_unit(tmp_path: Path) -> None:
    (tmp_path / "log.lvm").write_text(LABVIEW.replace("Volts\tmV", "Volts\tN"))
    with pytest.raises(BadInput, match="no factor from N to V"):
        imported_here(tmp_path / "log.lvm", _mapping(tmp_path, u_V="Drive", y_V="Bridge"))
    log = imported_here(tmp_path / "log.lvm", _mapping(tmp_path, u_V="Drive", y_V="Bridge*1")).log
    np.testing.assert_allclose(log.y[:, 0], Y_MV, rtol=1e-6)


def test_a_part_of_a_name_is_told_with_the_whole(tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_text("t_s,input(8bit),y_V\n" + _table(",", TIMES_S, U_V, Y_MV))
    with pytest.raises(BadInput, match=r"if input\(8bit\) is meant: --column"):
        imported_here(tmp_path / "log.csv", _mapping(tmp_path, u_V="input"))


def test_a_name_that_is_not_there_is_told_with_the_header_that_was_taken(tmp_path: Path) -> None:
    heads = "name,XAxis,Model/u,Model/y\npath,a,b,c\n"
    (tmp_path / "log.csv").write_text(heads + _table(",", U_V, TIMES_S, U_V, Y_MV))
    with pytest.raises(BadInput, match=r"header in line 2: path,a,b,c; lines before 2 are passed over"):
        imported_here(tmp_path / "log.csv", _mapping(tmp_path, u_V="Model/u", y_V="c"))


def test_times_of_too_few_digits_are_told_apart_by_the_number_of_rows(tmp_path: Path) -> None:
    """Truth: 60 rows from 1 to 1.236 s; two digits behind the point make them the same in pairs and threes."""
    rows = "".join(f"{1.0 + time_s - FIRST_S:.2f},{u},{y}\n" for time_s, u, y in zip(TIMES_S, U_V, Y_MV, strict=True))
    (tmp_path / "log.csv").write_text("t_s,u_V,y_V\n" + rows)
    done = imported_here(tmp_path / "log.csv", _mapping(tmp_path))
    assert np.diff(done.log.t_s) == pytest.approx(0.004, rel=1e-3)
    assert any("stamps are coarser than the rows" in told for told in done.found)


def test_a_clock_may_have_underlines_around_its_name(tmp_path: Path) -> None:
    found = _read("__time,/rig/u_V\n" + _table(",", TIMES_S, U_V), tmp_path / "log.csv")
    assert found.signals["/rig/u_V"].clock == "__time"


OWN_TIMES = np.column_stack([TIMES_S, U_V, TIMES_S + 0.001, Y_MV])
SLOW = _table(",", *OWN_TIMES.T).splitlines(keepends=True)
SLOW[ROWS // 2 :] = [f"{row[0]:.6f},{row[1]:.6f},,\n" for row in OWN_TIMES[ROWS // 2 :]]


@pytest.mark.parametrize(
    "heads", ["X_Value,u_V,X_Value,y_mV", "time1 [s],u_V,time2 [s],y_mV", "Name,u_V,Name,y_mV\nDelta,4,Delta,4"]
)
def test_columns_with_a_clock_in_front_of_each_have_their_own_times(heads: str, tmp_path: Path) -> None:
    """Truth: y stands 1 ms behind u, and has half as many samples."""
    (tmp_path / "log.csv").write_text(f"{heads}\n{''.join(SLOW)}")
    found = read(tmp_path / "log.csv", FOUND).signals
    y = found["y_mV"]
    np.testing.assert_allclose(y.values, Y_MV[: ROWS // 2], rtol=1e-6)
    np.testing.assert_allclose(found[y.clock or ""].values, TIMES_S[: ROWS // 2] + 0.001, atol=1e-9)
    log = imported_here(tmp_path / "log.csv", _mapping(tmp_path)).log
    np.testing.assert_allclose(log.column("u_V"), U_V[: ROWS // 2], rtol=1e-6)


@pytest.mark.parametrize("heads", ["t1,t2,u_V,y_mV", "t1,u_V,y_mV,t2", "q1,u_V,q2,y_mV"])
def test_columns_that_are_no_clocks_in_front_of_others_are_none(heads: str, tmp_path: Path) -> None:
    found = _read(f"{heads}\n" + _table(",", TIMES_S, 1e3 * TIMES_S, U_V, U_V), tmp_path / "log.csv")
    assert {signal.clock for signal in found.signals.values()} == {None}


HEADS = {
    "INCA": "ETASAsciiItemFile\trecord\ntime\tu\\ETKC:1\ty\\ETKC:1\nf8\tf4\tu2\ns\tV\tmV\n",
    "units above": "[s]\t[V]\t[mV]\ntime\tu\ty\n",
    "a rule": "time [s]\tu [V]\ty [mV]\n---\t---\t---\n",
}


@pytest.mark.parametrize("name", HEADS)
def test_the_heading_is_the_line_of_names_among_types_rules_and_units(name: str, tmp_path: Path) -> None:
    (tmp_path / "log.txt").write_text(HEADS[name] + _table("\t", TIMES_S, U_V, Y_MV))
    log = imported_here(tmp_path / "log.txt", _mapping(tmp_path)).log
    np.testing.assert_allclose(log.y[:, 0], 1e-3 * Y_MV, rtol=1e-6)
    np.testing.assert_allclose(log.t_s, TIMES_S, atol=1e-9)


def test_what_an_instrument_writes_beyond_its_range_is_no_number(tmp_path: Path) -> None:
    y = Y_MV.copy()
    y[3], y[5] = 9.9e37, 9.91e37
    values = _read("t_s,u_V,y_mV\n" + _table(",", TIMES_S, U_V, y), tmp_path / "log.csv").signals["y_mV"].values
    assert np.flatnonzero(np.isnan(values)).tolist() == [3, 5]
