"""What data hardly tell from a name: fitted in its place, compared under the noise that each leaves, and told beside it."""

import json
from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from diagnosis import decisions
from diagnosis.decide.weighing import Weighed, first_share
from diagnosis.fit.coloured_noise import coloured_noise_of
from diagnosis.fit.evidence import FittedHypothesis, as_fitted
from diagnosis.fit.foretold import foretold_nats
from diagnosis.fit.gauss_newton import fit
from diagnosis.fit.linear_problem import Fit
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import nominal_hypothesis, passes
from diagnosis.search.beam import Search, beam_of, with_twins
from diagnosis.search.exchange import LOST_NATS, fit_twins, is_lost, is_twin, twins_of
from diagnosis.search.fitting import refined
from diagnosis.search.noise_beside import _own_noise, hardly_told, with_noise_beside, with_noise_of
from diagnosis.validate.fitted_logs import FittedLogs
from tests.diagnosis.arm import LONG_S, arm_case, arm_log
from tests.diagnosis.nominal import nominal_fit

# Truth: the drive lags, and a torque of a seventieth of what the arm needs comes and goes within half a second.
FIRST_NOISE = -1.5
LAG = {"input.lag": {"tau": 0.1, "b": 0.0}}
GUST = {"arm.gust": {"sigma": 6e-5, "T": 0.5}}


def fitted_with(case: Case, effects: dict[str, dict[str, float]]) -> FittedHypothesis:
    """A hypothesis fitted to its end under white noise, from the arm as stated; the same for all who ask for it."""
    return _fitted_with(case, json.dumps(effects))


@cache
def _fitted_with(case: Case, effects: str) -> FittedHypothesis:
    begun = fit(case, nominal_hypothesis(case, FIRST_NOISE).with_effects(json.loads(effects)))
    assert begun is not None
    end = refined(case, as_fitted(case, begun))
    assert end is not None
    return end


def named(*effects: str) -> FittedHypothesis:
    """Effects alone, as a search has them."""
    return FittedHypothesis(effects, plain(), 1.0)


@cache
def plain() -> Fit:
    """The arm as stated, fitted to a run of it."""
    return nominal_fit(arm_case(arm_log(seed=31)))


@cache
def rubbing() -> Case:
    """0.4 mN m of dry friction, the same at all speeds."""
    return arm_case(arm_log({"arm.coulomb": {"b": 4e-4}}, seed=71))


@cache
def lagging() -> Case:
    """A lag of the drive and no noise with a memory."""
    return arm_case(arm_log(LAG, seed=43))


def beside_noise(case: Case, fitted: Sequence[FittedHypothesis]) -> list[FittedHypothesis]:
    """With noise beside names that gain little beyond the plant alone, so that what is near the likeliest is within PLAIN_TO_SEE."""
    nominal = replace(named(), evidence=max(entry.evidence for entry in fitted))
    return with_noise_beside(case, fitted, nominal)


@pytest.fixture(scope="module")
def late() -> Case:
    return arm_case(arm_log({**LAG, **GUST}, seed=41, seconds=LONG_S))


def test_a_lag_before_the_plant_has_the_lag_behind_it_among_its_twins(late: Case) -> None:
    assert {"theta_sensor.lag", "input.delay", "arm.flexible_mode"} <= twins_of(late.library, "input.lag")
    assert is_twin(late.library, named("input.lag", "arm.coulomb"), named("arm.coulomb", "theta_sensor.lag"))
    assert not is_twin(late.library, named("input.lag", "arm.coulomb"), named("input.lag", "arm.offset_force"))
    assert not is_twin(late.library, named("input.lag"), named("input.lag", "arm.coulomb"))


def test_noise_is_taken_beside_all_that_is_hardly_told_from_one_another(late: Case) -> None:
    # A lag before the arm is no twin of a delay behind it, but both are of a lag behind it; a constant force is of none.
    names = ("theta_sensor.delay", "arm.offset_force", "theta_sensor.lag", "input.lag")
    asked = [replace(named(name), evidence=-float(place)) for place, name in enumerate(names)]
    assert not is_twin(late.library, asked[0], asked[3])
    assert [entry.effects for entry in hardly_told(late, asked[0], asked[1:])] == [
        ("theta_sensor.lag",),
        ("input.lag",),
    ]


def test_of_two_names_of_one_thing_a_diagnosis_asks_for_one() -> None:
    library = arm_case(arm_log(seed=31)).library
    assert {"rotor.lag", "loop.delay"} <= set(library.effects)
    assert not {"rotor.lag", "loop.delay"} & set(library.candidates)
    assert library.effects["rotor.lag"].copy_of == "input.lag"


