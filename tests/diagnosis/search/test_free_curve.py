"""A free curve takes the form of what is missing, with the evidence of a hypothesis like any other; where nothing is, there is none."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis import decisions
from diagnosis.decide.consequence import curve_that_predicts, curve_with_held_out
from diagnosis.decide.holdout import Holdout
from diagnosis.decide.weighing import learned
from diagnosis.detect.curves import KNOTS, curves
from diagnosis.detect.linearisation import Linearisation, linearised
from diagnosis.detect.signals import signals
from diagnosis.explain.curve import shape_of
from diagnosis.fit.evidence import FittedHypothesis, as_fitted
from diagnosis.fit.gauss_newton import fit
from diagnosis.fit.nominal import plain_fit
from diagnosis.hypothesis.case import Case, make_case
from diagnosis.library.effect_library import EffectLibrary
from diagnosis.search.fitting import refined
from diagnosis.search.free_curve import FittedCurve, free_curve
from diagnosis.validate.fitted_logs import FittedLogs
from diagnosis.validate.judged_logs import JudgedLogs
from records.log import RunLog
from sim.bind import BoundPlant
from tests.diagnosis.conftest import Fly

DRAG = 1e-2  # N m s^2


def seen(library: EffectLibrary, logs: list[RunLog]) -> tuple[Case, FittedHypothesis, Linearisation]:
    """The plant alone, fitted to logs."""
    case = make_case(library, logs)
    plain = plain_fit(case)
    return case, as_fitted(case, plain), linearised(case, plain)


@pytest.fixture(scope="module")
def dragged(stateless: EffectLibrary, fly: Fly) -> tuple[Case, FittedHypothesis, Linearisation]:
    return seen(stateless, [fly(1, {"elevation.quadratic_drag": {"c": DRAG}}, rig_seed=3)])


@pytest.fixture(scope="module")
def found(dragged: tuple[Case, FittedHypothesis, Linearisation]) -> FittedCurve:
    case, plain, linearisation = dragged
    curve = free_curve(case, plain, linearisation, plain)
    assert curve is not None
    return curve


def test_the_evidence_of_a_curve_is_nearly_that_of_the_effect_it_stands_for(
    dragged: tuple[Case, FittedHypothesis, Linearisation], found: FittedCurve
) -> None:
    # Truth: the drag itself, of one number, is likelier, but by no more than three nats for each of the curve's.
    case, plain, _ = dragged
    start = plain.fit.hypothesis.with_effects({"elevation.quadratic_drag": {"c": DRAG}})
    drag = fit(case, start)
    assert drag is not None
    ended = refined(case, as_fitted(case, drag))
    assert ended is not None
    gained = ended.evidence - plain.evidence
    assert found.curve.class_text == "torque(psi_dot) on elevation"
    assert gained - 3.0 * found.curve.weights < found.evidence - plain.evidence < gained


def test_its_shape_is_that_of_the_missing_torque(plant: BoundPlant, found: FittedCurve) -> None:
    # Truth: -c |v| v / J_E about its mean: to three tenths of its size, as 20 s tell no better which way the axis leans that little, and
    # within four of the curve's own deviations everywhere.
    shape = shape_of(found, float(learned().scale_nats(0.0)))
    true = -DRAG / plant.plant.parameters["J_E"].values[0] * np.abs(shape.x) * shape.x
    error = shape.value - (true - true.mean())
    assert np.std(error) < 0.3 * np.std(true)
    assert np.all(np.abs(error) < 4.0 * shape.sd)
    assert (shape.depends.name, shape.depends.unit) == ("psi_dot", "rad/s")
    assert (shape.target.name, shape.target.unit, shape.times) == ("d psi_dot/dt", "rad/s^2", None)


def test_a_rig_as_its_file_states_has_none_worth_a_name(stateless: EffectLibrary, fly: Fly) -> None:
    case, plain, linearisation = seen(stateless, [fly(1, rig_seed=3)])
    curve = free_curve(case, plain, linearisation, plain)
    assert curve is None or curve.evidence - plain.evidence < decisions.TAKEN_IN


def test_a_curve_bends_at_a_bumper_s_edge(dragged: tuple[Case, FittedHypothesis, Linearisation]) -> None:
    # Truth: max(0, x - e) at any edge e within the way, to a tenth of a step between knots everywhere.
    _, _, linearisation = dragged
    angle = signals(linearisation, 0, {}).angle["elevation"]
    (curve,) = (one for one in curves(linearisation) if one.class_text == "torque(psi) on elevation")
    inertia = signals(linearisation, 0, {}).inertia["elevation"]
    for edge in np.quantile(angle, [0.3, 0.6, 0.9]):
        bumper = np.maximum(angle - edge, 0.0) / inertia
        b = np.linalg.lstsq(curve.values[0], bumper, rcond=None)[0]
        assert np.abs(curve.values[0] @ b - bumper).max() < 0.2 * np.ptp(angle) / KNOTS / inertia.min()


def test_along_other_logs_a_curve_is_the_same_function_of_what_they_show(
    stateless: EffectLibrary,
    fly: Fly,
    dragged: tuple[Case, FittedHypothesis, Linearisation],
    found: FittedCurve,
) -> None:
    # Truth: along its own logs what it adds is what it was fitted with; along others B(x) b of the speed there, over the moment of inertia.
    again, first = (case.flights[0].filter_input.added for case in (found.along(dragged[2]), found.case))
    assert again is not None
    assert first is not None
    assert np.array_equal(again.states, first.states)
    _, _, other = seen(stateless, [fly(2, {}, rig_seed=4)])
    there = signals(other, 0, {})
    added = found.along(other).flights[0].filter_input.added
    assert added is not None
    rates = (found.curve.basis(there.speed["elevation"]) @ found.b) / there.inertia["elevation"]
    gathered = np.append(0.0, np.cumsum(np.diff(there.t) * rates[:-1]))
    assert added.states[:, found.curve.target] == pytest.approx(gathered, abs=1e-12)


def test_what_a_curve_predicts_of_a_hold_out_counts_like_what_it_predicts_of_the_fitted_logs(
    dragged: tuple[Case, FittedHypothesis, Linearisation], found: FittedCurve
) -> None:
    # Truth: held out are the logs themselves, so that both predictions are one.
    case, plain, _ = dragged
    hypothesis = plain.fit.hypothesis
    there = curve_that_predicts(FittedLogs(case), found, hypothesis)
    assert there is not None
    own = there.ahead_nats
    holdout = Holdout(JudgedLogs(case), ("again",), (None,), FittedHypothesis((), plain.fit, plain.evidence))
    assert own > 0.0
    both = curve_with_held_out(there, holdout)
    assert both is not None
    assert both.ahead_nats == pytest.approx(2.0 * own, rel=1e-9)
    assert curve_with_held_out(None, holdout) is None
    # A plant that leaves all bounds along the hold-out tells nothing of the curve there.
    astray = replace(plain.fit, hypothesis=replace(hypothesis, theta=hypothesis.theta + 1e9))
    lost = replace(holdout, base=FittedHypothesis((), astray, plain.evidence))
    assert curve_with_held_out(there, lost) is there


def test_a_curve_that_predicts_worse_than_the_plant_alone_is_none(
    dragged: tuple[Case, FittedHypothesis, Linearisation], found: FittedCurve
) -> None:
    # Truth: turned around, it pushes where there is drag.
    case, plain, linearisation = dragged
    turned = replace(found, b=-found.b)
    assert (
        curve_that_predicts(FittedLogs(case), replace(turned, case=turned.along(linearisation)), plain.fit.hypothesis)
        is None
    )


def test_an_encoder_that_loses_counts_above_a_speed_is_a_curve_of_it(
    dragged: tuple[Case, FittedHypothesis, Linearisation],
) -> None:
    # Truth: an error that grows by a tenth of the way while it goes faster than e, to a twentieth of what it becomes, for any e.
    _, _, linearisation = dragged
    v, t_s = signals(linearisation, 0, {}).speed["elevation"], linearisation.filter_inputs[0].t_s
    (curve,) = (one for one in curves(linearisation) if one.class_text == "output(sum of psi_dot) of psi")
    for edge in np.quantile(np.abs(v), [0.3, 0.6]):
        lost = -0.1 * np.where(np.abs(v) > edge, v, 0.0)
        error = np.append(0.0, np.cumsum(0.5 * (lost[1:] + lost[:-1]) * np.diff(t_s)))
        b = np.linalg.lstsq(curve.values[0], error, rcond=None)[0]
        assert np.abs(curve.values[0] @ b - error).max() < 0.05 * np.ptp(error)


def test_no_error_of_a_reading_follows_an_input(dragged: tuple[Case, FittedHypothesis, Linearisation]) -> None:
    # What a controller commands in a row it made of the row's own reading, so that its errors are in the command.
    _, _, linearisation = dragged
    texts = [one.class_text for one in curves(linearisation)]
    assert "output(omega_M) of psi" in texts
    assert not [text for text in texts if text.startswith("output(u")]
