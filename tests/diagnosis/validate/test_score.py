"""How much better one model predicts than another: by known errors, by horizons, by the grid of coarse readings."""

import numpy as np
import pytest

from diagnosis.hypothesis.hypothesis import Hypothesis
from diagnosis.validate.prediction import predictions
from diagnosis.validate.score import HORIZONS_S, Errors, errors_of, score
from tests.diagnosis.arm import arm_case, arm_log, plain_linearisation

WINDOWS, OUTPUTS = 40, 2


def errors(*rms: float, grid: float = 0.0, windows: int = WINDOWS) -> Errors:
    """Errors of each output as given at all horizons, spread a little over the windows, where 1 could be attained."""
    spread = np.random.default_rng(1).uniform(0.8, 1.2, (windows, len(HORIZONS_S), len(rms)))
    grids = np.zeros(len(rms))
    grids[0] = grid
    return Errors(np.square(rms) * spread, grids, spread)


def test_the_gain_is_the_log_of_the_ratio_of_errors_summed_over_outputs() -> None:
    found = score(errors(2.0, 3.0), errors(4.0, 3.0))
    assert found.gain == pytest.approx(np.log(2.0))
    assert found.misfit == pytest.approx(np.log(2.0) + np.log(3.0))
    assert found.sd == pytest.approx(0.0, abs=1e-12)  # both err in the same windows


def test_its_standard_error_falls_with_the_windows() -> None:
    rng = np.random.default_rng(2)

    def sd(windows: int) -> float:
        other = errors(1.0, windows=windows)
        own = Errors(other.squares * rng.lognormal(0.0, 1.0, other.squares.shape), other.grid, other.attainable)
        return score(own, other).sd

    assert sd(400) == pytest.approx(0.5 * sd(100), rel=0.4)


def test_readings_that_lie_on_a_coarser_grid_are_likelier_by_its_log() -> None:
    assert score(errors(1.0, grid=np.log(3.0)), errors(1.0)).gain == pytest.approx(np.log(3.0))


def test_windows_that_a_model_cannot_predict_do_not_count() -> None:
    other, own = errors(2.0), errors(1.0)
    own.squares[: WINDOWS // 2] = np.nan
    other.squares[: WINDOWS // 2] *= 100.0
    assert score(own, other).gain == pytest.approx(np.log(2.0))
    own.squares[:] = np.nan
    assert not np.isfinite(score(own, other).sd)


def test_a_right_model_leaves_next_to_nothing_and_a_wrong_one_predicts_worse() -> None:
    # Truth: the arm as stated flew; the other model has it twice its stated deviations off in every coefficient.
    case, right = arm_case(arm_log(seed=5)), plain_linearisation().fit.hypothesis
    wrong = Hypothesis(right.theta + 2.0, right.effects, right.process_noise)

    def read(hypothesis: Hypothesis) -> list[np.ndarray]:
        return [predictions(case, flight, hypothesis) for flight in case.flights]

    found = score(errors_of(case, right, read), errors_of(case, wrong, read))
    assert found.gain > 5.0 * found.sd > 0.0
    assert found.misfit < 0.3
