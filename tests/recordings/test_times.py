"""Times of a recording in seconds, whatever its clock counts: parts of a second, dates, ticks that run over, a clock that stands."""

from pathlib import Path

import numpy as np
import pytest
from scipy.io import savemat

from recordings.channels import Span
from recordings.mapping.mapping import ColumnMapping
from records.errors import BadInput
from records.logs.coarse_stamps import own_times
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


def test_samples_whose_time_goes_back_are_left_out_and_one_that_bears_the_stamp_before_gets_its_own(
    tmp_path: Path,
) -> None:
    """Truth: samples 10 ms apart; sample 7 bears the stamp of sample 6, sample 30 that of sample 20."""
    stamps = T_S.copy()
    stamps[[7, 30]] = stamps[6], stamps[20]
    savemat(tmp_path / "run.mat", {**RUN, "t_s": stamps})
    done = imported_here(tmp_path / "run.mat", ColumnMapping())
    np.testing.assert_allclose(done.log.t_s, np.delete(T_S, 30), atol=1e-9)
    np.testing.assert_array_equal(done.log.y[:, 0], np.delete(RUN["psi_rad"], 30))
    assert "psi_rad: 1 sample whose time does not rise left out, first at 0.2 s" in done.found
    (told,) = [told for told in done.found if "the stamp of the row before" in told]
    assert "1 row bears the stamp" in told


LATE_S = np.arange(4000) * 0.0005


@pytest.mark.parametrize(
    ("stamps", "begins_s"),
    [
        (np.floor(LATE_S * 1e3) / 1e3, 0.0),  # 1 ms at 2 kHz
        (np.round(LATE_S * 1e3 * 0.7) / 1e3 / 0.7, 0.0),  # a grid that rows do not fall on evenly
        (np.array([float(f"{t:.4g}") for t in 99.0 + LATE_S]) - 99.0, 0.0),  # 10 ms, from 100 s on 100 ms
        (np.floor((LATE_S + 0.0137) * 10.0) / 10.0, 0.0137),  # written by the tenth of a second, begun within one
    ],
)
def test_stamps_coarser_than_the_rows_give_each_row_its_own_time(stamps: np.ndarray, begins_s: float) -> None:
    """Truth: samples 0.5 ms apart; each is found within one step of its stamps, and their spacing within a thousandth."""
    psi_rad = np.sin(np.arange(4000) / 90.0)
    t_s, spread = own_times(stamps, psi_rad[:, None], "log.csv")
    assert spread is not None
    assert spread.rows == 4000 - len(set(stamps))
    step_s = np.diff(np.unique(stamps)).max()
    np.testing.assert_allclose(t_s, LATE_S + begins_s, atol=step_s)
    assert np.diff(t_s).min() > 0.0
    assert spread.period_s == pytest.approx(0.0005, rel=1e-3)


def test_rows_written_twice_are_no_samples_and_samples_in_bursts_without_rhythm_are_refused(tmp_path: Path) -> None:
    """Truth: every sample stands twice, the second time with its own command; then 1 to 12 samples to a stamp by chance."""
    twice = np.repeat(np.arange(50), 2)
    again = {name: values[twice] for name, values in RUN.items()} | {"u_T_V": np.tile([1.0, 2.0], 50)}
    savemat(tmp_path / "run.mat", again)
    log = imported_here(tmp_path / "run.mat", ColumnMapping()).log
    np.testing.assert_array_equal(log.t_s, T_S)
    np.testing.assert_array_equal(log.u[:, 1], 2.0)
    chance = np.repeat(np.arange(60) * 0.01, np.random.default_rng(1).integers(1, 13, 60))
    psi_rad = np.sin(np.arange(len(chance)) / 9.0)
    savemat(tmp_path / "run.mat", {**RUN, "u_M_V": 0 * psi_rad, "u_T_V": 0 * psi_rad, "psi_rad": psi_rad,
                                   "phi_rad": psi_rad, "t_s": chance})  # fmt: skip
    with pytest.raises(BadInput, match=r"from 1 to 12 to a stamp: nothing tells how far apart .*t_s=PERIOD\*row"):
        imported_here(tmp_path / "run.mat", ColumnMapping())


def test_a_gap_in_a_log_of_coarse_stamps_stays_a_gap() -> None:
    """Truth: 2 kHz with stamps of 1 ms, one second lost."""
    true_s = np.concatenate([LATE_S, LATE_S + 3.0])
    t_s, spread = own_times(np.floor(true_s * 1e3) / 1e3, np.sin(true_s * 9.0)[:, None], "log.csv")
    assert spread is not None
    np.testing.assert_allclose(t_s, true_s, atol=1e-3)


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


def test_seconds_as_large_as_days_since_1900_stay_seconds_by_their_steps(tmp_path: Path) -> None:
    # Truth: a clock that stands at 45000 s, half a day, when the log begins, and goes on by 10 ms a row, which as days are 864 s.
    done = imported_here(save_run(tmp_path / "run.mat", t_s=None, t=45000.0 + T_S), ColumnMapping())
    np.testing.assert_allclose(np.diff(done.log.t_s), np.diff(T_S), atol=1e-9)
    assert not any("days" in told for told in done.found)
