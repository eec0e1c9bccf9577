"""Exact derivatives along a run against central differences of plain runs, through friction, stops and kinks."""

import numpy as np
import pytest

from records.errors import BadInput
from sim.manoeuvres import flight
from sim.runs.sensitivities import column_places
from sim.simulate import Conditions, simulate
from tests.sim.slopes import slopes

RELATIVE = 1e-4  # what central differences with the steps below leave of it


def differences(bound, t, u, x0, name, step):
    """dy/d(column) by two runs."""
    ends = []
    place, parameters, inputs = column_places(bound.model)[name], bound.p.size, u.shape[1]
    for sign in (1.0, -1.0):
        p, v, x = bound.p.copy(), u.copy(), np.array(x0)
        if place < parameters:
            p[place] += sign * step
        elif place < parameters + inputs:
            v[:, place - parameters] *= 1 + sign * step
        elif place < parameters + 2 * inputs:
            v[:, place - parameters - inputs] += sign * step
        else:
            x[place - parameters - 2 * inputs] += sign * step
        ends.append(
            simulate(bound, t, x, v, Conditions(p=p, resolution=np.zeros(len(bound.model.outputs)), keep="y")).y
        )
    return (ends[0] - ends[1]) / (2 * step)


def check(bound, t, u, x0, names):
    found = slopes(bound, t, u, x0, names)
    for column, name in enumerate(names):
        place = column_places(bound.model)[name]
        scale = abs(bound.p[place]) if place < bound.p.size and bound.p[place] != 0.0 else 1.0
        expected = differences(bound, t, u, x0, name, 1e-5 * scale)
        np.testing.assert_allclose(
            found.dy[:, :, column], expected, atol=RELATIVE * np.abs(expected).max() + 1e-12, err_msg=name
        )
    return found


def test_every_coefficient_input_and_start_of_the_ce150(bound, table):
    """A second of the flight with the azimuth turning through rest and the tail rotor through its kink."""
    manoeuvre = flight(bound)
    flown = simulate(bound, manoeuvre.t_s, manoeuvre.x0, table, Conditions(reference=manoeuvre.reference_rad))
    piece = slice(4010, 4111)
    x0, u = flown.x[4010], flown.u[piece]
    assert np.any(flown.x[piece, 2] == 0.0)
    assert np.any(flown.x[piece, 3] < 0.0)
    skipped = {
        "p_FM_0",
        "p_FT_0",
        "x0.psi_dot_rad_s",
        "x0.phi_dot_rad_s",
    }  # an axis at rest has no slope by its velocity
    names = tuple(name for name in column_places(bound.model) if name not in skipped)
    found = check(bound, np.arange(101) * 0.01, u, x0, names)
    plain = simulate(bound, np.arange(101) * 0.01, x0, u, Conditions(resolution=[0.0, 0.0]))
    np.testing.assert_array_equal(found.x, plain.x)


def test_through_stopping_turning_and_breaking_away(mechanism):
    """An oscillation with friction that turns, sticks and is torn loose again by the input."""
    bound = mechanism(-40.0 * mechanism().model.states[0], (2.0, 0.5, 10.0))
    t = np.arange(401) * 0.01
    u = np.where(t < 2.0, 0.0, 1.3).reshape(-1, 1)
    names = ("mass", "friction", "x0.s_m", "x0.v_m_s", "gain.u_N", "offset.u_N")
    check(bound, t, u, np.array([0.1, 0.05]), names)


def test_through_a_stop_whose_place_is_a_parameter(mechanism):
    bound = mechanism(values=(2.0, 0.5, 0.4))
    t = np.arange(301) * 0.01
    u = np.where(t < 2.0, 1.5, -1.5).reshape(-1, 1)
    check(bound, t, u, np.array([0.0, 0.2]), ("mass", "friction", "limit", "x0.s_m", "gain.u_N"))


def test_an_axis_that_stands_a_rounding_before_its_stop_has_finite_slopes(mechanism):
    """Truth: pressed against its stop it stays there, wherever within a rounding of it it began; only the stop's own place shows."""
    bound = mechanism(values=(2.0, 0.5, 0.4))
    t, u = np.arange(101) * 0.01, np.full((101, 1), 1.5)
    for speed_m_s in (1.5e-317, 1e-200, 1e-20):
        found = slopes(bound, t, u, np.array([np.nextafter(0.4, 0.0), speed_m_s]), ("x0.s_m", "x0.v_m_s", "limit"))
        np.testing.assert_allclose(found.dy[2:, 0], np.tile([0.0, 0.0, 1.0], (99, 1)), atol=1e-9)


def test_more_columns_than_there_is_room_for_or_unknown_ones_are_refused(bound):
    t, u, x0 = np.arange(3) * 0.01, np.zeros((3, 2)), np.zeros(6)
    with pytest.raises(BadInput, match="column: got 'K_X'"):
        slopes(bound, t, u, x0, ("K_X",))
    with pytest.raises(BadInput, match="columns: got 129, expected at most 128"):
        slopes(bound, t, u, x0, ("K_M",) * 129)
    with pytest.raises(BadInput, match=r"x0: got shape \(1, 5\)"):
        slopes(bound, t, u, np.zeros(5), ("K_M",))