def test_a_smooth_torque_is_noise_and_no_lag_of_the_sensor(late: Case) -> None:
    # White noise prefers the sensor's lag, which smooths it, to the drive's, which is there. With the torque as noise this speaks against
    # the drive by less than what tells two names apart, the cost of its second pole with it: before and behind a nearly linear plant a lag
    # is one.
    sensor, drive = fitted_with(late, {"theta_sensor.lag": {"tau": 0.1}}), fitted_with(late, LAG)
    assert sensor.evidence - drive.evidence > 10.0
    sensor, drive = beside_noise(late, [sensor, drive])
    assert drive.effects == ("input.lag",)
    assert "arm.gust" in drive.fit.hypothesis.effects
    assert sensor.evidence - drive.evidence < decisions.TAKEN_IN


def test_what_is_fitted_later_gets_the_noise_of_what_it_is_compared_with(late: Case) -> None:
    sensor, drive = fitted_with(late, {"theta_sensor.lag": {"tau": 0.1}}), fitted_with(late, LAG)
    assert with_noise_of(late, [sensor], drive) == [sensor]
    noisy = beside_noise(late, [drive])[0]
    (found,) = with_noise_of(late, [sensor], noisy)
    assert found.effects == sensor.effects
    assert found.evidence > sensor.evidence
    assert "arm.gust" in found.fit.hypothesis.effects


def test_where_noise_is_more_than_noise_beside_the_likeliest_the_next_of_its_size_leads(late: Case) -> None:
    # Truth: a lag of the sensor is the likelier name, and under noise of its own predicts a second less well than a delay under its own.
    # Where that is called too little, the delay leads those of one effect.
    logs = FittedLogs(late)
    lag = fitted_with(late, {"theta_sensor.lag": {"tau": 0.1}})
    delay = fitted_with(late, {"theta_sensor.delay": {"tau": 0.1, "jitter": 0.0}})
    assert lag.evidence > delay.evidence
    gains = [logs.gain(beside_noise(late, [e])[0].fit.hypothesis, e.fit.hypothesis) for e in (lag, delay)]
    assert gains[0] < gains[1]
    with decisions.changed("MATTERS", -float(np.mean(gains)) / decisions.MATTERS):
        assert delay.effects in [entry.effects for entry in beside_noise(late, [lag, delay])]


def test_what_was_not_tried_is_fitted_in_the_place_of_its_twin(late: Case) -> None:
    (sensor,) = beside_noise(late, [fitted_with(late, {"theta_sensor.lag": {"tau": 0.1}})])
    found = {frozenset(sensor.effects): sensor}
    fresh = fit_twins(late, found, sensor)
    assert frozenset(("input.lag",)) in found
    assert {frozenset(entry.effects) for entry in fresh} == set(found) - {frozenset(sensor.effects)}
    assert fit_twins(late, found, sensor) == []  # all were tried


def test_a_twin_that_a_search_from_far_away_led_to_another_hill_is_fitted_anew() -> None:
    # Truth: 0.4 mN m of dry friction, the same at all speeds: Stribeck's that falls far beyond all motion is hardly another.
    case = rubbing()
    rub = fitted_with(case, {"arm.coulomb": {"b": 4e-4}})
    slope = fitted_with(case, {"arm.stribeck": {"b_s": 9e-4, "v_s": 0.005, "e": 0.0}})
    assert slope.evidence < rub.evidence - 100.0  # a bell narrower than a count a row
    found = {frozenset(entry.effects): entry for entry in (rub, slope)}
    fit_twins(case, found, rub)
    again = found[frozenset(("arm.stribeck",))]
    assert again.evidence > rub.evidence - 50.0
    assert again.fit.hypothesis.effects["arm.stribeck"]["b_s"] == pytest.approx(4e-4, rel=0.05)


def test_what_no_noise_brings_near_is_lost_unless_a_further_step_promises_to() -> None:
    # Truth: 0.4 mN m of dry friction. A twentieth less is thousands of nats less likely, and its slopes tell of the way back.
    case = rubbing()
    rub = fitted_with(case, {"arm.coulomb": {"b": 4e-4}})
    less = fit(case, rub.fit.hypothesis.with_effects({"arm.coulomb": {"b": 3.8e-4}}), rounds=0)
    assert less is not None
    assert rub.fit.log_likelihood - less.log_likelihood > 2.0 * LOST_NATS
    assert not is_lost(less, rub.fit)
    at_its_top = replace(less, pull=np.zeros_like(less.pull))
    assert is_lost(at_its_top, rub.fit)
    assert not is_lost(replace(at_its_top, log_likelihood=rub.fit.log_likelihood - 0.9 * LOST_NATS), rub.fit)


