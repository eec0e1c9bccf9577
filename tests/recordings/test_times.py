"""Times of a recording in seconds, whatever its clock counts: parts of a second, dates, ticks that run over, a clock that stands."""

from pathlib import Path

import numpy as np
import pytest
from scipy.io import savemat

from recordings.channels import Span
from recordings.mapping.mapping import ColumnMapping
from records.errors import BadInput
from tests.recordings.here import imported_here
from tests.recordings.runs import RUN, T_S, save_run


def test_times_of_a_calendar_are_counted_from_the_first(tmp_path: Path) -> None:
    done = imported_here(
        save_run(tmp_path / "run.mat", t_s=T_S + 1_716_398_564.0), ColumnMapping(), Span(until_s=0.205)
    )
    np.testing.assert_allclose(done.log.t_s, T_S[:21], atol=1e-6)
    assert any("counted from the first" in told for told in done.found)


@pytest.mark.parametrize(("per_second", "name"), [(1e3, "stamp"), (1e6, "stamp"), (1e9, "stamp"), (1e3, "t_s")])
def test_dates_in_parts_of_a_second_are_told_by_their_size(per_second: float, name: str, tmp_path: Path) -> None:
    stamps = {"t_s": None, name: np.round((T_S + 1_716_398_564.0) * per_second)}
    done = imported_here(save_run(tmp_path / "run.mat", **stamps), ColumnMapping())
    np.testing.assert_allclose(done.log.t_s, T_S, atol=1e-3 if per_second == 1e3 else 1e-6)


@pytest.mark.parametrize(
    ("factor", "unit"), [("0.001", "milliseconds"), ("1e-6", "microseconds"), ("1e-9", "nanoseconds")]
)
def test_times_that_look_like_parts_of_a_second_are_remarked(factor: str, unit: str, tmp_path: Path) -> None:
    done = imported_here(save_run(tmp_path / "run.mat", t_s=T_S / float(factor)), ColumnMapping())
    told = f"rows are {0.01 / float(factor):g} s apart: if times are in {unit}, say --column t_s=...*{factor}"
    assert told in done.found


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
        BadInput, match=r"expected times that increase; say --column t_s=0\.00918367\*row for rows so far apart"
    ):
        imported_here(tmp_path / "run.mat", ColumnMapping())


def test_rows_minutes_apart_by_the_dates_of_a_file_are_not_remarked(tmp_path: Path) -> None:
    """Truth: five minutes between rows, by dates: no millisecond is meant."""
    rows = "".join(f"2026-10-07 09:{minute:02d}:00;1;0;{minute / 100};0\n" for minute in range(0, 60, 5))
    (tmp_path / "log.csv").write_text("When;u_M_V;u_T_V;psi_rad;phi_rad\n" + rows)
    done = imported_here(tmp_path / "log.csv", ColumnMapping())
    assert done.log.sample_period_s == 300.0
    assert not any("apart" in told for told in done.found)


@pytest.mark.parametrize(("name", "per_s"), [("time_h", 3600.0), ("elapsed_min", 60.0), ("timeMs", 1e-3)])
def test_a_clock_in_any_unit_of_time_behind_a_name_of_times_is_converted(
    name: str, per_s: float, tmp_path: Path
) -> None:
    path = save_run(tmp_path / "run.mat", **{"t_s": None, name: T_S / per_s})
    for mapping in (ColumnMapping(), ColumnMapping(columns={"t_s": name})):
        np.testing.assert_allclose(imported_here(path, mapping).log.t_s, T_S, atol=1e-9)


def test_a_heading_with_a_stroke_is_no_path(tmp_path: Path) -> None:
    rows = [f"05/03/2024 11:59:{58 + t // 100:02d}.{t % 100:02d},{t / 100}" for t in range(0, 100, 2)]
    named = "Date/Time,x\n" + "\n".join(rows) + "\n"
    (tmp_path / "run.csv").write_text(named)
    columns = {"u_M_V": "x", "u_T_V": "x", "psi_rad": "x", "phi_rad": "x"}
    log = imported_here(tmp_path / "run.csv", ColumnMapping(columns=columns)).log
    np.testing.assert_allclose(log.t_s - log.t_s[0], np.arange(50) * 0.02, atol=1e-6)
