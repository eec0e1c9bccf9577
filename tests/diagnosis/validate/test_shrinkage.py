"""How far a gap shrinks, of predictions whose errors are known."""

import numpy as np
import pytest

from diagnosis.validate.closed_loop import MODEL_VARIANTS
from diagnosis.validate.shrinkage import Predicted, shrinkage
from tests.diagnosis.arm import arm_case, arm_log

CASE = arm_case(arm_log(seconds=10.0))
FLIGHT = CASE.flights[0]
NOISE = float(np.sqrt(FLIGHT.filter_input.single[0]))


def found(nominal: float, before: float, after: float) -> Predicted:
    """Readings missed by so many standard deviations of their noise, row by row to both sides."""
    side = NOISE * np.where(np.arange(len(FLIGHT.log.t_s)) % 2, 1.0, -1.0)[:, None]
    errors = dict(zip(MODEL_VARIANTS, (nominal, before, after), strict=True))
    return Predicted(
        "log", 1.0, FLIGHT.log.t_s, FLIGHT.log.y, {k: FLIGHT.log.y + e * side for k, e in errors.items()}, {}
    )


@pytest.mark.parametrize(
    ("before", "after", "gone"),
    [
        (3.0, 1.0, 1.0),  # (9 - 1) / (9 - 1)
        (3.0, 2.0, 5.0 / 8.0),
        (2.0, 3.0, -5.0 / 3.0),
        (1.05, 0.5, 1.0),  # below what looked like noise nothing is left to remove
    ],
)
def test_the_share_that_is_gone_is_never_more_than_all(before: float, after: float, gone: float) -> None:
    told = shrinkage(CASE, [found(5.0, before, after)])
    assert told.fraction == pytest.approx(gone)
    assert told.rms_floor["theta_rad"] == pytest.approx(NOISE * min(after, 1.0))


def test_its_interval_ends_at_all_that_can_be_gone() -> None:
    # Truth: in half of the windows the plant errs as its sensor does, so that some draws have next to nothing to remove, and more is gone.
    told = found(5.0, 1.02, 1.0)
    rows = np.arange(len(FLIGHT.log.t_s)) % 200 < 100
    for variant, error in (("before", 1.6), ("after", 0.9)):
        told.by[variant][rows] = FLIGHT.log.y[rows] + error * (told.by[variant] - FLIGHT.log.y)[rows]
    interval = shrinkage(CASE, [told]).fraction_ci95
    assert interval is not None
    assert interval[0] < interval[1] <= 1.0