def test_a_twin_that_was_found_better_is_kept() -> None:
    # The same twin, known to lack 31 nats: too much to be near, and less than a fit in the place of the friction ends short of it.
    case = rubbing()
    rub = fitted_with(case, {"arm.coulomb": {"b": 4e-4}})
    known = fitted_with(case, {"arm.stribeck": {"b_s": 9e-4, "v_s": 0.005, "e": 0.0}})
    known = replace(known, evidence=rub.evidence - decisions.PLAIN_TO_SEE - 1.0)
    found = {frozenset(entry.effects): entry for entry in (rub, known)}
    (again,) = [entry for entry in fit_twins(case, found, rub) if entry.effects == known.effects]
    assert again.evidence < known.evidence
    assert found[frozenset(known.effects)] is known


def test_what_is_fitted_anew_is_told_once(late: Case) -> None:
    # The sensor's lag, of which the search knows a bad fit, is fitted in the place of the drive's: the better stands for both.
    drive = fitted_with(late, LAG)
    bad = replace(fitted_with(late, {"theta_sensor.lag": {"tau": 0.1}}), evidence=drive.evidence - 1e3)
    told = Search((drive, bad), named(), True, None, ())  # type: ignore[arg-type]
    wider = with_twins(late, told, drive)
    assert sorted({entry.effects for entry in wider.fitted}) == sorted(entry.effects for entry in wider.fitted)
    again = wider.of(bad.effects)
    assert again is not None
    assert again.evidence > drive.evidence - 50.0


def test_a_beam_holds_what_differs(late: Case) -> None:
    entries = [
        replace(named(*effects), evidence=evidence)
        for effects, evidence in ((("theta_sensor.lag",), 9.0), (("input.lag",), 8.0), (("arm.coulomb",), 7.0))
    ]
    kept = beam_of(late, entries, replace(named(), evidence=0.0), 2)
    assert [entry.effects for entry in kept] == [("theta_sensor.lag",), ("arm.coulomb",)]


def test_twins_that_the_logs_tell_apart_both_grow(late: Case) -> None:
    # Truth: a lag of the drive may be one of two effects though the sensor's alone is 300 nats likelier.
    entries = [replace(named("theta_sensor.lag"), evidence=400.0), replace(named("input.lag"), evidence=100.0)]
    kept = beam_of(late, entries, replace(named(), evidence=0.0), 2)
    assert [entry.effects for entry in kept] == [("theta_sensor.lag",), ("input.lag",)]


def test_noise_is_not_sought_beside_what_it_cannot_bring_near_the_best(late: Case) -> None:
    # Truth: a lag of the drive, under a smooth torque that is some hundred nats of noise with a memory: not a hundred thousand.
    drive = fitted_with(late, LAG)
    hopeless = replace(fitted_with(late, {"theta_sensor.lag": {"tau": 0.1}}), evidence=drive.evidence - 1e5)
    assert [entry.effects for entry in beside_noise(late, [drive, hopeless])] == [drive.effects]


def test_noise_is_sought_beside_what_it_could_bring_near_as_parameters_come_back(late: Case) -> None:
    # Truth: a fit says what friction gains under the noise of a sensor's lag, of which it is no twin. Short by half of that beyond what is
    # near it is asked, by one and a half of it not.
    sensor, rub = fitted_with(late, {"theta_sensor.lag": {"tau": 0.1}}), fitted_with(late, {"arm.coulomb": {"b": 4e-4}})
    (noisy,) = beside_noise(late, [sensor])
    (fitted,) = with_noise_of(late, [rub], noisy)
    gain = fitted.evidence - rub.evidence
    assert gain > decisions.PLAIN_TO_SEE
    with decisions.changed("PARAMETERS_BACK", 0.0):  # whatever its own innovations foretell
        for short, asked in ((0.5, True), (1.5, False)):
            entry = replace(rub, evidence=noisy.evidence - short * gain - decisions.PLAIN_TO_SEE)
            found = {one.effects for one in beside_noise(late, [sensor, entry])}
            assert (rub.effects in found) is asked


def test_where_the_likeliest_takes_none_noise_is_sought_beside_no_other() -> None:
    # Truth: a lag of the drive and no noise with a memory. Beside what lacks the lag noise could take its part, as innovations foretell.
    case = lagging()
    drive, pull = fitted_with(case, LAG), fitted_with(case, {"arm.offset_force": {"offset": 1e-5}})
    runs = [passes(case, entry.fit.hypothesis) for entry in (pull, drive)]
    promised = float(np.subtract(*(foretold_nats(run) for run in runs if run is not None)))
    assert decisions.PARAMETERS_BACK * promised > 1.5 * decisions.PLAIN_TO_SEE
    entry = replace(pull, evidence=drive.evidence - 1.5 * decisions.PLAIN_TO_SEE)
    assert beside_noise(case, [drive, entry]) == []


