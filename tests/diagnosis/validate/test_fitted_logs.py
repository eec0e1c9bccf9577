"""What predicts the logs that were fitted: right numbers better than wrong ones, and no noise better than another."""

from dataclasses import replace

import pytest

from diagnosis.validate.fitted_logs import FittedLogs
from tests.diagnosis.arm import arm_case, arm_log, plain_linearisation


def test_right_numbers_predict_better_and_noise_is_not_asked() -> None:
    # Truth: the arm as stated flew. The other model has every coefficient twice its stated deviations off; a third the right ones under a
    # noise a hundred thousand times too small, whose filter by itself would follow nothing.
    logs, right = FittedLogs(arm_case(arm_log(seed=5))), plain_linearisation().fit.hypothesis
    wrong = replace(right, theta=right.theta + 2.0)
    deaf = replace(right, process_noise=right.process_noise - 5.0)
    assert logs.gain(right, wrong) > 0.2
    assert logs.gain(right, wrong) == pytest.approx(-logs.gain(wrong, right))
    assert logs.gain(deaf, right) == pytest.approx(0.0, abs=1e-9)
    assert logs.errors(right) is logs.errors(right)
