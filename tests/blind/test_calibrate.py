"""The law of probabilities: a known one is found again, names are judged as the scorer judges them, and what cannot be used is refused."""

import json
from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from blind import calibrate, family
from blind.calibration.calibrate import DECAYS, Calibration, quality
from blind.calibration.examples import Example, Family
from blind.calibration.fit import BELIEVED, UNLEARNED, fit, log_loss, partly
from blind.calibration.withheld import withheld
from blind.cases.make import salt_of
from blind.cases.sealed import seal
from blind.scoring.statistics import honest_error
from records.errors import BadInput
from records.model_comparison import Candidate, ComparisonLaw, ModelComparison
from tests.blind.test_score import effect, truth
from tests.soak import SOAK
from twinlaw.command import main

ANSWERS = 900 if SOAK else 450
TRUE = ComparisonLaw(1.5, 0.3, 2.0, 0.6, 2.5, -0.5, 2.0, 1.5, 0.5, 0.5)


def example(rng: np.random.Generator) -> Example:
    """An answer that is right as often as TRUE says: one candidate or none is."""
    gain = float(np.exp(rng.uniform(3.0, 9.0)))
    scale = TRUE.scale_nats(gain)
    candidates = tuple(
        Candidate(name, gain - scale * rng.exponential(2.0), 0.0, rng.normal(0.0, 2.0))
        for name in ("a.one", "a.two", "a.one + a.two")
    )
    left, curve = float(np.exp(rng.uniform(1.0, 7.0))), gain + scale * rng.normal(0.0, 4.0)
    told = ModelComparison(
        candidates, gain, gain, left, rng.uniform(-1.0, 1.0), curve_nats=float(curve), curve_ahead_nats=99.0
    )
    p = TRUE.explained(told) * TRUE.shares(told)[:-1]
    drawn = int(np.searchsorted(np.cumsum(p), rng.random()))
    return Example(told, tuple(drawn == place for place in range(3)), (False,) * 3)


def families(count: int) -> list[Family]:
    rng = np.random.default_rng(5)
    return [Family(name, (), count, tuple(example(rng) for _ in range(count))) for name in ("first", "second", "third")]


