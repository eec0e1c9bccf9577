"""What errors that last do to an interval, and which states need no start of their own."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.signal import lfilter

from identification.experiments.ce150.elevation import turning_rad_s
from identification.experiments.ce150.windows import fastest_row
from identification.fit.normal_equations import Starts
from identification.model.driven import driven_model
from identification.runs.prediction import Block
from identification.uncertainty.correlation import score
from identification.uncertainty.identifiability import unseen
from sim.plants import MODELS


def inflation(residual):
    """Of a straight line's slope and level fitted to a minute at 100 Hz."""
    n = residual.size
    t_s = np.arange(n) * 0.01
    J = np.column_stack([np.ones(n), np.sin(0.5 * t_s)])
    block = Block(residual, J, np.zeros((n, 0)), t_s, slice(0, n))
    run = SimpleNamespace(channel=np.zeros(n, dtype=int), t_s=t_s)
    starts = Starts(np.zeros((1, 0, 0)), np.zeros((1, 2, 0)), np.zeros((1, 0)))
    return score(run, starts, (block,), 0).inflation(1e-6 * np.eye(2), 0.0)


def test_correlated_errors_count_for_fewer_samples():
    """Errors e_k = 0.9 e_(k-1) + w_k: a mean over many varies (1 + 0.9) / (1 - 0.9) = 19 times more than were they independent."""
    rng = np.random.default_rng(0)
    found = [inflation(lfilter([np.sqrt(1 - 0.9**2)], [1.0, -0.9], rng.standard_normal(6000))) for _ in range(40)]
    allowance = 1.0 + 2.0 * np.sqrt(2.0 / 60)
    assert np.mean(found) == pytest.approx(19.0 * allowance, rel=0.25)


def test_independent_errors_count_as_they_are():
    rng = np.random.default_rng(1)
    found = [inflation(rng.standard_normal(6000)) for _ in range(40)]
    assert np.mean(found) == pytest.approx(1.0 + 2.0 * np.sqrt(2.0 / 60), rel=0.15)


def test_a_direction_without_information_is_named_with_its_weights():
    H = 100.0 * np.array([[1.0, -1.0, 0.0], [-1.0, 1.0, 0.0], [0.0, 0.0, 1e4]])
    (found,) = unseen(("a", "b", "c"), H, np.ones(3))
    assert dict(found.weights) == pytest.approx({"a": np.sqrt(0.5), "b": np.sqrt(0.5)})
    assert found.relative_sd > 1e3


@pytest.mark.parametrize(
    ("plant", "states"),
    [
        ("ce150", ("omega_M_rad_s", "omega_T_rad_s")),
        ("antx_2dof_drone", ("M_filtered", "M_filtered_rate")),
        ("emps", ()),
    ],
)
def test_states_that_inputs_alone_drive_are_found(plant, states):
    part = driven_model(MODELS[plant]())
    assert tuple(str(state) for state in (part.states if part else ())) == states


def test_a_turning_speed_is_right_on_average_in_spite_of_the_encoder_s_steps():
    """A hand that sways at 1 rad/s amplitude, with one reading that leaps: mean speed over each sample to 2 % of its largest."""
    step, t_s = 2 * np.pi / 4096, np.arange(2000) * 0.01
    angle = np.sin(t_s)
    read = np.round(angle / step) * step
    read[700] += 0.3
    found = turning_rad_s(t_s, read, step)
    mean = np.diff(np.sin(np.append(t_s, t_s[-1] + 0.01))) / 0.01
    inner = slice(10, -10)
    assert np.max(np.abs(found - mean)[inner]) < 0.06
    assert np.sqrt(np.mean((found - mean)[inner] ** 2)) < 0.02
    assert abs(np.mean(found[inner] ** 2 - mean[inner] ** 2)) < 1e-3


def test_a_window_begins_where_the_axis_is_fast():
    t_s = np.arange(500) * 0.01
    angle = np.where(t_s < 1.0, 0.0, np.where(t_s < 1.2, 5.0 * (t_s - 1.0), 1.0))
    assert 1.0 <= t_s[fastest_row(t_s, angle, 0, 2.0)] <= 1.2
