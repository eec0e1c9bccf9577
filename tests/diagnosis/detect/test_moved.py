"""Whether a plant follows its logs as its file states it, or only with other parameters."""

import pytest

from diagnosis.detect.detection import Detection, detect
from diagnosis.detect.linearisation import linearised
from records.log import RunLog
from tests.diagnosis.arm import arm, arm_case, arm_log
from tests.diagnosis.nominal import nominal_fit


def detected(log: RunLog) -> Detection:
    case = arm_case(log)
    return detect(case, linearised(case, nominal_fit(case)), tuple)[0]


@pytest.mark.parametrize(("sds", "moved"), [(1.0, False), (8.0, True)])
def test_parameters_that_are_not_those_of_the_file_are_told(sds: float, moved: bool) -> None:
    # Truth: a thrust that is one standard deviation of its file's spread off, or eight.
    index = [str(symbol) for symbol in arm().model.parameter_symbols].index("K")
    assert detected(arm_log(seed=5, K=float(arm().p[index] + sds * arm().sd[index]))).moved is moved