@cache
def learned() -> Calibration:
    """What ANSWERS teach."""
    return calibrate(families(ANSWERS // 3))


def test_a_known_law_is_found_again() -> None:
    """Each number within what so few tell of it, four standard errors from the spread of laws of thirds of them."""
    found = learned()
    thirds = [fit(one.examples, found.decay) for one in found.families]
    for name, true in vars(TRUE).items():
        if not name.startswith("partly"):
            spread = np.std([getattr(law, name) for law in thirds], ddof=1) / np.sqrt(3.0)
            assert getattr(found.law, name) == pytest.approx(true, abs=4.0 * spread + 0.1), name
    assert found.decay in DECAYS


def test_probabilities_of_the_true_law_are_as_honest_out_of_family_as_chance_allows() -> None:
    found = learned()
    assert found.outside.calibration_error < found.outside.honest_95
    assert found.outside.log_loss is not None
    told = [entry for one in found.families for entry in one.examples]
    assert found.outside.log_loss == pytest.approx(log_loss(TRUE, told), abs=0.04)
    assert found.inside.log_loss is not None
    assert found.inside.log_loss <= found.outside.log_loss


def test_few_answers_have_a_finite_law_and_what_none_tells_of_stays_as_believed_before() -> None:
    told = ModelComparison((Candidate("a.one", 100.0, 0.0),), 100.0, 100.0, 5.0, 0.5)
    found = fit([Example(told, (True,), (True,))] * 3, DECAYS[0])
    assert [getattr(found, name) for name in BELIEVED] == pytest.approx(
        [mean for mean, _ in BELIEVED.values()], abs=1e-3
    )
    assert np.isfinite([found.intercept, found.left, found.curve, found.favour]).all()
    assert found.explained(told) > 0.9


def test_a_wrong_name_is_right_in_part_as_often_as_such_were() -> None:
    """Truth: of 8 wrong names of one effect 1 is right in part, of 3 of several all are: (1 + 1) / (8 + 2) and (3 + 1) / (3 + 2)."""

    def told(name: str, right: bool, part: bool) -> Example:
        return Example(ModelComparison((Candidate(name, 50.0, 0.0),), 50.0, 50.0, 5.0), (right,), (part,))

    single = [told("a.one", False, part) for part in (True, *[False] * 7)]
    several = [told("a.one + a.two", False, True)] * 3
    examples = [*single, *several, *[told(name, True, True) for name in ("a.one", "a.one + a.two") for _ in range(5)]]
    assert [partly(UNLEARNED, examples, way) for way in (False, True)] == pytest.approx([0.2, 0.8])


def test_honest_answers_have_an_error_that_falls_as_the_root_of_their_number_and_a_seed_tells_it() -> None:
    """One bin: the mean of n draws misses p by more than 0.674 sd / sqrt(n) every other time;
    four standard errors of the median of 1000 simulations are 15 %."""
    median, high = honest_error([0.55] * 2500, seed=3)
    assert median == pytest.approx(0.674 * np.sqrt(0.55 * 0.45 / 2500), rel=0.15)
    assert high > median
    assert honest_error([0.55] * 2500, seed=3) == (median, high)
    assert honest_error([], seed=3) == (0.0, 0.0)


def test_answers_that_are_right_as_often_as_they_say_have_no_error() -> None:
    found = quality([(0.75, place % 4 != 0) for place in range(40)], 0.5)
    assert (found.answers, found.right, found.log_loss) == (40, 30, 0.5)
    assert found.calibration_error == pytest.approx(0.0, abs=1e-12)


def compared(*names: str, stated: float | None = 0.7) -> Mapping[str, object]:
    """A diagnosis.json of a gap that says nothing but what was compared, and of the first its probability."""
    candidates = [
        {"effect": name, "evidence_nats": 90.0 - place, "prior_nats": 0.0, "ahead_nats": 0.0}
        for place, name in enumerate(names)
    ]
    told = {"candidates": candidates, "gain_nats": 90.0, "formed_nats": 90.0, "left_nats": 5.0, "favour": 0.5}
    effects = [] if stated is None else [{"effect": names[0], "probability": stated}]
    answer = {"schema": "diagnosis/1", "verdict": "gap", "places": [], "found": [], "effects": effects}
    return {**answer, "comparison": {**told, "parameters_nats": None}}


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
    (truth("double", TILT, DELAY), compared("main_input.delay + azimuth.tilt", "azimuth.tilt")),
    (truth("double", TILT, DELAY), compared("azimuth.tilt")),
    (truth("single", TILT), compared("azimuth.tilt + main_input.delay", "azimuth.tilt")),
    (truth("single", replace(TILT, twins=("azimuth.cable_spring",))), compared("azimuth.cable_spring")),
    (truth("outside", effect("azimuth.breeze", known=False)), compared("azimuth.wind_drag", stated=None)),
    (truth("nominal"), compared("azimuth.tilt")),
    (truth("nominal"), {"decisions": []}),
    (truth("single", TILT), None),
]


def test_a_name_is_right_as_the_scorer_says_and_answers_without_candidates_teach_nothing(tmp_path: Path) -> None:
    found = family("first", [write(tmp_path, MIXED, 24)])
    assert [entry.right for entry in found.examples] == [
        (True, False),
        (False,),
        (False, True),
        (True,),
        (True,),
        (False,),
    ]
    assert [entry.touching[0] for entry in found.examples] == [True, True, True, True, True, False]
    assert [entry.stated for entry in found.examples[2:5]] == [(0.7, False), (0.7, True), None]
    assert (found.cases, found.seeds) == (8, (24,))


def test_what_a_filter_of_the_angles_makes_late_is_right_with_and_without_a_name(tmp_path: Path) -> None:
    filtered = {"defects": ("angles filtered 1.10 ms",)}
    told = [
        (replace(truth("single", TILT), **filtered), compared("azimuth.tilt + phi_sensor.delay", "phi_sensor.delay")),
        (replace(truth("nominal"), **filtered), compared("phi_sensor.lag", "azimuth.tilt + phi_sensor.lag")),
        (truth("nominal"), compared("phi_sensor.lag")),
    ]
    found = family("first", [write(tmp_path, told, 24)])
    assert [entry.right for entry in found.examples] == [(True, False), (True, False), (False,)]
    assert [entry.stated for entry in found.examples] == [(0.7, True), (0.7, True), (0.7, False)]


def test_a_smaller_library_explains_less_and_what_it_names_is_wrong() -> None:
    names = [Candidate("azimuth.tilt", 900.0, 0.0), Candidate("azimuth.wind_drag", 600.0, 0.0)]
    answer = Example(ModelComparison(tuple(names), 900.0, 900.0, 20.0, 0.9, 50.0), (True, False), (True, False))
    others, bare = withheld(answer)
    assert others.told == ModelComparison((names[1],), 600.0, 600.0, 320.0, None, 50.0)
    assert bare.told == ModelComparison((), 50.0, 0.0, 870.0, None, 50.0)
    assert (others.right, bare.right) == ((False,), ())
    assert withheld(replace(answer, touching=(False, False))) == ()


def test_where_no_name_explains_and_forms_and_a_free_curve_do_much_the_law_says_unknown() -> None:
    told = [replace(one, examples=tuple(replace(e, touching=e.right) for e in one.examples)) for one in families(60)]
    found = calibrate(told)
    nameless = ModelComparison(
        (), 0.0, 0.0, left_nats=4000.0, parameters_nats=0.0, curve_nats=4000.0, curve_ahead_nats=9.0
    )
    named = ModelComparison((Candidate("azimuth.tilt", 4000.0, 0.0),), 4000.0, 4000.0, 5.0, 0.8, 0.0)
    assert found.law.explained(nameless) < 0.2 < 0.7 < found.law.explained(named)


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
    assert set(content["law"]) == set(vars(TRUE))
    assert {"commit", "calibration_error", "in_family", "out_of_family"} < set(content)
    assert content["commit"] == "abc"
    assert (content["families"]["b"]["seeds"], content["families"]["b"]["cases"]) == ([4, 5], 16)
    assert content["families"]["b"]["answers"] == 12
    assert main([*words, str(tmp_path / "one.json"), *told[0], *told[1], "--json"]) == 0
    said = json.loads(capsys.readouterr().out)
    assert said["families"]["b"]["seeds"] == [4]
    assert said == json.loads((tmp_path / "one.json").read_text())  # as docs/json.md says


def test_one_family_or_one_without_candidates_is_refused_and_nothing_is_written(
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
        family("c", [(tmp_path, tmp_path)])
