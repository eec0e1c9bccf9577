"""Where windows start: what was never read may be anywhere, a gap is bridged, and what the rotors did before the log leaves no trace."""

from dataclasses import replace

import numpy as np
import pytest

from identification.runs.driven_start import driven_start
from identification.runs.log_run import run_of
from identification.runs.prediction import blocks
from identification.runs.window_starts import crawling, window_starts
from identification.stages.logs import Asked, identify_logs
from records.log import RunLog
from records.plant import load_plant
from sim.bind import bind
from sim.columns import log_columns
from sim.model import symbol
from sim.simulate import Conditions, simulate
from tests import plants
from tests.identification.flights import cut
from tests.own_plants import SUSPENSION, TANKS
from tests.soak import SOAK


@pytest.fixture(scope="module")
def begun(flown):
    """Its first 20 s, whose rotors turn already at the first row."""
    return cut(flown, 0.0, 20.0)


def without(log, column, rows=slice(None)):
    y = log.y.copy()
    y[rows, column] = np.nan
    return replace(log, y=y)


def errors_sd(bound, found):
    true = np.array([bound.parameter(name) for name in found.belief.names])
    return np.abs(found.belief.mean - true) / found.belief.sd


def test_rotors_that_turned_before_the_log_do_not_move_the_estimates(bound, begun):
    """Within 3 sd of the truth; with 0.2 % of the rotors' start still there J_E was off by 8.6 sd."""
    assert np.all(errors_sd(bound, identify_logs(bound, {"log": begun}, ("J_E", "b_vE", "J_A", "b_vA"))) < 3.0)


def test_a_position_that_was_never_read_may_be_anywhere_between_its_stops(bound, begun):
    """Uniform between -45 and 45 deg; guessed to 0.03 rad of 0, as it was, b_vA came out 7.6 sd off."""
    log = without(begun, 0)
    run = run_of(bound, log, "log", 6.0)
    reach = 2.0 * bound.parameter("Psi_lim")
    np.testing.assert_allclose(run.x0[:, 1], 0.0)
    np.testing.assert_allclose(run.start_sd[:, run.free.index("psi_rad")], reach / np.sqrt(12.0))
    found = identify_logs(bound, {"log": log}, ("J_A", "b_vA", "b_cA"), Asked(window_s=6.0))
    assert np.all(errors_sd(bound, found) < 3.0)


def test_a_window_that_begins_in_a_gap_starts_between_the_readings_on_either_side(bound, begun):
    """Elevation of -0.52 rad at 10 s and -0.35 rad at 14 s; it may be off by all the range that was read."""
    run = run_of(bound, without(begun, 0, slice(1000, 1400)), "log", 1.0)
    within = (run.t_s[run.begins] > 10.1) & (run.t_s[run.begins] < 13.9)
    assert within.sum() >= 3
    share = (run.t_s[run.begins[within]] - begun.t_s[999]) / (begun.t_s[1400] - begun.t_s[999])
    expected = begun.y[999, 0] + share * (begun.y[1400, 0] - begun.y[999, 0])
    np.testing.assert_allclose(run.x0[within, 1], expected, atol=1e-9)
    sd = run.start_sd[:, run.free.index("psi_rad")]
    assert np.all(sd[within] == pytest.approx(np.ptp(begun.y[:, 0])))
    assert np.all(sd[~within] < 0.1)


def test_what_shows_no_motion_may_crawl_within_a_step():
    """Steps of 0.5 at 10 Hz: 0.1 per second from rest at 0 s crosses one each 5 s; after 20 s it rests again."""
    t_s = 0.1 * np.arange(601)
    y = 0.5 * np.round(0.1 * np.clip(t_s, 0.0, 20.0) / 0.5)
    speed, most = crawling(t_s, y, np.array([10, 100, 400]), 0.5)
    np.testing.assert_allclose(speed, [0.0, 0.1, 0.0], atol=2e-3)
    np.testing.assert_allclose(most, [0.5 / 2.5, 0.1, 0.5 / 42.5], rtol=0.03)


def test_what_stood_long_may_be_setting_out_or_come_to_rest():
    """Truth: it stands for 60 s and sets out by 0.02 per second squared: after 4 s it runs at 0.08, and 1 s later has gone half a step.

    Thirty seconds before it is as still as the step's 0.5 in the 65 s until then say; backwards in time it comes to rest.
    """
    t_s = 0.1 * np.arange(901)
    y = 0.5 * np.round(0.01 * np.clip(t_s - 60.0, 0.0, None) ** 2 / 0.5)
    speed, most = crawling(t_s, y, np.array([300, 640]), 0.5)
    assert speed.tolist() == [0.0, 0.0]
    assert most == pytest.approx([0.5 / 65.0, 0.5 / 4.0], rel=0.05)
    assert most[1] > 0.08
    backwards = crawling(t_s, y[::-1], np.array([260, 600]), 0.5)
    assert backwards[1] == pytest.approx(most[::-1], rel=0.01)


@pytest.mark.parametrize("window_s", [0.4, 1.6])
def test_a_window_may_begin_while_an_axis_crawls_within_an_encoder_step(bound, flown, window_s):
    """From 42 s on, within 3 sd; where no step in 0.08 s was taken for rest J_E was 8.6 sd off."""
    found = identify_logs(
        bound, {"log": cut(flown, 42.0, 8.0)}, ("J_E", "b_vE", "J_A", "b_vA"), Asked(window_s=window_s)
    )
    assert found.runs[0].begins.size > 1
    assert np.all(errors_sd(bound, found) < 3.0)


