"""Logs as even records, and a linear model under their inputs: truths written out."""

import numpy as np
import pytest

from identification.frequency.lateral import StateSpace
from identification.frequency.models.linear_run import linear_run
from identification.frequency.responses.record import Record, record_of, with_instruments
from records.errors import BadInput
from records.log import RunLog
from records.logs.columns import LogColumns

COLUMNS = LogColumns("lag", ("u_V",), ("x_rad",), ("x_ref_rad",), ())


def log(t_s, u, y, loop="open", **extra):
    return RunLog(COLUMNS, 0.1, loop, np.asarray(t_s), np.asarray(u)[:, None], np.asarray(y)[:, None], extra)


def test_a_lost_row_and_a_missing_reading_lie_on_lines_and_the_input_before_is_held():
    t_s = np.array([0.0, 0.1, 0.3, 0.4, 0.5])
    found = record_of(log(t_s, [1.0, 2.0, 3.0, 4.0, 5.0], [0.0, 1.0, 3.0, np.nan, 5.0]), "gap", ("x_rad",))
    np.testing.assert_allclose(found.y[:, 0], [0.0, 1.0, 2.0, 3.0, 4.0, 5.0])
    np.testing.assert_array_equal(found.u[:, 0], [1.0, 2.0, 2.0, 3.0, 4.0, 5.0])
    assert found.bridged == {"x_rad": pytest.approx(2.0 / 6.0)}


def test_an_output_that_was_never_read_is_refused():
    with pytest.raises(BadInput, match=r"column 'x_rad'.*0 readings"):
        record_of(log([0.0, 0.1], [1.0, 2.0], [np.nan, np.nan]), "blind", ("x_rad",))


def test_a_closed_loop_is_told_by_its_references_unless_none_moves():
    t_s, u = 0.1 * np.arange(4), np.array([0.0, 1.0, 0.0, 1.0])
    for reference, by in (([0.0, 1.0, 2.0, 3.0], [0.0, 1.0, 2.0, 3.0]), ([1.0] * 4, [0.0, 1.0, 0.0, 1.0])):
        closed = log(t_s, u, u, "closed", x_ref_rad=np.array(reference))
        found = with_instruments([record_of(closed, "loop", ("x_rad",))])
        np.testing.assert_array_equal(found[0].r[:, 0], by)


def test_a_reference_that_is_missing_in_a_row_is_that_of_the_row_before():
    reference = np.array([np.nan, 0.5, np.nan, 0.7])
    found = record_of(
        log(0.1 * np.arange(4), np.ones(4), np.ones(4), "closed", x_ref_rad=reference), "loop", ("x_rad",)
    )
    np.testing.assert_array_equal(found.r[:, 0], [0.5, 0.5, 0.5, 0.7])


def test_of_more_references_than_inputs_those_that_move_tell_of_the_loop():
    """A cart behind a belt: the pulley is measured first, the cart's reference is what moves."""
    columns = LogColumns("cart", ("u_V",), ("phi_rad", "x_m"), ("phi_ref_rad", "x_ref_m"), ())
    t_s, swept = 0.1 * np.arange(4), np.array([0.0, 1.0, 2.0, 3.0])
    for extra in ({"phi_ref_rad": np.zeros(4), "x_ref_m": swept}, {"x_ref_m": swept}):
        closed = RunLog(columns, 0.1, "closed", t_s, np.ones((4, 1)), np.ones((4, 2)), extra)
        (found,) = with_instruments([record_of(closed, "loop", ("phi_rad", "x_m"))])
        np.testing.assert_array_equal(found.r, swept[:, None])


def one(value):
    return np.array([[value]])


@pytest.mark.parametrize("rate", [-0.5, 0.0, 0.8])
def test_a_run_finds_start_and_trim_of_a_plant_stable_or_not(rate):
    """x' = rate x + (u + 0.3), x(0) = 2, read with an offset of 0.7, over 20 s: growth by exp(16) takes more than one stretch."""
    h, rows = 0.1, 200
    u = np.sin(0.7 * h * np.arange(rows))
    keep = np.exp(rate * h)
    gain = h if rate == 0.0 else (keep - 1.0) / rate
    x = np.full(rows, 2.0)
    for k in range(rows - 1):
        x[k + 1] = keep * x[k] + gain * (u[k] + 0.3)
    found = linear_run(
        StateSpace(one(rate), one(1.0), one(1.0), one(0.0)), Record("x", h, u[:, None], x[:, None] + 0.7, u[:, None])
    )
    assert (found.stretches > 1) == (rate > 0.5)
    np.testing.assert_allclose(found.y[:, 0], x + 0.7, rtol=1e-8, atol=1e-8)


def test_a_direct_part_shows_one_row_late():
    u = np.random.default_rng(1).standard_normal((50, 1))
    y = 3.0 * np.vstack([u[:1], u[:-1]])
    found = linear_run(StateSpace(one(-1.0), one(0.0), one(0.0), one(3.0)), Record("direct", 0.1, u, y, u))
    np.testing.assert_allclose(found.y, y, atol=1e-9)
