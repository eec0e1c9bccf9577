"""The plain ways answer sealed cases in the contract's form, so that they can be scored beside the diagnosis."""

from pathlib import Path

import numpy as np
import pytest

import blind
from diagnosis.baselines import BASELINES
from diagnosis.baselines.sparse_regression import _thresholded
from diagnosis.baselines.windows import derivatives
from records.diagnosis import load_diagnosis
from twinlaw.command import main


@pytest.fixture(scope="module")
def cases(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("cases")
    blind.make(11, folder, 1, ("single",))
    return folder


@pytest.mark.parametrize("name", BASELINES)
def test_a_baseline_answers_so_that_it_can_be_scored(name: str, cases: Path, tmp_path: Path) -> None:
    assert main(["blind", "baseline", name, str(cases), str(tmp_path)]) == 0
    answer = load_diagnosis(tmp_path / "case-0001" / "diagnosis.json")
    assert answer.verdict in ("gap", "no gap")
    assert "| invalid |" not in blind.markdown(blind.score(cases, tmp_path))


def test_a_folder_without_cases_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["blind", "baseline", "bic", str(tmp_path), str(tmp_path / "out")]) == 2
    assert "blind make" in capsys.readouterr().err


def test_smoothing_keeps_a_parabola_and_its_derivatives() -> None:
    """Truth: y = 1 + 2 t + 3 t^2, slope 2 + 6 t, bend 6, to 1e-9."""
    t_s = 0.01 * np.arange(100)
    y = 1.0 + 2.0 * t_s + 3.0 * t_s**2
    smooth, slope, bend = derivatives(y, 0.01)
    assert smooth == pytest.approx(y, abs=1e-9)
    assert slope == pytest.approx(2.0 + 6.0 * t_s, abs=1e-9)
    assert bend == pytest.approx(np.full(100, 6.0), abs=1e-7)


def test_thresholding_keeps_the_terms_that_are_there() -> None:
    source = np.random.default_rng(1)
    X = source.standard_normal((500, 6))
    size = _thresholded(X, 2.0 * X[:, 1] - X[:, 4] + 0.01 * source.standard_normal(500))
    assert np.flatnonzero(size).tolist() == [1, 4]
    assert size[[1, 4]] == pytest.approx([2.0, -1.0], abs=0.01)
