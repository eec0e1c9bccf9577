"""A sensor's delay that is never quite the same: told as that delay with its scatter, and nothing beside it."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis.detect.linearisation import linearised
from diagnosis.detect.score_tests import score_effects
from diagnosis.diagnose import Material, diagnose
from diagnosis.fit.jitter import jitter_sd, most_shown_s, with_jitter
from diagnosis.hypothesis.case import make_case
from diagnosis.hypothesis.hypothesis import nominal_hypothesis
from diagnosis.library.effect_library import effect_library
from diagnosis.search.fitting import Proposal, refined, rough
from records.log import RunLog
from sim.added_effects import with_effects
from sim.bind import BoundPlant
from sim.loop import fly_law
from sim.manoeuvres import Manoeuvre, at_rest
from tests.diagnosis.nominal import nominal_fit
from tests.plants import stated_table
from tests.soak import SOAK

TAU_S, JITTER_S = 0.03, 0.003
DELAY = "psi_sensor.delay"
SECONDS = 30.0 if SOAK else 15.0


def late_flight(plant: BoundPlant, jitter_s: float) -> RunLog:
    """SECONDS in which elevation turns at some 0.5 rad/s, read TAU_S late, more or less."""
    table = stated_table("ce150")
    t_s = np.arange(0.0, SECONDS, 0.01)
    waves = np.column_stack([0.5 * np.sin(1.8 * t_s), 0.8 * np.sin(1.1 * t_s)])
    lively = Manoeuvre("waves", t_s, waves, at_rest(plant))
    late = with_effects(plant, {DELAY: {"tau": TAU_S, "jitter": jitter_s}})
    return replace(fly_law(late, table, lively), extra={})


@pytest.mark.soak
def test_the_fit_of_a_delay_finds_its_scatter(plant: BoundPlant) -> None:
    # Begun where its score test begins; 1500 readings tell a scatter to some 4 %.
    case = make_case(effect_library(plant), [late_flight(plant, JITTER_S)])
    nominal = nominal_fit(case)
    (seen,) = score_effects(case, linearised(case, nominal), [DELAY])
    begun = rough(case, Proposal(nominal, seen))
    assert begun is not None
    found = refined(case, begun)
    assert found is not None
    values = found.fit.hypothesis.effects[DELAY]
    assert values["tau"] == pytest.approx(TAU_S, rel=0.03)
    assert values["jitter"] == pytest.approx(JITTER_S, rel=0.15)
    assert abs(values["jitter"] - JITTER_S) < 3.0 * jitter_sd(case, found.fit.hypothesis, DELAY) < 0.5 * JITTER_S


def test_a_delay_that_is_known_has_the_scatter_that_its_readings_show(plant: BoundPlant) -> None:
    # Truth: JITTER_S; 1500 readings tell a scatter to some 4 %.
    case = make_case(effect_library(plant), [late_flight(plant, JITTER_S)])
    late = nominal_hypothesis(case, -2.0).with_effects({DELAY: {"tau": TAU_S, "jitter": 0.0}})
    assert with_jitter(case, late, [DELAY]).effects[DELAY]["jitter"] == pytest.approx(JITTER_S, rel=0.15)


@pytest.mark.soak
def test_it_is_found_with_its_scatter(plant: BoundPlant) -> None:
    result = diagnose(plant, Material([late_flight(plant, JITTER_S)], [], [], []))
    assert result.diagnosis.found == (DELAY,)
    found = result.diagnosis.effects[0].parameters
    assert found["tau"].value == pytest.approx(TAU_S, rel=0.03)
    assert found["jitter"].value == pytest.approx(JITTER_S, rel=0.15)
    assert abs(found["jitter"].value - JITTER_S) < 3.0 * found["jitter"].sd < 0.5 * JITTER_S
    assert list(found) == ["tau", "jitter"]


@pytest.mark.soak
def test_a_steady_delay_has_none(plant: BoundPlant) -> None:
    case = make_case(effect_library(plant), [late_flight(plant, 0.0)])
    hypothesis = nominal_fit(case).hypothesis.with_effects({DELAY: {"tau": TAU_S, "jitter": 0.0}})
    assert with_jitter(case, hypothesis, [DELAY]).effects[DELAY]["jitter"] == 0.0
    assert 0.0 < jitter_sd(case, hypothesis, DELAY) < 0.03 * TAU_S


def test_readings_show_at_most_what_they_scatter(plant: BoundPlant) -> None:
    # Truth: motion alone, however fast, shows none. What shows leaves room for scatter that neighbours share, sqrt 5, and for chance.
    def most_s(jitter_s: float) -> float:
        return most_shown_s(make_case(effect_library(plant), [late_flight(plant, jitter_s)]), "psi_rad")

    assert most_s(0.0) == 0.0
    assert JITTER_S < most_s(JITTER_S) < 3.0 * JITTER_S


def test_noise_that_is_the_same_at_all_speeds_is_no_scatter(plant: BoundPlant) -> None:
    # Truth: 2 mrad of noise, twice what 3 ms of scatter would bring at 0.3 rad/s.
    log = late_flight(plant, 0.0)
    noise = 2e-3 * np.random.default_rng(5).standard_normal(log.y.shape)
    assert most_shown_s(make_case(effect_library(plant), [replace(log, y=log.y + noise)]), "psi_rad") == 0.0


def test_an_axis_that_turns_at_one_speed_shows_nothing(plant: BoundPlant) -> None:
    # Truth: without a faster half there is nothing to compare.
    log = late_flight(plant, 0.0)
    steady = np.column_stack([0.5 * log.t_s, log.y[:, 1]])
    assert most_shown_s(make_case(effect_library(plant), [replace(log, y=steady)]), "psi_rad") == 0.0