def test_a_fit_over_one_long_window_begins_from_starts_that_were_fitted(bound, flown):
    """Three seconds at a time, J_E within 3 sd; with parameters and a rotor's guessed start let go at once it was 6.3 sd off from 60 s on.

    Whether all is explained, so that the log is taken whole, hangs on the last bits of the flight where the azimuth comes to rest: in
    most of five it is.
    """
    begins_s = (58.0, 60.0, 60.5, 61.0, 62.0) if SOAK else (58.0, 60.0, 62.0)
    found = [identify_logs(bound, {"log": cut(flown, begin_s, 3.0)}, ("J_E",)) for begin_s in begins_s]
    assert sum(entry.runs[0].begins.size == 1 for entry in found) > len(begins_s) // 2
    assert all(np.all(errors_sd(bound, entry) < 3.0) for entry in found)


def test_a_state_that_only_the_inputs_drive_starts_where_they_brought_it_also_where_it_is_read():
    """The truth's own run in windows of half a second leaves no residual; counted twice, the current was off by its own size."""
    rig = plants.bound("maglev_coil")
    t_s = 0.01 * np.arange(1000)
    u = np.repeat(np.random.default_rng(1).uniform(0.2, 0.8, 50), 20)[:, None]
    y = np.asarray(simulate(rig, t_s, np.zeros(1), u, Conditions(keep="y")).y).reshape(-1, 1)
    run = run_of(rig, RunLog(log_columns(rig.model), 0.01, "open", t_s, u, y), "log", 0.5)
    residual = np.concatenate([block.residual for block in blocks(run, (), np.zeros(0))])
    assert len(run.begins) > 10
    assert np.max(np.abs(residual * run.sd)) < 1e-3 * np.ptp(y)


def test_a_driven_state_that_is_read_runs_on_from_its_first_reading(tmp_path):
    """Truth: two tanks that stand at 0.3 and 0.2 m as the log begins. From empty ones, where a root has no slope, nothing is estimated."""
    path = TANKS.write(tmp_path, "tanks")
    equations = tmp_path / "tanks.py"
    read = equations.read_text().replace('outputs={"h2_m": h2}', 'outputs={"h1_m": h1, "h2_m": h2}')
    equations.write_text(read.replace('sensors={"gauge"', 'sensors={"upper": SensorPlace("h1_m", "m", 1.0), "gauge"'))
    path.write_text(path.read_text() + "\n[sensors.h1_m]\nresolution_m = 1e-4\n")
    bound, t_s = bind(load_plant(path)), 0.1 * np.arange(30_000)
    u = 3.0 + 1.0 * np.sign(np.sin(0.05 * t_s))[:, None]
    y = simulate(bound, t_s, [0.3, 0.2], u).y
    log = RunLog(log_columns(bound.model), 0.1, "open", t_s, u, y)
    begun = driven_start(bound, log, None)
    np.testing.assert_allclose(begun.carried.x0, [0.3, 0.2], atol=1e-4)
    point = blocks(run_of(bound, log, "log", np.inf), ("k", "A"), bound.p[[1, 0]])
    assert all(np.all(np.isfinite(block.by_parameter)) for block in point)


def test_an_axis_whose_position_is_no_output_may_start_anywhere():
    arm = plants.bound("aeroshield")
    speed = {"theta_dot_rad_s": arm.model.axes[0].velocity}
    rig = replace(
        arm, model=replace(arm.model, outputs=speed), plant=replace(arm.plant, sensors={**dict.fromkeys(speed, 1e-3)})
    )
    t_s = 0.01 * np.arange(200)
    log = RunLog(log_columns(rig.model), 0.01, "open", t_s, np.ones((200, 1)), np.sin(t_s)[:, None])
    assert "theta_rad" in run_of(rig, log, "log", 0.5).free


def test_a_state_that_is_neither_read_nor_of_an_axis_starts_where_it_would_settle_and_is_free():
    """A winding with w' = (u - w - 0.5 theta') / T settles at u - 0.5 theta'; held at 0, as it was, J came out 5 times too small."""
    arm = plants.bound("aeroshield")
    winding, speed = symbol("w_V"), arm.model.axes[0].velocity
    (u,) = arm.model.inputs
    model = replace(
        arm.model,
        states=(*arm.model.states, winding),
        rates={**arm.model.rates, winding: (u - winding - 0.5 * speed) / arm.model.parameter_symbols[0]},
    )
    t_s = 0.01 * np.arange(400)
    log = RunLog(log_columns(model), 0.01, "open", t_s, 1.0 + t_s[:, None], np.sin(t_s)[:, None])
    begins = np.array([100, 200, 300])
    x0, free, sd = window_starts(replace(arm, model=model), log, begins, None)
    np.testing.assert_allclose(x0[:, -1], 1.0 + t_s[begins] - 0.5 * np.cos(t_s[begins]), atol=0.01)
    assert free[-1] == "w_V"
    assert np.all(sd[:, -1] > np.max(np.abs(x0[:, -1])))


def test_axes_of_which_only_the_difference_is_measured_start_with_any_speed(tmp_path):
    """Truth: the plant that made the log, each estimate within 3 sd of it and told to 2 %. Held at rest at each window's first row, as both
    were, k_s came out a tenth too soft, ten sd off.
    """
    bound = bind(load_plant(SUSPENSION.write(tmp_path, "suspension")))
    t_s = 0.005 * np.arange(2000)
    levels = np.random.default_rng(1).uniform(-800.0, 800.0, 25)
    u = np.repeat(levels, 80)[:, None]
    log = RunLog(log_columns(bound.model), 0.005, "open", t_s, u, simulate(bound, t_s, np.zeros(4), u).y)
    names = ("m_s", "k_s", "c_s")
    found = identify_logs(bound, {"log": log}, names, Asked(window_s=1.0))
    assert np.all(errors_sd(bound, found) < 3.0)
    assert np.all(found.belief.sd < 0.02 * found.belief.mean)
