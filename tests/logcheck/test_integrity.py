"""Logs spoiled in known ways: each defect is found, with its column and severity; clean and merely unusual logs are not refused."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from logcheck.integrity import Integrity, demand, examine
from logcheck.units.scale import misfit
from records.errors import BadInput
from records.log import LogColumns, RunLog
from sim.bind import bind
from sim.columns import log_columns
from sim.equilibrium import equilibrium
from sim.simulate import simulate
from tests.law_tables import ce150_table
from tests.replay.firmware_flights import flown, lively, plant, rows_of
from tests.soak import SOAK
from verification.host_law import host_law

TURN_STEP_RAD = 2.0 * np.pi / 4096.0
Spoil = Callable[[RunLog], RunLog]


@cache
def clean(duration_s: float = 20.0) -> RunLog:
    """A flight of the compiled law, with rotor speeds and rates as a rig would log them."""
    log = flown(host_law(ce150_table()), duration_s=duration_s)
    runs = simulate(plant(), log.t_s, lively(duration_s).x0, log.u, keep="x")
    assert runs.x is not None
    rng, states = np.random.default_rng(2), [str(state) for state in plant().model.states]
    measured = {name: runs.x[:, states.index(name)] for name in ("omega_M_rad_s", "omega_T_rad_s", "psi_dot_rad_s")}
    noisy = {name: np.round(values + rng.normal(0.0, 0.02, values.shape), 4) for name, values in measured.items()}
    return replace(log, extra={**log.extra, **noisy})


def _kinds(found: Integrity, severity: str | None = None) -> set[str]:
    return {finding.kind for finding in found.findings if severity in (None, finding.severity)}


def _examined(*logs: RunLog, holdout: Sequence[RunLog] = ()) -> Integrity:
    return examine(logs, plant(), holdout=holdout)


def _column(log: RunLog, name: str, values: np.ndarray) -> RunLog:
    """The log with the column `name` replaced."""
    if name == "t_s":
        return replace(log, t_s=values)
    if name in log.extra:
        return replace(log, extra={**log.extra, name: values})
    block = "u" if name in log.columns.inputs else "y"
    names = log.columns.inputs if block == "u" else log.columns.outputs
    changed = getattr(log, block).copy()
    changed[:, names.index(name)] = values
    return replace(log, **{block: changed})  # type: ignore[arg-type]


def _scaled(name: str, factor: float) -> Spoil:
    return lambda log: _column(log, name, log.column(name) * factor)


def _other_flight() -> RunLog:
    """Another run of the same rig: the same manoeuvre with another law."""
    return flown(host_law(ce150_table(prefilter_time_constant_s=0.5)))


def test_a_clean_log_has_no_findings_and_its_numbers_are_told() -> None:
    found = _examined(clean(), holdout=[_other_flight()])
    assert found.findings == ()
    demand(found)
    first = found.logs[0]
    assert not first.excluded.any()
    assert (first.timing.rows, first.timing.missing_by_time, first.timing.missing_by_seq) == (2001, 0, None)
    assert first.timing.period_error_ppm == pytest.approx(0.0, abs=1e-3)
    psi = first.excitation["psi_rad"]
    travelled = np.abs(np.diff(clean().y[:, 0])).sum() / TURN_STEP_RAD / 20.0
    assert psi.counts_per_s == pytest.approx(travelled)
    assert (psi.least, psi.greatest) == (clean().y[:, 0].min(), clean().y[:, 0].max())
    assert first.excitation["u_M_V"].counts_per_s is None


@pytest.mark.parametrize(
    ("spoil", "kind", "column"),
    [
        (_scaled("psi_rad", 180.0 / np.pi), "unit_slip", "psi_rad"),
        (_scaled("phi_rad", 180.0 / np.pi), "unit_slip", "phi_rad"),
        (_scaled("psi_rad", 1.0 / TURN_STEP_RAD), "unit_slip", "psi_rad"),
        (_scaled("psi_ref_rad", 180.0 / np.pi), "unit_slip", "psi_ref_rad"),
        (_scaled("psi_dot_rad_s", 180.0 / np.pi), "unit_slip", "psi_dot_rad_s"),
        (_scaled("omega_M_rad_s", 30.0 / np.pi), "unit_slip", "omega_M_rad_s"),
        (_scaled("omega_T_rad_s", 0.5 / np.pi), "unit_slip", "omega_T_rad_s"),
        (_scaled("u_M_V", 10.0), "unit_slip", "u_M_V"),
        (_scaled("u_M_V", 0.1), "unit_slip", "u_M_V"),
        (lambda log: replace(log, t_s=1e3 * log.t_s, sample_period_s=10.0), "time_unit", "t_s"),
        (lambda log: _column(log, "psi_rad", log.extra["psi_ref_rad"]), "copied_column", "psi_rad"),
        (lambda log: replace(log, u=0.0 * log.u, y=0.0 * log.y + 0.1, extra={}), "constant", None),
        (lambda log: replace(log, y=0.0 * log.y + 0.1, extra={}), "stuck_sensors", None),
        (lambda log: replace(log, y=np.nan * log.y, extra={}), "not_recorded", None),
        (
            lambda log: _column(log, "phi_rad", np.random.default_rng(8).permutation(log.y[:, 1])),
            "no_motion",
            "phi_rad",
        ),
        (lambda log: _column(log, "phi_rad", np.full(2001, 0.2)), "axis_stands", "phi_rad"),
        (lambda log: _column(log, "psi_rad", np.full(2001, 0.1)), "axis_stands", "psi_rad"),
        (lambda log: rows_of(log, np.arange(len(log.t_s)) < 10), "too_short", "t_s"),
    ],
)
def test_what_makes_a_log_worthless_is_refused_by_name(spoil: Spoil, kind: str, column: str | None) -> None:
    found = _examined(spoil(clean()))
    assert [(finding.kind, finding.column) for finding in found.refusals] == [(kind, column)]
    with pytest.raises(BadInput, match=kind.replace("_", " ")) as caught:
        demand(found)
    assert caught.value.expected
    assert caught.value.remedy


def _around_rest() -> RunLog:
    """A run in which both inputs swing about those that hold the arm level, by so little that the axes move by a degree."""
    t_s, rest = np.arange(2001) * 0.01, equilibrium(plant(), 0.0)
    u = rest.u0 + np.column_stack([0.03 * np.sin(3.0 * t_s), 0.2 * np.sin(2.0 * t_s)])
    return replace(
        clean(),
        t_s=t_s,
        u=u,
        y=simulate(plant(), t_s, rest.x0, u, keep="y").y,
        loop="open",
        extra={},
        table_digest=None,
    )


def _read_in(log: RunLog, column: str, step_rad: float, scale: float) -> RunLog:
    return _column(log, column, np.round(log.column(column) / step_rad) * step_rad * scale)


@pytest.mark.parametrize("column", ["psi_rad", "phi_rad"])
def test_degrees_within_the_stops_are_told_from_coarse_radians_by_how_the_plant_moves(column: str) -> None:
    """Truth: a small run in degrees; and a large one in radians, of a sensor as coarse as the encoder's step is in degrees."""
    small, large = _around_rest(), clean()
    degrees = _read_in(small, column, TURN_STEP_RAD, 180.0 / np.pi)
    coarse_rad = TURN_STEP_RAD * 180.0 / np.pi
    assert 3.0 * coarse_rad < np.ptp(degrees.column(column)) < 2.5
    assert misfit(degrees, plant(), column, 180.0 / np.pi) < misfit(degrees, plant(), column, 1.0)
    assert [(found.kind, found.column) for found in _examined(degrees).refusals] == [("unit_slip", column)]
    for whole in (1.0, 2.0, 4.0):
        coarse = _read_in(replace(large, extra={}), column, whole * coarse_rad, 1.0)
        assert misfit(coarse, plant(), column, 180.0 / np.pi) > misfit(coarse, plant(), column, 1.0)
        assert not _examined(coarse).refusals


