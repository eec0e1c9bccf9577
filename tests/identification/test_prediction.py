"""Exact slopes of readings against differences of predictions: windows, rotors that run on, sensors that combine rows, balances."""

from dataclasses import replace

import numpy as np
import pytest

from identification.experiments.table import KINDS
from identification.model.driven import driven_states
from identification.proof.bench import task
from identification.runs.log_run import log_run, rounding_sd
from identification.runs.prediction import blocks, predicted
from identification.runs.run import coefficient_names, with_starts
from sim.simulate import simulate
from tests.soak import sampled

RELATIVE = 2e-4


def check_slopes(run, names, theta):
    """by_parameter and by_start of all windows against central differences."""
    found = blocks(run, names, theta)
    J = np.concatenate([block.by_parameter for block in found])
    for place in range(len(names)):
        step = 1e-6 * abs(theta[place])
        ends = [predicted(run, names, theta + sign * step * np.eye(len(names))[place]) for sign in (1.0, -1.0)]
        expected = (ends[0] - ends[1]) / (2.0 * step) / run.sd
        np.testing.assert_allclose(
            J[:, place], expected, atol=RELATIVE * np.abs(expected).max() + 1e-12, err_msg=names[place]
        )


def value(bound, names):
    known = coefficient_names(bound.model)
    return np.array([bound.p[known.index(name)] for name in names])


EXPERIMENTS = [
    ("main_rotor", ("p_bM_0", "p_bM_2", "K_M", "p_FM_1", "p_FM_4")),
    ("gravity", ("tau_gE",)),
    ("elevation_steps", ("K_M", "p_bM_1", "p_FM_2", "J_E", "b_vE", "tau_gE")),
    ("azimuth_oscillation", ("K_T", "p_FT_1", "J_A", "b_vA")),
    ("reaction_balance", ("K_M", "p_bT_0", "p_FT_2", "K_A")),
    ("turned_by_hand", ("K_E", "K_M", "tau_gE")),
]


@pytest.mark.parametrize(("kind", "names"), sampled(EXPERIMENTS, keep=EXPERIMENTS[::2]))
def test_slopes_of_an_experiment_s_readings_by_the_parameters(bound, experiments, kind, names):
    run = KINDS[kind].run(experiments[kind], bound)
    check_slopes(run, names, value(bound, names))


def test_slopes_by_the_starts_of_the_windows(bound):
    """A start that moves by a little moves its own window's readings by the slope and no other's."""
    run = log_run(bound, task(bound).log, "log", 5.0)
    theta = np.zeros(0)
    found = blocks(run, (), theta)
    place = [str(state) for state in bound.model.states].index("psi_rad")
    step, moved = 1e-6, run.x0.copy()
    moved[3, place] += step
    difference = (predicted(with_starts(run, moved), (), theta) - predicted(run, (), theta)) / step / run.sd
    column = run.free.index("psi_rad")
    for number, block in enumerate(found):
        expected = block.by_start[:, column] if number == 3 else np.zeros(block.residual.size)
        np.testing.assert_allclose(difference[block.place], expected, atol=1e-3 * np.abs(found[3].by_start).max())


def test_windows_read_what_the_whole_run_reads_where_their_starts_are_its_states(bound):
    """Cut at any row and started from the true state there, a run predicts the same readings; its rotors run on by themselves."""
    work = task(bound)
    states = simulate(bound, work.log.t_s, work.x0, work.log.u).x
    states[:, [bound.model.states.index(state) for state in driven_states(bound.model)]] = 0.0
    whole = log_run(bound, work.log, "log", np.inf, at_first=work.x0)
    whole = with_starts(whole, states[:1])
    cut = log_run(bound, work.log, "log", 7.0, at_first=work.x0)
    cut = with_starts(cut, states[cut.begins])
    np.testing.assert_allclose(predicted(cut, (), np.zeros(0)), predicted(whole, (), np.zeros(0)), atol=1e-12)


def test_readings_that_repeat_share_one_rounding_error():
    sd = rounding_sd(np.array([1.0, 2.0, 2.0, 2.0, 2.0, 3.0]), step=np.sqrt(12.0))
    np.testing.assert_allclose(sd, [1.0, 2.0, 2.0, 2.0, 2.0, 1.0])


def test_a_row_without_a_measurement_gives_no_reading(bound):
    work = task(bound)
    log = work.log
    y = log.y.copy()
    y[100:200, 0] = np.nan
    run = log_run(bound, replace(log, y=y), "log", 5.0, at_first=work.x0)
    assert run.y.size == log.y.size - 100
    assert np.isfinite(run.y).all()
    assert sum(block.residual.size for block in blocks(run, (), np.zeros(0))) == run.y.size
