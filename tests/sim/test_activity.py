"""What counts as travel and as a reversal of an input."""

import numpy as np
import pytest

from sim.activity import Activity, activity


def test_a_saw_of_known_teeth_has_their_travel_and_turns() -> None:
    # Truth: ten teeth of 0.5 V up and down in 10 s travel 10 V and turn 19 times, however long each value is held.
    teeth = np.tile([0.0, 0.5], 10)
    u_V = np.repeat([*teeth, 0.0], [5] * 20 + [1])
    found = activity(np.arange(u_V.size) * 0.1, u_V)
    assert found.travel_V_s == pytest.approx(1.0)
    assert found.reversals_1_s == pytest.approx(1.9)


def test_a_ramp_and_a_held_value_never_turn() -> None:
    t_s = np.arange(101) * 0.01
    assert activity(t_s, 2.0 * t_s).reversals_1_s == 0.0
    assert activity(t_s, np.ones(101)) == Activity(0.0, 0.0)
    assert activity(t_s[:1], np.ones(1)) == Activity(0.0, 0.0)
