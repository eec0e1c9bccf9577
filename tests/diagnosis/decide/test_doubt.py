"""Logs of two plants contradict each other, logs of nothing are not known by any plant: no cause is named then."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis import decisions
from diagnosis.decide.contradiction import contradiction
from diagnosis.decide.doubt import Doubt, contradicting
from diagnosis.decide.weighing import Weighed
from diagnosis.fit.nominal import nominal_fit
from diagnosis.hypothesis.case import Case, make_case
from diagnosis.library.effect_library import EffectLibrary, effect_library
from diagnosis.validate.misfit import ignorance
from records.log import RunLog
from sim.bind import BoundPlant
from tests.diagnosis.conftest import Fly

SPRING = {"azimuth.cable_spring": {"k": 0.004, "angle_0": 0.2, "h": 0.0}}


@pytest.fixture(scope="module")
def library(plant: BoundPlant) -> EffectLibrary:
    return effect_library(plant)


def part(log: RunLog, rows: slice) -> RunLog:
    return replace(log, t_s=log.t_s[rows], u=log.u[rows], y=log.y[rows])


def gain_of_own_numbers(case: Case) -> float:
    found = contradiction(case, nominal_fit(case))
    assert found is not None
    return found.gain


def test_two_parts_of_one_flight_agree_and_flights_of_two_plants_do_not(library: EffectLibrary, fly: Fly) -> None:
    # About 25 numbers of its own gain a log half a nat each by chance; a spring that only one of two plants has gains several times
    # that, whatever part of it noise with a memory takes.
    flight = fly(41)
    agreeing = make_case(library, [part(flight, slice(0, 1500)), part(flight, slice(1500, 3000))])
    assert gain_of_own_numbers(agreeing) < 30.0
    differing = make_case(library, [part(flight, slice(0, 1500)), part(fly(42, SPRING), slice(0, 1500))])
    assert gain_of_own_numbers(differing) > 60.0
    assert contradiction(make_case(library, [flight]), nominal_fit(agreeing)) is None


def test_a_hold_out_of_another_rig_is_told_though_each_is_as_stated(library: EffectLibrary, fly: Fly) -> None:
    # Every rig is within its stated spread; the third log is of another one.
    one, same, other = (fly(seed, rig_seed=rig) for seed, rig in ((71, 71), (72, 71), (73, 74)))
    alike, unlike = make_case(library, [one, same]), make_case(library, [one, other])
    assert contradicting(alike, nominal_fit(alike).hypothesis, ["train", "hold"])[0] == ()
    (told,), _ = contradicting(unlike, nominal_fit(make_case(library, [one])).hypothesis, ["train", "hold"])
    assert (told.kind, told.numbers["gain_nats"] > 150.0) == ("contradiction", True)


def test_a_plant_knows_its_own_flights_and_nothing_of_a_random_walk(library: EffectLibrary, fly: Fly) -> None:
    # Errors over those of holding the last reading: a small share where the plant is right, 1 where nothing can be known.
    flight = part(fly(43), slice(0, 1500))
    known = make_case(library, [flight])
    assert max(ignorance(known, nominal_fit(known).hypothesis).values()) < 0.2
    walk = np.cumsum(np.random.default_rng(3).normal(0.0, 0.004, flight.y.shape), axis=0)
    unknown = make_case(library, [replace(flight, y=np.clip(walk, -0.7, 0.7))])
    found = ignorance(unknown, nominal_fit(unknown).hypothesis)
    assert min(found.values()) > 0.9


def test_an_output_that_stands_says_nothing_of_what_is_known(library: EffectLibrary, fly: Fly) -> None:
    flight = part(fly(43), slice(0, 600))
    case = make_case(library, [replace(flight, y=np.column_stack([np.full(600, 0.1), flight.y[:, 1]]))])
    assert set(ignorance(case, nominal_fit(case).hypothesis)) <= {"phi_rad"}


def test_a_doubt_leaves_next_to_nothing_for_names_and_all_probabilities_sum_to_one() -> None:
    weighed = Weighed((), (0.7, 0.2), unknown=0.04, retune=0.06, scale=4.0)
    assert Doubt((), (), forbids=False).applied(weighed) is weighed
    doubted = Doubt((), (), forbids=True).applied(weighed)
    assert doubted.unknown == decisions.UNNAMED
    assert sum(doubted.probabilities) + doubted.unknown + doubted.retune == pytest.approx(1.0)
    assert doubted.probabilities[0] == pytest.approx(0.7 * 0.05 / 0.96)
