"""The plain ways answer sealed cases in the contract's form, so that they can be scored beside the diagnosis."""

from pathlib import Path

import numpy as np
import pytest

import blind
from diagnosis.baselines import BASELINES
from diagnosis.baselines.bic import _answer, _bic
from diagnosis.baselines.sparse_regression import _thresholded
from diagnosis.baselines.windows import derivatives
from records.diagnosis import Estimate, load_diagnosis
from sim.added_effects import library
from tests.plants import bound
from tests.soak import sampled
from tests.twinlaw.verbs.crews import works_here
from twinlaw.command import main


@pytest.fixture(scope="module")
def cases(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("cases")
    blind.make(blind.Benchmark(11, 1, ("single",)), folder)
    return folder


@pytest.mark.parametrize("name", sampled(BASELINES, keep=["sparse-regression"]))
def test_a_baseline_answers_so_that_it_can_be_scored(
    name: str, cases: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    works_here(monkeypatch)
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


def test_the_criterion_charges_every_number_and_its_probabilities_sum_to_one() -> None:
    """Truth: the thousandth number costs ln 1000; of models 2 apart one is e times as probable as the other."""
    left = np.full(1000, 0.5)
    assert _bic(left, 3) - _bic(left, 2) == pytest.approx(np.log(1000.0))
    effects = [library(bound("aeroshield"))[name] for name in ("arm.coulomb", "arm.cable_spring")]
    size = Estimate(1.0, 0.1, "rad")
    found = _answer(10.0, [(2.0, size, effects[0]), (4.0, size, effects[1])])
    assert (found.verdict, found.found) == ("gap", ("arm.coulomb",))
    first, second = (entry.probability for entry in found.effects)
    assert first / second == pytest.approx(np.e)
    assert first + second + (found.false_alarm_probability or 0.0) == pytest.approx(1.0)
    assert _answer(1.0, [(2.0, size, effects[0])]).verdict == "no gap"


def test_thresholding_keeps_the_terms_that_are_there() -> None:
    source = np.random.default_rng(1)
    X = source.standard_normal((500, 6))
    size = _thresholded(X, 2.0 * X[:, 1] - X[:, 4] + 0.01 * source.standard_normal(500))
    assert np.flatnonzero(size).tolist() == [1, 4]
    assert size[[1, 4]] == pytest.approx([2.0, -1.0], abs=0.01)
