"""What logs that were not fitted say: which plant they are judged against, what speaks for a name, and what is added."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis import decisions
from diagnosis.confirmation import may_be_missing, of_consequence
from diagnosis.decide.holdout import Holdout, added, asked, favour, holdout_of, with_held_out
from diagnosis.decide.weighing import Explanations, Weighed, weigh
from diagnosis.detect.curves import curves
from diagnosis.detect.detection import Detection
from diagnosis.detect.form_scores import FormScores
from diagnosis.detect.instants import happens
from diagnosis.detect.linearisation import Scores
from diagnosis.detect.replicas import Tail
from diagnosis.diagnose import Material, diagnose, misplaced_held_out
from diagnosis.fit.evidence import FittedHypothesis
from diagnosis.fit.gauss_newton import fit
from diagnosis.fit.linear_problem import Fit
from diagnosis.fit.nominal import plain_fit
from diagnosis.fit.process_noise import with_process_noise
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import ELSEWHERE
from diagnosis.result import Exit, Judged, Result, Seen
from diagnosis.search.free_curve import FittedCurve
from diagnosis.validate.judged_logs import JudgedLogs
from diagnosis.validate.score import HORIZONS_S, Errors, Score
from records.log import RunLog
from sim.added_effects import library
from sim.bind import BoundPlant
from tests.diagnosis.arm import arm, arm_case, arm_log, plain_linearisation
from tests.diagnosis.conftest import Fly
from tests.diagnosis.nominal import nominal_fit

TWO_SD = 1.1  # times J_A, which its file states to 5 %


def checked_on(plant: BoundPlant, fly: Fly, inertia: float) -> Result:
    """The answer where the rig that was fitted has TWO_SD of J_A and that of the hold-out `inertia`, all else as stated."""
    exactly = {str(symbol): 1.0 for symbol in plant.model.parameter_symbols}
    logs = [fly(seed, factors={**exactly, "J_A": factor}) for seed, factor in ((51, TWO_SD), (52, inertia))]
    return diagnose(plant, Material(logs[:1], logs[1:], ["hold"], [None, None]))


@pytest.mark.soak
def test_a_re_tune_that_predicts_worse_is_not_written(plant: BoundPlant, fly: Fly) -> None:
    result = checked_on(plant, fly, 1.0)
    stated = plant.plant.parameters
    assert result.diagnosis.found == ()
    assert result.plant.parameters["J_A"].value == stated["J_A"].value
    assert result.plant.parameters["J_A"].sd == pytest.approx(stated["J_A"].sd)
    assert any("parameters stay as stated" in note for note in result.diagnosis.notes)
    shrunk = result.diagnosis.shrinkage
    assert shrunk is not None
    assert shrunk.rms_before == shrunk.rms_nominal == shrunk.rms_after


@pytest.mark.soak
def test_a_re_tune_that_predicts_better_is_written(plant: BoundPlant, fly: Fly) -> None:
    result = checked_on(plant, fly, TWO_SD)
    stated, tuned = plant.plant.parameters["J_A"].value, result.plant.parameters["J_A"].value
    assert isinstance(stated, float)
    assert tuned == pytest.approx(TWO_SD * stated, rel=0.03)
    assert not any("parameters stay as stated" in note for note in result.diagnosis.notes)


SPRING = {"azimuth.cable_spring": {"k": 0.004, "angle_0": 0.0, "h": 0.0}}


def test_an_effect_that_takes_most_of_the_hold_outs_error_is_the_whole(rubbed: Result) -> None:
    found = rubbed.diagnosis
    assert found.found == ("arm.coulomb",)
    assert not any("something else is missing" in note for note in found.notes)
    assert found.unknown is not None
    assert found.unknown.probability < found.effects[0].probability / 2.0


@pytest.mark.soak
def test_a_coarse_sensor_is_added_though_its_steps_make_no_prediction_better(plant: BoundPlant, fly: Fly) -> None:
    coarse = {"psi_sensor.quantization": {"q": 0.02}}  # 13 counts: what they leave is most of the error, found or not
    logs = [fly(seed, coarse, rig_seed=55, air=False) for seed in (55, 56)]
    found = diagnose(plant, Material(logs[:1], logs[1:], ["hold"], [None, None])).diagnosis
    assert found.found == ("psi_sensor.quantization",)


def test_commands_of_the_hold_out_that_stand_late_are_told_with_its_name_and_rows() -> None:
    """Truth: the arm as stated, its commands logged three rows late."""
    log = arm_log(seed=52)
    late = replace(log, u=np.concatenate([np.repeat(log.u[:1], 3, axis=0), log.u[:-3]]))
    (note,) = misplaced_held_out(arm_case(late), ["hold"])
    assert note.said is not None
    assert note.said.startswith("in hold perhaps u_V stands three rows late in the log")
    assert not misplaced_held_out(arm_case(log), ["hold"])


# On an arm, which is fitted in a blink: a rub is what its rig has and its model lacks.
RUB = {"arm.coulomb": {"b": 4e-4}}


def judged(log: RunLog) -> tuple[Case, Holdout]:
    """A log with the arm as stated as what it is judged against."""
    case = arm_case(log)
    base = nominal_fit(arm_case(arm_log(seed=31)))
    return case, Holdout(JudgedLogs(case), ["hold"], [None], FittedHypothesis((), base, 0.0))


def supposing(effects: dict[str, dict[str, float]]) -> FittedHypothesis:
    """The arm as stated with effects of these sizes."""
    base = nominal_fit(arm_case(arm_log(seed=31)))
    return FittedHypothesis(tuple(effects), replace(base, hypothesis=base.hypothesis.with_effects(effects)), 1.0)


def rubbing() -> FittedHypothesis:
    """The arm as fitted to a run that rubs."""
    case = arm_case(arm_log(RUB, seed=32))
    found: Fit | None = fit(case, with_process_noise(case, plain_fit(case).hypothesis.with_effects(RUB)))
    assert found is not None
    return FittedHypothesis(tuple(RUB), found, 1.0)


def test_what_the_hold_out_has_is_surely_better_and_what_it_has_not_surely_worse() -> None:
    _, with_rub = judged(arm_log(RUB, seed=33))
    told, notes, _ = asked(with_rub, rubbing())
    assert told.gain > decisions.SURELY * told.sd
    assert favour(told) > 0.5
    assert notes == ()
    assert added(with_rub, rubbing(), 0.1)[0].effects == tuple(RUB)

    _, without = judged(arm_log(seed=34))
    (told, _, _), (chosen, notes, rules) = asked(without, rubbing()), added(without, rubbing(), 0.9)
    assert told.gain < -decisions.SURELY * told.sd
    assert favour(told) < -0.5
    assert (chosen is without.base, [note.kind for note in notes]) == (True, ["predicts_worse"])
    assert rules[0].outcome == "nothing added"


def test_parameters_alone_are_held_against_those_that_are_stated() -> None:
    # Truth: the arm is a fifth longer than its file says, and both runs are of that rig: of the re-tuned plant, which lacks nothing, the
    # hold-out says all there is to say for it, though it predicts no better than itself.
    longer = 1.2 * np.asarray(arm().plant.parameters["l"].value).item()
    case, checked = (arm_case(arm_log(seed=seed, l=longer)) for seed in (31, 33))
    moved = FittedHypothesis((), nominal_fit(case), 0.0)
    holdout = Holdout(JudgedLogs(checked), ["hold"], [None], moved)
    told, notes, rules = asked(holdout, moved)
    assert holdout.score(moved.fit.hypothesis).gain == 0.0
    assert told.gain > decisions.SURELY * told.sd
    assert favour(told) > 0.5
    assert (notes, rules[0].of) == ((), "parameters")


def test_a_hold_out_of_another_rig_makes_no_gap_none() -> None:
    # Truth: the rig that was fitted rubs, that of the hold-out does not. It may weaken the one name that there is; whether there is a gap
    # the fitted logs say, however small it be, by predictions that are ten nats better.
    (_, other), found = judged(arm_log(seed=34)), rubbing()
    case = arm_case(arm_log(RUB, seed=32))
    plain = FittedHypothesis((), plain_fit(case), 0.0)
    empty = Scores(np.zeros((0, 0)), np.zeros(0), np.zeros(0))
    detection = Detection(1e-4, Tail(5.0, 1.0), 30.0, False, FormScores((), empty, np.zeros(0)))
    seen = Seen(case, None, plain, object(), (), None, detection)  # type: ignore[arg-type]
    told, notes, _ = asked(other, found)
    named = replace(found, evidence=30.0)
    weighed = weigh(Explanations((named,), plain, case.library, 20.0), {named: 10.0}, favour(told))
    assert weighed.probabilities[0] < 0.5
    result = Judged(object(), None, None, weighed, other.base, other, notes)  # type: ignore[arg-type]
    after, left_by = of_consequence(seen, result)
    assert left_by is None
    assert after.detection.p == 1e-4


@pytest.mark.parametrize(
    ("rubs_Nm", "left_by"),
    [(0.0, Exit.TOO_SMALL), (0.5e-4, Exit.TOO_UNSURE), (1e-4, None)],
    ids=["no", "half", "whole"],
)
def test_what_logs_that_were_not_fitted_may_be_predicted_better_by_is_not_said_to_be_nothing(
    rubs_Nm: float, left_by: Exit | None
) -> None:
    # Truth: a rub of 0.1 mN m is supposed, of which the fitted logs say nothing. Six seconds of a rig that has it say so, those of one that
    # has none contradict it; of one that has half of it they may be predicted a little better, or not.
    _, holdout = judged(arm_log({"arm.coulomb": {"b": rubs_Nm}} if rubs_Nm else None, seed=33, seconds=6.0))
    case, found = arm_case(arm_log(seed=31)), supposing({"arm.coulomb": {"b": 1e-4}})
    empty = Scores(np.zeros((0, 0)), np.zeros(0), np.zeros(0))
    detection = Detection(1e-4, Tail(5.0, 1.0), 30.0, False, FormScores((), empty, np.zeros(0)))
    seen = Seen(case, None, holdout.base, object(), (), None, detection)  # type: ignore[arg-type]
    weighed = Weighed((found,), (0.6,), 0.4, 0.0, 10.0, ahead_nats=0.0)
    result = Judged(object(), None, None, weighed, found, holdout, ())  # type: ignore[arg-type]
    assert of_consequence(seen, result)[1] is left_by
    assert [note.subject for note in may_be_missing(result)] == ["arm.coulomb"]


@pytest.mark.parametrize(("ahead_nats", "left_by"), [(0.0, Exit.TOO_SMALL), (1e3, Exit.TOO_UNSURE)])
def test_what_a_free_curve_surely_predicts_better_is_not_said_to_be_nothing(ahead_nats: float, left_by: Exit) -> None:
    # Truth by hand: the name predicts nothing, the curve nothing either or a thousand nats.
    _, holdout = judged(arm_log(seed=33, seconds=6.0))
    case, found = arm_case(arm_log(seed=31)), supposing({"arm.coulomb": {"b": 1e-4}})
    empty = Scores(np.zeros((0, 0)), np.zeros(0), np.zeros(0))
    detection = Detection(1e-4, Tail(5.0, 1.0), 30.0, False, FormScores((), empty, np.zeros(0)))
    seen = Seen(case, None, holdout.base, object(), (), None, detection)  # type: ignore[arg-type]
    weighed = Weighed((found,), (0.6,), 0.4, 0.0, 10.0, ahead_nats=0.0)
    form = curves(plain_linearisation())[0]
    curve = FittedCurve(form, np.zeros(0), np.zeros((0, 0)), case, found.fit, 50.0, ahead_nats)
    result = Judged(object(), None, curve, weighed, found, holdout, ())  # type: ignore[arg-type]
    assert of_consequence(seen, result)[1] is left_by
    subjects = [note.subject for note in may_be_missing(result)]
    assert subjects == ["arm.coulomb", *([form.class_text] if ahead_nats else [])]


def test_what_is_unlikely_is_added_only_where_the_hold_out_is_better_for_it() -> None:
    # Truth: a rub too small for a second to show, of the plant that rubs not at all.
    _, holdout = judged(arm_log(seed=36))
    hardly = supposing({"arm.coulomb": {"b": 1e-9}})
    assert abs(holdout.score(hardly.fit.hypothesis).gain) < decisions.MATTERS
    assert added(holdout, hardly, 0.51)[0].effects == ("arm.coulomb",)
    chosen, notes, rules = added(holdout, hardly, 0.49)
    assert (chosen is holdout.base, [note.kind for note in notes], rules[0].outcome) == (
        True,
        ["unsure"],
        "nothing added",
    )


@pytest.mark.parametrize(
    ("last", "probability", "told"),
    [(4.0, 0.9, ["predicts_worse"]), (1.02, 0.9, []), (1.02, 0.4, ["unsure"]), (1.0, 0.4, [])],
)
def test_what_predicts_a_second_surely_worse_is_not_added_however_well_it_predicts_a_row(
    last: float, probability: float, told: list[str]
) -> None:
    # Truth by hand: errors a hundredth as large over all horizons but the longest, and there twice as large, 1 % larger, or the same, in 20
    # windows. What is less likely than not may be no worse there at all.
    _, holdout = judged(arm_log(seed=36))
    hypothesis = (hardly := supposing({"arm.coulomb": {"b": 1e-9}})).fit.hypothesis
    before = np.ones((20, len(HORIZONS_S), 1))
    after = 1e-4 * before
    after[:, -1] = last
    nothing = np.zeros_like(before)
    holdout.ways.update({hypothesis: hypothesis})
    holdout.logs.judged.update(
        {
            hypothesis: Errors(after, np.zeros(1), nothing),
            holdout.base.fit.hypothesis: Errors(before, np.zeros(1), nothing),
        }
    )
    assert holdout.score_of_plant(hardly).gain > 3.0
    assert holdout.score_of_longest(hardly).gain == pytest.approx(-0.5 * np.log(last))
    chosen, notes, rules = added(holdout, hardly, probability)
    assert (chosen is hardly) == (not told)
    assert [note.kind for note in notes] == told
    assert [rule.rule for rule in rules] == ["added", "added_for_long"]


def test_what_leaves_most_of_the_hold_outs_error_is_told_to_be_a_part() -> None:
    # Truth: the hold-out's rig rubs ten times as much as the one that was fitted.
    _, holdout = judged(arm_log({"arm.coulomb": {"b": 4e-3}}, seed=35))
    told, notes, _ = asked(holdout, rubbing())
    assert told.gain > decisions.SURELY * told.sd
    assert [note.kind for note in notes] == ["something_else_missing"]


def test_a_log_that_says_nothing_of_a_name_speaks_neither_way_and_it_is_added() -> None:
    assert favour(Score(0.0, 0.0, 0.0)) == 0.0
    assert favour(Score(0.0, np.inf, 0.3)) == 0.0
    _, holdout = judged(arm_log(seed=36))
    push = {"arm.disturbance": {"torque": 2e-3, "t_0": 12.0, "duration": 1.0}}
    told = holdout.score(supposing(push).fit.hypothesis)
    assert told.gain == 0.0  # a push of another log foretells nothing
    assert added(holdout, supposing(push), 0.9)[0].effects == tuple(push)


@pytest.mark.parametrize(("shifted_s", "counts_s"), [(6.0, [6.0]), (0.0, [0.0]), (None, [])])
def test_a_shift_of_another_log_counts_where_these_have_it_then_or_from_the_start(
    shifted_s: float | None, counts_s: list[float]
) -> None:
    # Truth: a weight that slipped after 6 s of a log that was fitted; of that held out at the same time, before, or not at all.
    name, delta_N_m = "arm.weight_shift", 2e-3
    there = {} if shifted_s is None else {name: {"Delta": delta_N_m, "t_1": shifted_s}}
    _, holdout = judged(arm_log(there, seed=36))
    shift = {"Delta": delta_N_m, "t_1": 6.0}
    fitted_log, absent = 7, {"Delta": 0.0, "t_1": 10.0}
    hypothesis = supposing({name: shift}).fit.hypothesis.with_own(name, {ELSEWHERE: absent, fitted_log: shift})
    assert [v["t_1"] for v in holdout.foreseen(hypothesis).effects.values()] == counts_s


def test_a_push_of_another_log_is_not_added_with_parameters_that_predict_worse() -> None:
    # Truth: no push in these logs, and the plant as stated; parameters five deviations off are another plant's.
    _, holdout = judged(arm_log(seed=36))
    push = supposing({"arm.disturbance": {"torque": 2e-3, "t_0": 12.0, "duration": 1.0}})
    hypothesis = push.fit.hypothesis
    bent = replace(push, fit=replace(push.fit, hypothesis=replace(hypothesis, theta=hypothesis.theta + 5.0)))
    assert holdout.score(bent.fit.hypothesis).gain == 0.0
    assert added(holdout, bent, 0.9)[0] is holdout.base


def test_noise_is_not_what_is_judged() -> None:
    # Truth: the same friction with a process noise a hundred thousand times too small, so that its filter follows nothing, says as much
    # within a standard error, as it is given that of the plant that it is held against.
    _, holdout = judged(arm_log(RUB, seed=33))
    hypothesis = rubbing().fit.hypothesis
    deaf = replace(hypothesis, process_noise=hypothesis.process_noise - 5.0)
    told, as_deaf = holdout.score(hypothesis), holdout.score(deaf)
    assert as_deaf.gain == pytest.approx(told.gain, abs=told.sd)
    deafer = holdout.score(replace(hypothesis, process_noise=hypothesis.process_noise - 6.0))
    assert as_deaf.gain == pytest.approx(deafer.gain, abs=1e-6)


def test_steps_that_the_readings_lie_on_are_likelier_by_their_log() -> None:
    (step,), coarse = arm().plant.sensors.values(), 0.02
    _, holdout = judged(arm_log({"theta_sensor.quantization": {"q": coarse}}, seed=37))
    told = holdout.score(supposing({"theta_sensor.quantization": {"q": coarse}}).fit.hypothesis)
    assert told.gain == pytest.approx(np.log(coarse / step), abs=0.05)


def test_the_plant_as_stated_is_what_is_judged_against_where_it_surely_predicts_better() -> None:
    training, (case, _) = arm_case(arm_log(seed=31)), judged(arm_log(seed=39))
    right = nominal_fit(training)
    far = replace(right, hypothesis=replace(right.hypothesis, theta=right.hypothesis.theta + 3.0))
    for tuned, stated in ((right, False), (far, True)):
        found = holdout_of(case, ["hold"], [None], training, FittedHypothesis((), tuned, 0.0))
        assert [note.kind for note in found.notes] == stated * ["stated_predicts_better"]
        assert (not found.base.fit.hypothesis.theta.any()) is stated


@pytest.mark.parametrize(("instant_s", "event"), [(12.0, True), (0.0, False)])
def test_an_event_before_all_logs_is_none(plant: BoundPlant, instant_s: float, event: bool) -> None:
    # A weight that moved at the beginning of time is another weight in each log; a push has its end besides.
    effects = library(plant)
    assert happens(effects["elevation.weight_shift"], {"Delta": 0.01, "t_1": instant_s}) is event
    assert happens(effects["elevation.disturbance"], {"torque": 1e-3, "t_0": instant_s, "duration": 1.0})
    assert not happens(effects["azimuth.cable_spring"], SPRING["azimuth.cable_spring"])


def test_what_logs_held_out_say_counts_beside_what_the_fitted_ones_do() -> None:
    # Truth: an arm that rubs by 0.4 mN m in all logs, and a pull of 0.3 mN m which the fitted hypothesis alone has: on the logs held out
    # it predicts worse by more than it was said to predict better on the others.
    rubs, pulled = {"arm.coulomb": {"b": 4e-4}}, {"arm.offset_force": {"offset": 3e-4}}
    case, other = arm_case(arm_log(rubs, seed=61)), arm_case(arm_log(rubs, seed=62))
    plain = FittedHypothesis((), nominal_fit(case), 0.0)
    right = fit(case, plain.fit.hypothesis.with_effects(rubs))
    assert right is not None
    alone = FittedHypothesis(("arm.coulomb",), right, 100.0)
    wrong = replace(right, hypothesis=right.hypothesis.with_effects({**right.hypothesis.effects, **pulled}))
    both = FittedHypothesis(("arm.coulomb", "arm.offset_force"), wrong, 120.0)
    holdout = holdout_of(other, ["hold"], [None], case, plain)
    ahead = with_held_out({alone: 20.0, both: 25.0}, holdout)
    assert ahead[alone] == pytest.approx(20.0 + holdout.readings * holdout.score(right.hypothesis).gain)
    assert ahead[alone] > 20.0 > ahead[both] - ahead[alone] + 20.0
