"""The law of probabilities: a known one is found again, names are judged as the scorer judges them, and what cannot be used is refused."""

import json
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.special import expit

from blind import calibrate, family
from blind.calibration.calibrate import DECAYS, partly, quality
from blind.calibration.examples import Example, Family
from blind.calibration.logistic import fit
from blind.cases.make import salt_of
from blind.cases.sealed import seal
from blind.scoring.statistics import honest_error
from diagnosis.decide.calibration import FEATURES
from records.errors import BadInput
from tests.blind.test_score import effect, truth
from twinlaw.command import main

INTERCEPT, TRUE = -0.5, np.array([0.8, 1.5, -0.7, 0.0])


def examples(rng: np.random.Generator, count: int) -> tuple[Example, ...]:
    """Answers that are right as often as INTERCEPT and TRUE say."""
    sure, favour = rng.normal(1.0, 2.0, count), rng.uniform(-1.0, 1.0, count)
    silent = (rng.random(count) < 0.3).astype(float)
    told = np.column_stack([sure, np.where(silent == 1.0, 0.0, favour), silent, np.zeros(count)])
    shares = rng.choice([1.0, 0.6], count)
    right = rng.random(count) < shares * expit(INTERCEPT + told @ TRUE)
    found = zip(told, shares.tolist(), right, strict=True)
    return tuple(Example(tuple(row), share, bool(is_right), None) for row, share, is_right in found)


def families(count: int) -> list[Family]:
    rng = np.random.default_rng(5)
    return [Family(name, (), count, examples(rng, count)) for name in ("first", "second", "third")]


def test_a_known_law_is_found_again_within_four_standard_errors() -> None:
    """6000 answers; standard errors from what answers tell of p = share q at the truth, p'^2 / p (1 - p); what does not vary has no
    coefficient."""
    found = calibrate(families(2000))
    told = np.array([[1.0, *entry.features[:3]] for one in found.families for entry in one.examples])
    shares = np.array([entry.share for one in found.families for entry in one.examples])
    q = expit(told @ [INTERCEPT, *TRUE[:3]])
    errors = np.sqrt(np.diag(np.linalg.inv((told.T * (shares * q * (1.0 - q) ** 2 / (1.0 - shares * q))) @ told)))
    misses = np.abs(np.array([found.law.intercept, *found.law.coefficients[:3]]) - [INTERCEPT, *TRUE[:3]])
    assert np.all(misses < 4.0 * errors)
    assert np.all(errors < 0.12)  # so that four of them say something
    assert found.law.coefficients[3] == 0.0
    assert found.decay in DECAYS


def test_probabilities_of_the_true_law_are_as_honest_out_of_family_as_chance_allows() -> None:
    found = calibrate(families(400))
    assert found.outside.calibration_error < found.outside.honest_95
    assert found.outside.honest < found.outside.honest_95
    told = [entry for one in found.families for entry in one.examples]
    shares = np.array([entry.share for entry in told])
    honest = quality(shares * expit(INTERCEPT + np.array([entry.features for entry in told]) @ TRUE), told)
    assert found.outside.log_loss == pytest.approx(honest.log_loss, abs=0.02)
    assert found.inside.log_loss <= found.outside.log_loss


def test_few_answers_have_a_finite_law_all_right_or_told_apart_without_error_and_more_decay_a_flatter_one() -> None:
    right = fit([Example((float(place), 0.0, 1.0, 0.0), 1.0, True, None) for place in range(3)], DECAYS[0])
    assert right.coefficients == pytest.approx((0.0, 0.0, 0.0, 0.0), abs=1e-9)
    assert 3.0 < right.intercept < 10.0
    apart = [Example((float(place), 0.0, 1.0, 0.0), 1.0, place > 1, None) for place in range(4)]
    loose, tight = fit(apart, DECAYS[0]), fit(apart, DECAYS[-1])
    assert 10.0 > loose.coefficients[0] > tight.coefficients[0] > 0.0


def test_a_wrong_name_is_right_in_part_as_often_as_such_were() -> None:
    """Truth: of 8 wrong names of one effect 1 is right in part, of 3 of several all are: (1 + 1) / (8 + 2) and (3 + 1) / (3 + 2)."""

    def told(several: bool, parts: list[bool]) -> list[Example]:
        return [Example((0.0,) * 4, 1.0, False, None, several, part) for part in parts]

    right = [Example((0.0,) * 4, 1.0, True, None, several, True) for several in (False, True) for _ in range(5)]
    examples = [*right, *told(False, [True, *[False] * 7]), *told(True, [True] * 3)]
    assert (partly(examples, several=False), partly(examples, several=True)) == pytest.approx((0.2, 0.8))


def test_honest_answers_have_an_error_that_falls_as_the_root_of_their_number_and_a_seed_tells_it() -> None:
    """One bin: the mean of n draws misses p by more than 0.674 sd / sqrt(n) every other time;
    four standard errors of the median of 1000 simulations are 15 %."""
    median, high = honest_error([0.55] * 2500, seed=3)
    assert median == pytest.approx(0.674 * np.sqrt(0.55 * 0.45 / 2500), rel=0.15)
    assert high > median
    assert honest_error([0.55] * 2500, seed=3) == (median, high)
    assert honest_error([], seed=3) == (0.0, 0.0)


