"""How large the error of the integration is, told apart from what the law's own arithmetic loses."""

from pathlib import Path

from tests.own_plants import SUSPENSION
from twinlaw import design, load
from twinlaw.workflows.chain.flying import halved_step

DESIGN = """
[design]
sample_period_s = 0.002

[design.body]
poles_rad_s = [-4, -5, [-6, 6], [-6, -6], -12, -14, [-15, 70], [-15, -70]]
prefilter_time_constant_s = 0.3
reference_min_m = -0.04
reference_max_m = 0.04
"""


def test_the_error_of_the_steps_is_not_what_float32_loses(tmp_path: Path) -> None:
    """Truth: the wheel's 74 rad/s turn by 0.15 rad in a step of 2 ms, of which RK4 misses some 0.15^5 / 120 = 6e-7 at most; of 40 mm
    that is 2.5e-8 m. A law of slow poles at this period loses increments in float32, and hunts by 0.7 mm whatever the step.
    """
    plant = SUSPENSION.write(tmp_path, "suspension")
    plant.write_text(plant.read_text() + DESIGN)
    suspension = load(plant)
    error = halved_step(suspension, design(suspension).table)
    assert 0.0 < error.estimate.max() < 2.5e-8
