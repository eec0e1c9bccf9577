"""Truth: motion integrated in a hundred steps per sample. Poles of up to 400/s are read at 50 Hz: one step per sample cannot follow."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from identification.fit.belief import NOTHING
from identification.fit.ranges import ranges_of
from identification.runs.log_run import log_run
from identification.search.evolution import evolution
from identification.stages.estimate import problem_of
from identification.stages.holdout import prediction_tests
from identification.stages.logs import identify_logs
from records.errors import BadInput
from records.log import RunLog
from records.plant import load_plant
from sim.bind import bind
from sim.columns import log_columns
from sim.simulate import Conditions, simulate
from tests.soak import sampled

NAMES = ("b", "d", "k")
NOISE_rad = 1e-4


def arm(**values):
    """theta'' = b u - k theta - d theta': with d = 28/s one pole at 27/s, the other at 0.6/s."""
    plant = load_plant(Path(__file__).parents[2] / "plants/pamh_aeropendulum.toml")
    moved = {name: replace(plant.parameters[name], value=value) for name, value in values.items()}
    return bind(replace(plant, parameters=plant.parameters | moved))


def flown(truth):
    """Thirty seconds at 50 Hz, random levels held for 0.2 s."""
    rng = np.random.default_rng(1)
    t_s = 0.02 * np.arange(1500)
    u = np.repeat(rng.uniform(-1.0, 1.0, 150), 10)[:, None]
    y = simulate(truth, t_s, np.zeros(2), u, Conditions(resolution=[0.0], substeps=100)).y
    return RunLog(log_columns(truth.model), 0.02, "open", t_s, u, y + NOISE_rad * rng.standard_normal(y.shape))


FAST = [(10.0, 1), (28.0, 2), (100.0, 2), (140.0, 4), (400.0, 4)]


@pytest.mark.parametrize(("d_1_s", "substeps"), sampled(FAST, keep=FAST[::2]))
def test_a_fast_pole_comes_back_within_its_interval(d_1_s, substeps):
    """With one step the estimates at 100/s were 4 % off, ten of their sd; at 140/s and more the fit broke down."""
    truth = arm(b=80.0, d=d_1_s, k=15.66)
    found = identify_logs(arm(b=100.0, d=1.2 * d_1_s, k=13.0), {"log": flown(truth)}, NAMES)
    assert [run.substeps for run in found.runs] == [substeps]
    for name in NAMES:
        sd = float(found.belief.sd[found.belief.names.index(name)])
        assert abs(found.belief.value(name) - truth.parameter(name)) < 2.0 * sd, name


def test_a_log_held_out_is_predicted_in_as_many_steps():
    truth = arm(b=80.0, d=200.0, k=15.66)
    (test,) = prediction_tests(truth, {"log": flown(truth)})
    assert test.rms == pytest.approx(NOISE_rad, rel=0.1)


def test_what_no_steps_can_follow_is_refused():
    with pytest.raises(BadInput, match="leaves all bounds, in 64 steps"):
        identify_logs(arm(b=80.0, d=2e4, k=15.66), {"log": flown(arm(b=80.0, d=28.0, k=15.66))}, NAMES)


@pytest.mark.filterwarnings("error")
def test_a_search_over_motions_that_leave_all_bounds_goes_on_in_silence():
    """In one step per sample all of the range but its lower end breaks down; the search ends there, each time, and warns of nothing."""
    start = arm(b=80.0, d=28.0, k=15.66)
    run = log_run(start, flown(start), "log", 10.0)
    problem = problem_of((run,), ("d",), ranges_of(start, ("d",), {"d": (10.0, 1e4)}), NOTHING)
    values, best = evolution(problem, [0], 1, lambda _: None, lambda _done, _of: None)
    assert values[0] == pytest.approx(28.0, rel=0.02)
    assert np.isfinite(best).all()
    again, _ = evolution(problem, [0], 1, lambda _: None, lambda _done, _of: None)
    assert values == again