def recorded(of: str, sure: float = 1.0, stated: float | None = 0.7) -> Mapping[str, object]:
    """A diagnosis.json that says nothing but what was told the law."""
    values = dict(zip(FEATURES, (sure, 0.5, 0.0, 0.0), strict=True))
    records = [{"rule": f"calibration_{name}", "of": of, "value": value} for name, value in values.items()]
    records.append({"rule": "calibration_share", "of": of, "value": 0.9})
    return {"decisions": [*records, {"rule": "comes_true", "of": of, "value": stated}]}


def write(folder: Path, answers: list[tuple[object, Mapping[str, object] | None]], seed: int) -> tuple[Path, Path]:
    """Sealed truths and their answers, as (cases, answers)."""
    cases, results = folder / f"cases-{seed}", folder / f"answers-{seed}"
    truths = {f"case-{place:04d}": entry for place, (entry, _) in enumerate(answers, 1)}
    public, opened = seal(truths, {name: salt_of(seed, name) for name in truths})  # type: ignore[arg-type]
    (cases / "sealed").mkdir(parents=True)
    (cases / "cases.json").write_text(public)
    (cases / "sealed/truth.json").write_text(opened)
    for name, (_, content) in zip(truths, answers, strict=True):
        if content is not None:
            (results / name).mkdir(parents=True)
            (results / name / "diagnosis.json").write_text(json.dumps(content))
    return cases, results


TILT, DELAY = effect("azimuth.tilt"), effect("main_input.delay")
MIXED = [
    (truth("double", TILT, DELAY), recorded("main_input.delay + azimuth.tilt")),
    (truth("double", TILT, DELAY), recorded("azimuth.tilt")),
    (truth("single", TILT), recorded("azimuth.tilt + main_input.delay")),
    (truth("single", replace(TILT, twins=("azimuth.cable_spring",))), recorded("azimuth.cable_spring", sure=2.0)),
    (truth("outside", effect("azimuth.breeze", known=False)), recorded("azimuth.wind_drag", stated=None)),
    (truth("nominal"), recorded("azimuth.tilt", sure=-1.0)),
    (truth("nominal"), {"decisions": []}),
    (truth("single", TILT), None),
]


def test_a_name_is_right_as_the_scorer_says_and_answers_without_features_teach_nothing(tmp_path: Path) -> None:
    found = family("first", [write(tmp_path, MIXED, 24)], FEATURES)
    assert [entry.right for entry in found.examples] == [True, False, False, True, True, False]
    assert (found.examples[3].features, found.examples[3].share) == ((2.0, 0.5, 0.0, 0.0), 0.9)
    assert [entry.stated for entry in found.examples[3:5]] == [0.7, None]
    assert (found.cases, found.seeds) == (8, (24,))


def test_the_verb_writes_the_same_file_every_time_in_the_form_that_the_diagnosis_reads(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["blind", "calibrate", "--commit", "abc", "--out"]
    told = [
        ["--family", name, *map(str, write(tmp_path, MIXED, seed))] for name, seed in (("a", 3), ("b", 4), ("b", 5))
    ]
    for name in ("one.json", "two.json"):
        assert main([*words, str(tmp_path / name), *told[0], *told[1], *told[2]]) == 0
    text = capsys.readouterr().out
    assert "b, by the others' law" in text
    assert (tmp_path / "one.json").read_bytes() == (tmp_path / "two.json").read_bytes()
    content = json.loads((tmp_path / "one.json").read_text())
    assert set(content["coefficients"]) == set(FEATURES)
    assert {"intercept", "commit", "calibration_error", "in_family", "out_of_family"} < set(content)
    assert content["commit"] == "abc"
    assert (content["families"]["b"]["seeds"], content["families"]["b"]["cases"]) == ([4, 5], 16)
    assert content["families"]["b"]["answers"] == 12
    assert main([*words, str(tmp_path / "one.json"), *told[0], *told[1], "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["families"]["b"]["seeds"] == [4]


def test_one_family_or_one_without_features_is_refused_and_nothing_is_written(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    good = ["--family", "a", *map(str, write(tmp_path, MIXED, 3))]
    bare = ["--family", "b", *map(str, write(tmp_path, MIXED[6:], 4))]
    out = tmp_path / "law.json"
    assert main(["blind", "calibrate", *good, "--out", str(out)]) == 2
    assert "expected at least two, to leave one out" in capsys.readouterr().err
    assert main(["blind", "calibrate", *good, *bare, "--out", str(out)]) == 2
    assert "family b: got none in the answers to 2 cases" in capsys.readouterr().err
    assert not out.exists()
    with pytest.raises(BadInput, match="a folder of `blind make`"):
        family("c", [(tmp_path, tmp_path)], FEATURES)