@pytest.mark.parametrize(
    ("column", "step_deg"),
    [(column, step_deg) for column in ("psi_rad", "phi_rad") for step_deg in (0.01, 0.25, 1.0, 5.0, 15.0)],
)
def test_degrees_of_any_steps_are_told_and_whole_ones_are_no_counts(column: str, step_deg: float) -> None:
    """Truth: angles up to 25 and 56 degrees, read in steps of up to 15 degrees."""
    coarse = _read_in(replace(clean(), extra={}), column, np.radians(step_deg), 180.0 / np.pi)
    (found,) = _examined(coarse).refusals
    assert found.kind == "unit_slip"
    assert f"{column} is in degrees" in found.sentence


@pytest.mark.parametrize("step_deg", [0.1, 0.25, 0.5])
def test_coarse_degrees_within_the_stops_are_told_by_the_motion_alone(step_deg: float) -> None:
    """Truth: 2 degrees at most, which would be an angle in radians too, on neither grid of the sensor."""
    coarse = _read_in(_around_rest(), "phi_rad", np.radians(step_deg), 180.0 / np.pi)
    assert [(found.kind, found.column) for found in _examined(coarse).refusals] == [("unit_slip", "phi_rad")]


def test_steps_of_degrees_that_lie_on_the_sensor_s_grid_too_are_degrees() -> None:
    """Truth: steps of 15 degrees, each 10 000 of a sensor's of 1.5 mrad."""
    sensors = dict.fromkeys(plant().plant.sensors, 1.5e-3)
    rig = bind(replace(plant().plant, sensors=sensors))
    coarse = _read_in(replace(clean(), extra={}), "phi_rad", np.radians(15.0), 180.0 / np.pi)
    (found,) = examine((coarse,), rig).refusals
    assert "phi_rad is in degrees" in found.sentence


