"""What the search must not miss: a step known finely, an effect hidden behind its like."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

from diagnosis import decisions
from diagnosis.decide.weighing import Weighed
from diagnosis.detect.linearisation import linearised
from diagnosis.detect.score_tests import score_effects
from diagnosis.detect.starts import ScoreTest
from diagnosis.explain.places import place_shares
from diagnosis.fit.evidence import FittedHypothesis, log_evidence
from diagnosis.fit.free_numbers import Free
from diagnosis.fit.gauss_newton import fit
from diagnosis.fit.linear_problem import Fit
from diagnosis.hypothesis.case import Case, make_case
from diagnosis.hypothesis.hypothesis import Hypothesis
from diagnosis.library.effect_library import effect_library
from diagnosis.search.beam import Search, search
from diagnosis.search.exchange import exchange, fit_twins, shrink
from diagnosis.search.fitting import Proposal, once_more, refined, rough
from diagnosis.search.singles import Alone, first_of_each, worth_ending
from diagnosis.search.sure_sizes import certainties
from sim.added_effects import library
from sim.bind import BoundPlant
from sim.effect import Values
from tests.diagnosis.arm import arm_case, arm_log
from tests.diagnosis.conftest import Fly
from tests.diagnosis.nominal import nominal_fit
from tests.soak import SOAK

STEP_V, OFFSET_RAD = 0.107565, -0.0046
FINELY = 2e-5
WARMING = {"tail_rotor.warmup": {"a": 0.22, "T": 18.0}}


def fitted(case: Case, nominal: Fit, effects: Mapping[str, Values]) -> FittedHypothesis:
    """The fit of these effects from these values."""
    found = fit(case, nominal.hypothesis.with_effects(effects))
    assert found is not None
    return FittedHypothesis(tuple(effects), found, log_evidence(found, case.library.effects))


def test_the_step_of_an_input_is_found_to_a_fifty_thousandth(plant: BoundPlant, fly: Fly) -> None:
    # Rounded commands of 100 steps shift where they round with a step 1e-4 off, which costs 100 nats and bends all else.
    truth = {"main_input.quantization": {"q": STEP_V, "h": 0.0, "s": 0.0}, "psi_sensor.offset": {"offset": OFFSET_RAD}}
    case = make_case(effect_library(plant), [fly(41, truth, 15.0 if SOAK else 10.0, air=False)])
    nominal = nominal_fit(case)
    off = {**truth, "main_input.quantization": {"q": STEP_V * (1.0 + 7e-4), "h": 0.0, "s": 0.0}}
    end: FittedHypothesis | None = fitted(case, nominal, off)
    for _ in range(2):
        assert end is not None
        end = refined(case, end)
    assert end is not None
    assert end.fit.hypothesis.effects["main_input.quantization"]["q"] == pytest.approx(STEP_V, rel=FINELY)


def test_where_no_effect_could_be_fitted_the_plant_as_it_is_stays(plant: BoundPlant, fly: Fly) -> None:
    """A coil beside a log of its own: nothing shows of which a fit begins."""
    case = make_case(effect_library(plant), [fly(41, {}, 5.0, air=False)])
    nominal = nominal_fit(case)
    first = FittedHypothesis((), nominal, log_evidence(nominal, case.library.effects))
    found = search(case, (), Alone({}, first, frozenset(), linearised(case, nominal), ()))
    assert (found.fitted, found.sure) == ((first,), False)


SPRING = {"azimuth.cable_spring": {"k": 0.004, "angle_0": 0.2, "h": 0.0}}
LATE = {"main_input.delay": {"tau": 0.05}}


@pytest.fixture(scope="module")
def sprung_and_late(plant: BoundPlant, fly: Fly) -> tuple[Case, Fit]:
    """A flight of a rig with a spring and 50 ms of delay, and the plant as stated fitted to it."""
    case = make_case(effect_library(plant), [fly(42, {**SPRING, **LATE}, air=False)])
    return case, nominal_fit(case)


def test_an_effect_is_exchanged_for_its_like(sprung_and_late: tuple[Case, Fit]) -> None:
    # 50 ms of delay of the main input, taken for a lag of the elevation's sensor beside the right spring.
    case, nominal = sprung_and_late
    wrong = fitted(case, nominal, {**SPRING, "psi_sensor.lag": {"tau": 0.05}})
    found = {frozenset(wrong.effects): wrong}
    exchange(case, found, {"main_input.delay", "main_input.lag", "psi_sensor.delay", "psi_sensor.lag"})
    best = max(found.values(), key=lambda entry: entry.evidence)
    assert set(best.effects) == {"azimuth.cable_spring", "main_input.delay"}
    assert best.fit.hypothesis.effects["main_input.delay"]["tau"] == pytest.approx(0.05, abs=0.002)
    assert best.evidence > wrong.evidence + 20.0


def test_what_showed_beside_a_wrong_effect_does_without_it(sprung_and_late: tuple[Case, Fit]) -> None:
    # A spring and 50 ms of delay, which the search reached only with an idle offset of a sensor beside them.
    case, nominal = sprung_and_late
    idle = {"psi_sensor.offset": {"offset": 1e-4}}
    three = fitted(case, nominal, {**SPRING, **LATE, **idle})
    found = {frozenset(three.effects): three}
    shrink(case, found)
    best = max(found.values(), key=lambda entry: entry.evidence)
    assert set(best.effects) == {"azimuth.cable_spring", "main_input.delay"}
    assert best.fit.hypothesis.effects["main_input.delay"]["tau"] == pytest.approx(0.05, abs=0.002)
    assert best.fit.hypothesis.effects["azimuth.cable_spring"]["k"] == pytest.approx(0.004, rel=0.1)


@pytest.mark.soak
def test_the_twin_of_the_best_is_tried_in_its_place(plant: BoundPlant, fly: Fly) -> None:
    # A lag of the elevation's sensor, of which the search so far knows no more than the delay that is alike.
    case = make_case(effect_library(plant), [fly(44, {"psi_sensor.lag": {"tau": 0.06}}, air=False)])
    late = fitted(case, nominal_fit(case), {"psi_sensor.delay": {"tau": 0.05, "jitter": 0.0}})
    found = {frozenset(late.effects): late}
    fit_twins(case, found, late)
    best = max(found.values(), key=lambda entry: entry.evidence)
    assert best.effects == ("psi_sensor.lag",)
    assert best.fit.hypothesis.effects["psi_sensor.lag"]["tau"] == pytest.approx(0.06, abs=0.003)


def test_an_effect_alone_is_as_sure_as_its_size_with_its_shape_held(plant: BoundPlant) -> None:
    # A spring of stiffness 1 known to 0.1 where its rest is known, and to 7 where it is not: each makes up for the other.
    spring, push = (library(plant)[name] for name in ("azimuth.cable_spring", "azimuth.offset_force"))
    k, angle_0, offset = spring.parameter["k"], spring.parameter["angle_0"], push.parameter["offset"]
    both = np.array([[100.0, 99.99], [99.99, 100.0]])
    values = {spring.name: {"k": 1.0, "angle_0": 0.5, "h": 0.0}}
    free = (Free(spring.name, k, 1.0), Free(spring.name, angle_0, 1.0))
    hypothesis = Hypothesis(np.zeros(0), values, np.zeros(2))
    assert certainties(Fit(hypothesis, 0.0, 0.0, free, both, np.zeros(2)))[spring.name] == pytest.approx(10.0)
    beside = Hypothesis(np.zeros(0), {**values, push.name: {"offset": 1.0}}, np.zeros(2))
    three = np.block([[both, np.zeros((2, 1))], [np.zeros((1, 2)), np.full((1, 1), 25.0)]])
    found = certainties(Fit(beside, 0.0, 0.0, (*free, Free(push.name, offset, 1.0)), three, np.zeros(3)))
    assert found[spring.name] == pytest.approx(0.1414, abs=1e-3)
    assert found[push.name] == pytest.approx(5.0)


@pytest.mark.soak
def test_a_limit_is_seen_whose_corner_alone_is_reached(plant: BoundPlant, fly: Fly) -> None:
    # Commands stay well under the limit of 8.5 V, whose corner is rounded from 6.8 V on: a limit that they reach is far from the truth.
    truth = {"main_input.saturation": {"limit": 8.5, "w": 0.2}}
    case = make_case(effect_library(plant), [fly(45, truth, rig_seed=43, air=False, seconds=60.0)])
    assert 6.8 < np.max(case.flights[0].filter_input.u[:, 0]) < 0.9 * 8.5
    score_tests = score_effects(case, linearised(case, nominal_fit(case)), list(truth))
    gains = {entry.effect: entry.gain for entry in score_tests}
    assert gains["main_input.saturation"] > decisions.chance_nats()


def test_an_effect_whose_absence_was_not_tried_has_its_part_of_the_gap(sprung_and_late: tuple[Case, Fit]) -> None:
    # Two effects of some size; of the two alone only one was tried, so that nothing says what the other takes from the evidence.
    case, nominal = sprung_and_late
    tried = [refined(case, fitted(case, nominal, effects)) for effects in ({**SPRING, **LATE}, LATE)]
    both, single = (entry for entry in tried if entry is not None)
    none = FittedHypothesis((), nominal, log_evidence(nominal, case.library.effects))
    search = Search((both, single, none), none, True, linearised(case, nominal), ())
    weighed = Weighed((both,), (1.0,), 0.0, 0.0, 1.0)
    shares = {row.place: row.share for row in place_shares(search, weighed, None)}
    known = both.evidence - single.evidence  # what the spring gains beside the delay
    assert known > 100.0
    assert shares["main_input"] > 0.05
    assert shares["main_input"] <= (both.evidence - none.evidence) / (both.evidence - none.evidence + known) + 1e-9


@pytest.mark.soak
def test_a_fit_gone_astray_is_begun_once_more_from_the_plant_as_stated(plant: BoundPlant, fly: Fly) -> None:
    # Truth: a motor that loses a fifth of its pull; the fit that is given has every parameter four deviations off.
    case = make_case(effect_library(plant), [fly(63, WARMING, rig_seed=63, air=False)])
    near = fitted(case, nominal_fit(case), WARMING)
    hypothesis = replace(near.fit.hypothesis, theta=np.full_like(near.fit.hypothesis.theta, 4.0))
    strayed = replace(near, fit=replace(near.fit, hypothesis=hypothesis), evidence=near.evidence - 1000.0)
    found = once_more(case, strayed)
    assert found.evidence > strayed.evidence + 900.0
    assert np.max(np.abs(found.fit.hypothesis.theta)) < 3.5
    assert found.fit.hypothesis.effects["tail_rotor.warmup"]["a"] == pytest.approx(0.22, rel=0.1)


@pytest.mark.soak
def test_an_effect_that_parameters_imitate_in_part_is_fitted_without_going_astray(plant: BoundPlant, fly: Fly) -> None:
    # Truth: a motor that loses a fifth of its pull as it warms up; other numbers of the rig by standard deviations as drawn.
    logs = [fly(seed, WARMING, rig_seed=63, air=False, seconds=60.0) for seed in (63, 73)]
    case = make_case(effect_library(plant), logs)
    nominal = nominal_fit(case)
    (seen,) = score_effects(case, linearised(case, nominal), list(WARMING))
    begun = rough(case, Proposal(nominal, seen))
    assert begun is not None
    found = refined(case, begun)
    assert found is not None
    assert np.max(np.abs(found.fit.hypothesis.theta)) < 3.5
    assert found.fit.hypothesis.effects["tail_rotor.warmup"]["a"] == pytest.approx(0.22, rel=0.05)


def springy() -> tuple[Case, Fit, ScoreTest]:
    """An arm with a springy part of 27 rad/s, fitted without, and how its mode shows.

    By first order a mode of 25 rad/s is the likeliest; a fit from there ends on a lower hill than one from 40 rad/s.
    """
    case = arm_case(arm_log({"arm.flexible_mode": {"gain": 0.85, "omega_n": 27.0, "zeta": 0.07}}, seed=5, rows=4))
    nominal = nominal_fit(case)
    (seen,) = score_effects(case, linearised(case, nominal), ["arm.flexible_mode"])
    return case, nominal, seen


def test_a_mode_between_two_starts_is_found_from_the_better_hill() -> None:
    # Truth: 27 rad/s, 236 nats above the hill of the first start, whose part swings against the axis.
    case, nominal, seen = springy()
    ends = [rough(case, Proposal(nominal, test)) for test in (seen, replace(seen, others=()))]
    found, from_one = (refined(case, entry) for entry in ends if entry is not None)
    assert found is not None
    assert from_one is not None
    assert found.evidence > from_one.evidence + 100.0
    assert found.fit.hypothesis.effects["arm.flexible_mode"]["omega_n"] == pytest.approx(27.0, rel=0.01)


def test_of_two_ways_to_the_same_effects_the_better_is_kept_whichever_comes_first() -> None:
    # Truth: a part that swings with the axis; from 25 rad/s it would be against it.
    case, nominal, seen = springy()
    ways = [Proposal(nominal, replace(seen, values=start.values, others=())) for start in seen.starts]
    ends = [first_of_each(case, order, {}) for order in (ways, ways[::-1])]
    assert [len(end) for end in ends] == [1, 1]
    assert ends[0][0].evidence == ends[1][0].evidence
    assert ends[0][0].fit.hypothesis.effects["arm.flexible_mode"]["gain"] > 0.0


def test_a_twin_of_several_sizes_begins_with_all_of_them(plant: BoundPlant, fly: Fly) -> None:
    # An inertia that goes with the elevation has two sizes, the term of Coriolis one: in its place both must be there.
    coriolis = {"azimuth.coriolis": {"c": 0.01}}
    case = make_case(effect_library(plant), [fly(43, coriolis, 8.0, air=False)])
    found: dict[frozenset[str], FittedHypothesis] = {}
    fit_twins(case, found, fitted(case, nominal_fit(case), coriolis))
    twin = found[frozenset({"azimuth.inertia_shape"})]
    assert set(twin.fit.hypothesis.effects["azimuth.inertia_shape"]) == {"J_0", "J_1"}


@pytest.mark.parametrize(
    ("gained", "ended"),
    [
        ((100.0, 30.0, 10.0), (100.0, 30.0)),  # a fifth of the most
        ((-60.0, -70.0, -200.0), (-60.0, -70.0)),  # none gains: the best, and what 25 nats do not tell from it
        ((-60.0, -61.0, -62.0, -63.0), (-60.0, -61.0, -62.0)),  # as few as of any kind
    ],
)
def test_what_is_worth_an_end_gains_a_fair_share_or_is_the_best_that_there_is(
    gained: tuple[float, ...], ended: tuple[float, ...]
) -> None:
    case = arm_case(arm_log(seed=74))
    nominal = nominal_fit(case)
    known = FittedHypothesis((), nominal, 1000.0)
    begun = [replace(known, effects=(str(gain),), evidence=1000.0 + gain) for gain in gained]
    assert sorted(entry.effects[0] for entry in worth_ending(begun, known)) == sorted(map(str, ended))
