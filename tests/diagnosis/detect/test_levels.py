"""Levels of a limit that are tried: where the command is most of the time, whatever its peaks."""

import numpy as np
import pytest

from diagnosis.detect.linearisation import linearised
from diagnosis.detect.score_tests import score_effects
from diagnosis.fit.nominal import nominal_fit
from tests.diagnosis.arm import arm_case, arm_log

LIMIT = {"input.saturation": {"limit": 1.9, "w": 0.05}}


def test_a_limit_is_seen_far_below_the_peaks_of_kicks() -> None:
    # Truth: 1.9 V at most of commands about 1.8 V, among which one in a hundred is a kick of nearly twice as much.
    case = arm_case(arm_log(LIMIT, seed=53, kick_V=1.8))
    sent = case.flights[0].filter_input.u[:, 0]
    assert np.max(sent) > 3.4
    (seen,) = score_effects(case, linearised(case, nominal_fit(case)), ["input.saturation"])
    assert seen.gain > 30.0
    assert seen.values["limit"] == pytest.approx(1.9, rel=0.15)