@pytest.mark.parametrize("step_rad", [0.05, 0.1, 0.2, 0.25, 0.5])
def test_a_coarse_sensor_of_round_steps_is_no_print_of_few_digits(step_rad: float) -> None:
    """Truth: readings in even steps up to 1 rad, which needs no more digits than they."""
    coarse = _read_in(replace(clean(), extra={}), "phi_rad", step_rad, 1.0)
    assert np.abs(coarse.column("phi_rad")).max() == 1.0
    assert not _examined(coarse).refusals


def test_angles_of_radians_beyond_the_stops_are_not_called_degrees_or_counts() -> None:
    log = clean()
    phi = log.y[:, 1]
    on_grid = _column(log, "phi_rad", phi * 40.0)
    off_grid = _column(log, "phi_rad", phi * 8.0 + np.random.default_rng(5).normal(size=2001))
    for spoilt in (on_grid, off_grid):
        assert 1.5 * np.radians(130.0) < np.quantile(np.abs(spoilt.y[:, 1]), 0.95) < 130.0
    for other in (on_grid, off_grid, _column(log, "psi_rad", log.y[:, 0] * 1e300)):
        (found,) = _examined(replace(other, extra={})).refusals
        assert found.kind == "no_angle"
        assert "no angle of this plant" in found.sentence
        assert "another plant's log" in found.remedy
        assert "degrees" not in found.sentence
        assert "counts" not in found.sentence


def test_outputs_that_fit_only_in_each_others_place_are_called_exchanged() -> None:
    log = clean()
    wide = log.y * np.array([1.0, 2.0])
    assert np.quantile(np.abs(wide[:, 1]), 0.95) > 1.5 * np.pi / 4.0
    assert not _examined(replace(log, y=wide, extra={})).refusals
    (found,) = _examined(replace(log, y=wide[:, ::-1].copy(), extra={})).refusals
    assert (found.kind, found.column, found.remedy) == ("exchanged_columns", "psi_rad", "exchange psi_rad and phi_rad")


def test_a_log_of_another_plant_is_refused() -> None:
    columns = LogColumns("quanser_aero", ("u_M_V", "u_T_V"), ("theta_rad", "psi_rad"), (), ())
    found = _examined(replace(clean(), columns=columns, extra={}))
    assert _kinds(found) == {"other_plant"}


def test_missing_rows_are_counted_by_time_and_by_number() -> None:
    log, kept = clean(), np.ones(2001, bool)
    kept[[300, 301, 900]] = False
    found = _examined(rows_of(replace(log, seq=np.arange(2001)), kept))
    assert _kinds(found) == {"missing_rows", "sequence_gap"}
    assert (found.logs[0].timing.missing_by_time, found.logs[0].timing.missing_by_seq) == (3, 3)
    closed_up = replace(rows_of(replace(log, seq=np.arange(2001)), kept), t_s=log.t_s[:-3])
    assert _kinds(_examined(closed_up)) == {"sequence_gap", "sequence_against_time"}


def test_repeated_and_disordered_rows_are_left_out() -> None:
    log = clean()
    seq = np.arange(2001)
    seq[500] = 499
    seq[800] = 700
    found = _examined(replace(log, seq=seq))
    assert _kinds(found, "exclude") == {"repeated_rows", "disordered_rows"}
    assert np.flatnonzero(found.logs[0].excluded).tolist() == [500, 800]


