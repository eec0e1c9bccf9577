"""What an answer tells: shrinkage, notes and their sentences, a re-tune beyond the spread, the run that would reveal more, the exit."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis import decisions
from diagnosis.answer import no_gap
from diagnosis.baselines.bic import by_bic
from diagnosis.baselines.residual_size import by_residual_size
from diagnosis.confirmation import of_consequence
from diagnosis.decide.weighing import Weighed
from diagnosis.detect.detection import detect
from diagnosis.detect.starts import ScoreTest
from diagnosis.diagnose import _gap
from diagnosis.experiment.revealing import revealing_experiment
from diagnosis.explain.improved import improved_plant
from diagnosis.explain.notes import notes_of
from diagnosis.explain.sentences import plain_sentence, sentence, sentences, unseen_effects
from diagnosis.fit.evidence import FittedHypothesis, log_evidence
from diagnosis.hypothesis.case import make_case
from diagnosis.library.effect_library import effect_library
from diagnosis.result import Exit, Judged, Material, Seen
from diagnosis.search.retune import places_of, retune
from diagnosis.validate.prediction import predictions
from diagnosis.validate.shrinkage import Predicted, predict_all, shrinkage
from records.reasons import Note
from tests.diagnosis.arm import arm, arm_case, arm_log, plain_linearisation
from tests.diagnosis.nominal import nominal_fit


def predicted(before: float, after: float) -> tuple[Predicted, ...]:
    """Ten windows in which each model is off by so much of the floor, up and down in turn."""
    case = plain_linearisation().case
    floor = float(np.sqrt(case.flights[0].filter_input.single[0]))
    t_s = 0.01 * np.arange(1000)
    sign = np.where(np.arange(1000) % 2, 1.0, -1.0)[:, None]
    by = {name: floor * size * sign for name, size in (("nominal", 9.0), ("before", before), ("after", after))}
    return (Predicted("hold", 1.0, t_s, np.zeros((1000, 1)), by, {}),)


def test_the_share_that_is_gone_is_of_what_lies_above_the_floor() -> None:
    # Truth by CONTRACT.md's formula, errors in floors: (b^2 - a^2) / (b^2 - 1).
    found = shrinkage(plain_linearisation().case, predicted(5.0, 2.0))
    assert found.fraction == pytest.approx((25.0 - 4.0) / (25.0 - 1.0))
    assert found.fraction_ci95 == pytest.approx((found.fraction, found.fraction))
    assert shrinkage(plain_linearisation().case, predicted(0.5, 0.5)).fraction is None  # nothing is removable


def test_a_model_predicts_its_own_log_within_a_few_floors() -> None:
    case, own = plain_linearisation().case, plain_linearisation().fit.hypothesis
    variants = dict.fromkeys(("nominal", "before", "after"), own)
    found = shrinkage(case, predict_all(case, ["own"], variants, lambda h: [predictions(case, case.flights[0], h)]))
    assert found.rms_after["theta_rad"] < 9.0 * found.rms_floor["theta_rad"]


def test_notes_are_records_and_each_kind_has_its_sentence() -> None:
    case, fitted = plain_linearisation().case, plain_fit()
    quiet = [ScoreTest(name, {}, 0.0, 0.0, 0.9995, 1.0) for name in case.library.candidates]
    found = notes_of(case, quiet, fitted, None)
    assert {"imitated", "hidden"} <= {note.kind for note in found}
    assert all(sentences(found))
    moved = Note("moved_parameter", "K", {"deviations": -4.21, "value": 0.0123456, "stated": 0.01})
    assert sentence(moved) == "parameter K is -4.2 standard deviations from its stated value: 0.01235 instead of 0.01"
    assert sentence(Note("any", "log", {}, "as it was said")) == "as it was said"
    size = {"symbol": "b_s", "value": 0.000829, "unit": "N m"}
    hidden = Note("unseen", "azimuth", {"lower_stop": None, "inertia_shape": size})
    assert unseen_effects(hidden, lambda kind: kind.replace("_", " ")) == (
        "lower stop of any size; inertia shape below b_s = 0.000829 N m"
    )
    told = Note("contradiction", "b", {"gain_nats": 251.0, "moved": {"K": 4.0}})
    assert "251 nats likelier" in sentence(told)
    assert "e^251 times likelier" in plain_sentence(told)
    with pytest.raises(KeyError):
        sentence(Note("of no kind", "log"))


def plain_fit() -> FittedHypothesis:
    return FittedHypothesis((), plain_linearisation().fit, log_evidence(plain_linearisation().fit, {}))


def test_a_parameter_far_beyond_its_spread_is_found_alone_with_its_place() -> None:
    # Truth: the rig's thrust is 1.6 times what the file states, which the file takes to know to 1 % of that, 37.5 deviations;
    # all else is as stated.
    known = replace(arm(), sd=np.where(arm().sd > 0.0, 0.01 * np.abs(arm().p), 0.0))
    names = [str(symbol) for symbol in arm().model.parameter_symbols]
    p = arm().p.copy()
    p[names.index("K")] /= 1.6
    wrong = replace(known, p=p)

    case = make_case(effect_library(wrong), [arm_log()], [None], wrong)
    found = retune(case, nominal_fit(case))
    assert found is not None
    assert found.parameters == ("K",)
    (theta,) = (found.fitted.fit.hypothesis.theta[place] for place, k in enumerate(case.free) if names[int(k)] == "K")
    assert theta == pytest.approx(37.5, abs=1.0)
    assert max(found.places, key=lambda place: found.places[place]) == places_of(case, "K")[0]
    assert sum(found.places.values()) == pytest.approx(1.0)
    assert retune(plain_linearisation().case, plain_linearisation().fit) is None


def test_another_value_of_a_number_that_is_known_far_better_than_a_log_tells_is_found() -> None:
    # Truth: half as much viscous friction again, of a plant that is known to a hundred-thousandth: 50000 deviations, of which a log takes
    # next to no variance away, so that within its spread the friction does not move.
    wrong = replace(arm(), sd=1e-5 * np.where(arm().sd > 0.0, np.abs(arm().p), 0.0))
    names = [str(symbol) for symbol in arm().model.parameter_symbols]
    case = make_case(effect_library(wrong), [arm_log(c=1.5 * wrong.p[names.index("c")])], [None], wrong)
    nominal = nominal_fit(case)
    assert np.max(np.abs(nominal.hypothesis.theta)) < 3.0
    found = retune(case, nominal)
    assert found is not None
    assert found.parameters == ("c",)
    p = improved_plant(case, found.fitted).parameters["c"]
    assert p.value == pytest.approx(1.5 * wrong.p[names.index("c")], rel=0.03)


@pytest.mark.soak  # in every suite test_cannot_tell.py asks the same of a hover, with filters that others use too
def test_the_run_that_reveals_most_shows_more_than_a_rest() -> None:
    log = arm_log()
    still = replace(log, u=np.zeros_like(log.u), y=np.zeros_like(log.y))
    told = revealing_experiment(arm_case(still), plain_linearisation().fit.hypothesis)
    assert told is not None
    shown, now = (
        int(part.split()[place]) for part, place in zip(told["expected_outcome"].split("; "), (0, 3), strict=True)
    )
    assert shown > now


def seen() -> Seen:
    linearisation = plain_linearisation()
    tests = tuple(ScoreTest(name, {}, 0.0, 0.0, 0.0, 9.0) for name in linearisation.case.library.candidates)
    return Seen(
        linearisation.case,
        None,
        plain_fit(),
        linearisation,
        tests,
        None,
        detect(linearisation.case, linearisation, tuple)[0],
    )


def test_an_answer_without_a_gap_names_its_exit_and_keeps_notes_rules_and_chance() -> None:
    kept = Note("firmware", "log", {}, "log: something")
    found = no_gap(seen(), Material([], [], [], [], notes=(kept,)), None, Exit.TOO_SMALL).diagnosis
    assert (found.verdict, found.verdict_reason) == ("no gap", "too_small")
    assert found.note_records[0] == kept
    assert found.notes[0] == "log: something"
    assert found.false_alarm_probability == seen().detection.p


def test_a_doubt_about_rows_goes_where_an_effect_is_told_that_explains_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """Truth: commands a row late, which a flexible mode explains half: told, or too small to be and not chosen."""
    late, named = Note("columns_late", "u_V", {}, "perhaps late"), replace(plain_fit(), effects=("arm.flexible_mode",))
    monkeypatch.setattr("diagnosis.diagnose.rows_in_doubt", lambda case, found, notes: ())
    monkeypatch.setattr("diagnosis.diagnose.gap", lambda seen, material, judged: judged.notes)
    for chosen, kept in ((named, ()), (plain_fit(), (late,))):
        judged = Judged(object(), None, None, object(), chosen, None, (late,))  # type: ignore[arg-type]
        assert _gap(seen(), Material([], [], [], []), judged) == kept


def test_a_small_gap_that_nothing_explains_does_not_stand_and_keeps_its_chance() -> None:
    small = seen()
    small = replace(small, detection=replace(small.detection, p=4e-5, largest=20.0, moved=False))
    weighed = Weighed((), (), 0.66, 0.34, 10.0, ahead_nats=3.0)
    result = Judged(object(), None, None, weighed, small.retuned, None, ())  # type: ignore[arg-type]
    after, left_by = of_consequence(small, result)
    assert (
        left_by is Exit.TOO_UNSURE
    )  # 3 nats are more than what matters, 0.04 a second, and less than the 6.9 that chance makes seldom
    assert after.detection.p == 4e-5
    assert after.decisions[-1].rule == "matters"
    assert after.decisions[-1].value == 3.0
    assert after.decisions[-1].limit == pytest.approx(-np.log(decisions.ALARM))


ROUGH = {"arm.coulomb": {"b": 5e-4}}


def test_residuals_alone_see_that_friction_is_missing() -> None:
    assert by_residual_size(arm(), [arm_log(ROUGH)]).verdict == "gap"


@pytest.mark.soak
def test_the_information_criterion_sees_it_too_and_its_probabilities_sum_to_one_at_most() -> None:
    found = by_bic(arm(), [arm_log(ROUGH)])
    assert found.verdict == "gap"
    assert sum(entry.probability for entry in found.effects) <= 1.0 + 1e-9
