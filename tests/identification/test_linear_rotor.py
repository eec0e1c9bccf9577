"""The manual's linear rotor gets its best chance: beside the polynomial one it is fitted as well as a line can be."""

import pytest

from identification.experiments.table import KINDS
from identification.proof.linear_rotor import linear_rotor, readings_by


@pytest.mark.parametrize("kind", ["main_rotor", "tail_rotor"])
def test_its_thrust_is_that_of_least_squares_though_it_starts_far_off(bound, experiments, kind):
    """F = k omega: no other k leaves less, to a part in a thousand; the start is the polynomial's slope at rest."""
    run = KINDS[kind].run(experiments[kind], bound)
    found = linear_rotor(run)
    thrust = run.channel == 1
    y, fitted = run.y[thrust], readings_by(found)[thrust]
    assert fitted @ y / (fitted @ fitted) == pytest.approx(1.0, abs=1e-3)