def test_an_axis_that_is_declared_locked_may_stand() -> None:
    log = _column(clean(), "phi_rad", np.full(2001, 0.2))
    assert _kinds(_examined(replace(log, locked=("azimuth",)))) == {"constant"}


@pytest.mark.parametrize("period", [2, 7])
def test_readings_that_are_repeated_until_the_next_one_are_left_out(period: int) -> None:
    # Rows 3, 3 + m, ... hold fresh readings, as the sensor was sampled from there on at every m-th row of the log.
    log, rows = clean(), np.arange(2001)
    fresh = np.maximum((rows - 3) // period * period + 3, 3 - period * (3 // period))
    found = _examined(replace(log, y=log.y[fresh]))
    assert _kinds(found, "exclude") == {"held_readings"}
    excluded = found.logs[0].excluded
    assert not excluded[(rows % period == 3 % period) & (rows >= 3)].any()
    assert excluded.mean() == pytest.approx(1.0 - 1.0 / period, abs=0.01)


def test_a_clock_that_is_off_and_one_that_jitters_are_told_apart() -> None:
    log = clean()
    off = _examined(replace(log, t_s=log.t_s * 1.002))
    assert _kinds(off) == {"sample_period"}
    assert off.logs[0].timing.period_error_ppm == pytest.approx(2000.0, rel=1e-6)
    late_s = np.random.default_rng(4).uniform(0.0, 1e-3, 2001)
    jittered = _examined(replace(log, t_s=log.t_s + late_s))
    assert _kinds(jittered) == {"jitter"}
    assert jittered.logs[0].timing.jitter_rms_s == pytest.approx(1e-3 * np.sqrt(1.0 / 6.0), rel=0.05)
    # Truth: rows 10 ms apart on average, each late by its own 2 ms rms: 2000 of these move the mean by 4500 ppm rms, and not the clock.
    steps_s = 0.01 + np.random.default_rng(5).uniform(-1.0, 1.0, 2000) * 2e-3 * np.sqrt(3.0)
    waiting = _examined(replace(log, t_s=np.concatenate([[0.0], np.cumsum(steps_s)])))
    assert abs(waiting.logs[0].timing.period_error_ppm) > 500.0
    assert "sample_period" not in _kinds(waiting)


def test_missing_numbers_glitches_and_rows_beyond_the_stops_are_found_where_they_are() -> None:
    log = clean()
    y = log.y.copy()
    y[100:103, 0], y[700, 1], y[1200:1205, 0] = np.nan, y[700, 1] + 1.0, 1.2
    found = _examined(replace(log, y=y))
    assert _kinds(found) == {"not_a_number", "glitch", "beyond_stops", "dead_stretch"}
    unread = np.argwhere(found.logs[0].unread).tolist()
    assert unread == [[700, 1], [1200, 0], [1201, 0], [1202, 0], [1203, 0], [1204, 0]]


def test_saturation_and_inputs_beyond_the_limits_are_shares_of_the_rows() -> None:
    log = clean()
    u = log.u.copy()
    u[:500, 1], u[500:600, 0] = 10.0, 11.0
    found = _examined(replace(log, u=u))
    assert _kinds(found) == {"saturated", "beyond_limits"}
    assert found.logs[0].saturation["u_T_V"].upper == pytest.approx(500 / 2001)


def test_an_input_at_its_limit_in_one_stretch_is_told_from_when_to_when() -> None:
    log = clean()
    u = log.u.copy()
    u[500:600, 0] = 0.0
    (found,) = _examined(replace(log, u=u)).findings
    assert found.sentence == "u_M_V is at its limits: 5.0% of the rows at 0 V, all from 5 s to 5.99 s"
    u[700:800, 0] = 0.0
    (found,) = _examined(replace(log, u=u)).findings
    assert found.sentence == "u_M_V is at its limits: 10.0% of the rows at 0 V"


@pytest.mark.parametrize(("cut", "how"), [(np.minimum, "exceeds"), (np.maximum, "falls below")])
def test_an_input_that_is_cut_off_within_the_plants_limits_is_noted(cut: Callable[..., np.ndarray], how: str) -> None:
    log = clean()
    limit = float(np.median(log.u[:, 0]))
    (found,) = _examined(_column(log, "u_M_V", cut(log.u[:, 0], limit))).findings
    assert (found.kind, found.column, found.severity) == ("clipped", "u_M_V", "note")
    assert f"u_M_V never {how} {limit:.5g} V, where 50.0% of its rows stand" in found.sentence


def test_an_input_of_steps_is_not_called_cut_off() -> None:
    log = clean()
    steps = np.where(np.arange(2001) // 100 % 2 == 1, 0.5, -0.5)
    once = np.where(np.arange(2001) < 400, log.u[:, 1].max() + 0.1, log.u[:, 1])
    for u_T in (steps, once):
        assert "clipped" not in _kinds(_examined(_column(log, "u_T_V", u_T)))


def test_numbers_off_the_encoders_grid_look_simulated_and_a_coarser_grid_is_named() -> None:
    log = clean()
    smooth = _column(log, "psi_rad", log.y[:, 0] + 1e-3 * np.random.default_rng(1).normal(size=2001))
    assert _kinds(_examined(smooth)) == {"simulated_looking"}
    coarse = _column(log, "psi_rad", np.round(log.y[:, 0] / 0.005) * 0.005)
    assert _kinds(_examined(coarse)) == {"other_grid"}
    assert _kinds(_examined(_column(log, "psi_rad", log.y[:, 0] + 0.03))) == set()


def test_a_holdout_that_overlaps_the_training_runs_is_refused_whatever_its_times() -> None:
    log = clean()
    part = rows_of(log, np.arange(2001) > 1500)
    found = _examined(log, holdout=[replace(part, t_s=part.t_s - part.t_s[0])])
    assert _kinds(found, "refuse") == {"holdout_overlap"}
    assert _kinds(_examined(log, holdout=[_other_flight()])) == set()


def test_rows_given_twice_for_training_count_once() -> None:
    found = _examined(clean(), clean())
    assert _kinds(found) == {"duplicate_rows"}
    assert not found.logs[0].excluded.any()
    assert found.logs[1].excluded.mean() > 0.9


@pytest.mark.parametrize(("factor", "severity"), [(1.1, None), (1.5, "note"), (2.5, "note")])
def test_logs_that_hold_the_same_angle_with_another_input_are_told_and_not_refused(
    factor: float, severity: str | None
) -> None:
    other = _other_flight()
    scaled = replace(other, u=np.column_stack([other.u[:, 0] / factor, other.u[:, 1]]))
    found = [finding for finding in _examined(clean(), scaled).findings if finding.kind == "two_plants"]
    assert [finding.severity for finding in found] == ([] if severity is None else [severity])


@pytest.mark.parametrize("column", ["psi_rad", "omega_M_rad_s", "psi_dot_rad_s", "psi_ref_rad"])
def test_a_column_that_was_never_measured_is_noted_without_warnings(
    column: str, recwarn: pytest.WarningsRecorder
) -> None:
    found = _examined(_column(clean(), column, np.full(2001, np.nan)), holdout=[_other_flight()])
    assert [(finding.kind, finding.column) for finding in found.findings] == [("not_recorded", column)]
    assert not [str(warning.message) for warning in recwarn]


def test_a_long_log_is_examined_and_its_defect_found() -> None:
    """A tenth of a million rows; in a soak all of it."""
    log, times = clean(), 500 if SOAK else 50
    n = 2001 * times
    rows = np.resize(
        np.concatenate([np.arange(2001), np.arange(2001)[::-1]]), n
    )  # there and back: one recording has no seams
    noise = np.random.default_rng(6).integers(-1, 2, (n, 2)) * TURN_STEP_RAD
    long = replace(
        log,
        t_s=np.arange(n) * 0.01,
        u=log.u[rows] + 1e-3 * noise,
        y=log.y[rows] + noise,
        extra={name: values[rows] for name, values in log.extra.items()},
    )
    place = int(0.7777 * n)
    long.y[place, 0] += 1.0
    found = _examined(long)
    assert np.argwhere(found.logs[0].unread).tolist() == [[place, 0]]
    assert not found.refusals


def _one_after_another(*logs: RunLog) -> RunLog:
    """Several logs in one file, the time of which goes on."""
    y, u = np.concatenate([log.y for log in logs]), np.concatenate([log.u for log in logs])
    return replace(logs[0], t_s=np.linspace(0.0, 0.01 * (len(y) - 1), len(y)), y=y, u=u, extra={})


def test_several_recordings_in_one_file_are_cut_apart_at_their_seams() -> None:
    log = clean()
    examined = _examined(_one_after_another(log, log, log))
    (found,) = [finding for finding in examined.findings if finding.kind == "seam"]
    assert np.flatnonzero(examined.logs[0].begins).tolist() == [2001, 4002]
    assert [found.start_s, found.end_s] == pytest.approx([20.01, 40.02])
    leaps = np.abs(log.y[0] - log.y[-1]) / TURN_STEP_RAD
    assert f"psi_rad by {leaps[0]:.0f} steps and phi_rad by {leaps[1]:.0f} steps" in found.sentence
    assert "and so at 40.02 s" in found.sentence


@pytest.mark.parametrize("columns", [[0], [1]])
def test_one_output_that_jumps_alone_is_a_count_slip_and_no_seam(columns: list[int]) -> None:
    log = clean()
    y = log.y.copy()
    y[900:, columns] -= 200 * TURN_STEP_RAD
    assert not _kinds(_examined(replace(log, y=y, extra={}))) & {"seam", "dead_stretch"}


def test_a_leap_of_all_outputs_over_missing_rows_or_repeated_readings_is_no_seam() -> None:
    # From 7 s on both axes are under way: 20 rows later both are far from where they were, as honest motion.
    log, rows = clean(), np.arange(2001)
    fastest = int(np.argmax(np.abs(log.y[20:] - log.y[:-20]).min(axis=1)))
    lost = (rows > fastest) & (rows < fastest + 20)
    assert (np.abs(log.y[fastest + 20] - log.y[fastest]) > 40 * TURN_STEP_RAD).all()
    assert _kinds(_examined(rows_of(log, ~lost))) == {"missing_rows", "break"}
    held = replace(log, y=log.y[np.where(lost, fastest, rows)])
    assert "seam" not in _kinds(_examined(held))


def test_noise_of_a_count_in_a_log_at_rest_is_no_seam() -> None:
    log = clean()
    counts = np.zeros((2001, 2))
    counts[::150], counts[1000:] = 2.0, 1.0
    assert "seam" not in _kinds(_examined(replace(log, y=counts * TURN_STEP_RAD, extra={})))


@pytest.mark.parametrize("rows", [30, 300])
def test_a_reading_that_stops_is_left_out_from_when_to_when_with_its_jumps(rows: int) -> None:
    log = clean()
    psi = log.y[:, 0].copy()
    psi[600 : 600 + rows] = 0.0
    jumps = [abs(psi[599]) / TURN_STEP_RAD, abs(psi[600 + rows]) / TURN_STEP_RAD]
    assert min(jumps) > 30.0
    (found,) = _examined(_column(log, "psi_rad", psi)).findings
    assert (found.kind, found.column, found.severity) == ("dead_stretch", "psi_rad", "exclude")
    assert [found.start_s, found.end_s] == pytest.approx([6.0, 5.99 + 0.01 * rows])
    assert f"jumps there by {jumps[0]:.0f} steps, it jumps away by {jumps[1]:.0f} steps" in found.sentence


def test_a_reading_that_freezes_amid_motion_is_noted_and_an_axis_that_stops_is_not() -> None:
    log, rows = clean(), np.arange(2001)
    phi = log.y[:, 1]
    fastest = int(np.argmax(np.abs(phi[200:] - phi[:-200])))
    frozen = np.where((rows >= fastest) & (rows < fastest + 200), phi[fastest], phi)
    assert _kinds(_examined(_column(log, "phi_rad", frozen))) == {"dead_stretch"}
    stopped = np.maximum(phi, phi[fastest + 5])  # a stop that takes all speed in one row
    assert "dead_stretch" not in _kinds(_examined(_column(log, "phi_rad", stopped)))


def test_a_link_that_fails_for_a_second_is_noted_by_output_and_is_no_seam() -> None:
    log, rows = clean(), np.arange(2001)
    fastest = int(np.argmax(np.abs(log.y[100:] - log.y[:-100]).min(axis=1)))
    frozen = replace(log, y=log.y[np.where((rows > fastest) & (rows < fastest + 100), fastest, rows)])
    found = _examined(frozen).findings
    assert [(finding.kind, finding.column) for finding in found] == [
        ("dead_stretch", "psi_rad"),
        ("dead_stretch", "phi_rad"),
    ]


@pytest.mark.parametrize("rows", [0, 1, 2, 3])
def test_logs_of_hardly_any_rows_are_refused_and_not_crashed_on(rows: int) -> None:
    found = _examined(rows_of(clean(), np.arange(2001) < rows))
    assert _kinds(found) == {"too_short"}


def test_the_columns_of_the_plant_are_those_of_its_logs() -> None:
    assert clean().columns == log_columns(plant().model)