def test_where_an_effect_took_the_place_of_noise_it_is_sought_beside_what_has_one_less(late: Case) -> None:
    # Truth: a lag of the drive under a smooth torque. A pair that leaves no noise, as a further effect took its part, is near what the lag
    # alone comes to with noise, or beyond.
    drive = fitted_with(late, LAG)
    (noisy,) = beside_noise(late, [drive])
    pair = fitted_with(late, {**LAG, "arm.offset_force": {"offset": 1e-5}})
    for further, asked in ((0.5, True), (1.5, False)):
        entry = replace(pair, evidence=noisy.evidence + further * decisions.PLAIN_TO_SEE)
        found = {one.effects for one in beside_noise(late, [entry, drive])}
        assert (drive.effects in found) is asked


def test_whether_one_is_missing_beside_the_likeliest_is_asked_under_its_noise(late: Case) -> None:
    # Truth: a pair that is far behind without noise, and that no bound brings near, is asked for as it has what leads and one more; a pair
    # without that is not.
    drive, far = fitted_with(late, LAG), -10.0 * decisions.PLAIN_TO_SEE
    pull, rub = {"arm.offset_force": {"offset": 1e-5}}, {"arm.coulomb": {"b": 4e-4}}
    with_it, without = (fitted_with(late, effects) for effects in ({**LAG, **pull}, {**rub, **pull}))
    with decisions.changed("PARAMETERS_BACK", 0.0):  # whatever its own innovations foretell
        known = (drive, *(replace(pair, evidence=drive.evidence + far) for pair in (with_it, without)))
        found = {one.effects: one for one in beside_noise(late, known)}
    assert without.effects not in found
    assert "arm.gust" in found[with_it.effects].fit.hypothesis.effects


def test_between_twins_noise_decides_where_one_lacks_no_more_than_it_gained(late: Case) -> None:
    # Truth: noise gains some hundred nats beside the drive's lag; the sensor's, its twin, is asked where it lacks nine tenths of that,
    # which no bound brings near, and not where it lacks more than all of it.
    sensor, drive = fitted_with(late, {"theta_sensor.lag": {"tau": 0.1}}), fitted_with(late, LAG)
    (noisy,) = beside_noise(late, [drive])
    gained = noisy.evidence - drive.evidence
    with decisions.changed("PARAMETERS_BACK", 0.0):  # whatever its own innovations foretell
        for lacked, asked in ((0.9, True), (1.1, False)):
            entry = replace(sensor, evidence=drive.evidence - lacked * gained)
            found = {one.effects for one in beside_noise(late, [drive, entry])}
            assert (sensor.effects in found) is asked


def test_own_noise_is_not_sought_beside_what_stays_out_of_reach_under_noise_that_is_known(late: Case) -> None:
    # Truth: the noise of the drive's lag, with numbers that are the sensor's, is what a search that begins with it finds; far from what
    # could lead no other is sought, in reach another may be likelier and is never less.
    sensor, drive = fitted_with(late, {"theta_sensor.lag": {"tau": 0.1}}), fitted_with(late, LAG)
    (noisy,) = beside_noise(late, [drive])
    with decisions.changed("TAKEN_IN", 1e-9):  # whatever little its innovations promise
        (shared,) = with_noise_of(late, [sensor], noisy)
        out = _own_noise(late, sensor, sensor, [noisy], 0.0, least=shared.evidence + 1e6)
        near = _own_noise(late, sensor, sensor, [noisy], 0.0, least=-np.inf)
    assert out is not None
    assert near is not None
    assert out.evidence == shared.evidence
    assert near.evidence >= shared.evidence


def test_the_share_of_a_name_is_that_of_what_is_hardly_told_from_it_too(late: Case) -> None:
    tried = (named("input.lag"), named("theta_sensor.lag"), named("arm.coulomb"))
    weighed = Weighed(tried, (0.3, 0.2, 0.1), 0.4, 0.0, 10.0)
    assert first_share(late, weighed) == pytest.approx(0.5)


def test_a_corner_that_was_fitted_sharp_is_begun_round_again() -> None:
    # Truth: a dead band of 0.7 V, rounded over 0.42 V; where a fit has it sharp, its roundness has no slope.
    band = {"input.deadzone": {"d": 0.7, "w": 0.6}}
    case = arm_case(arm_log(band, seed=42, seconds=LONG_S))
    end = fitted_with(case, {"input.deadzone": {"d": 0.6, "w": 0.0}})
    assert end.fit.hypothesis.effects["input.deadzone"]["w"] == pytest.approx(0.6, rel=0.25)
    assert end.fit.hypothesis.effects["input.deadzone"]["d"] == pytest.approx(0.7, rel=0.05)


def test_noise_beside_a_name_is_left_alone_where_the_logs_tell_of_none() -> None:
    case = lagging()
    plain = fitted_with(case, LAG)
    assert beside_noise(case, [plain]) == []
    assert coloured_noise_of(case, plain.fit.hypothesis).effects.keys() == plain.fit.hypothesis.effects.keys()
