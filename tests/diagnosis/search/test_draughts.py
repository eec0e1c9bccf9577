"""A torque that comes and goes: noise of every hypothesis, with its size and time, told as a gust where it is the whole gap."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis.diagnose import Material, diagnose
from diagnosis.explain.improved import improved_plant
from diagnosis.fit.coloured_noise import colour_sd
from diagnosis.fit.evidence import FittedHypothesis, as_fitted
from diagnosis.hypothesis.case import Case, make_case
from diagnosis.library.effect_library import effect_library
from diagnosis.search.draughts import draught, knocks, white_shares
from records.log import RunLog
from sim.added_effects import with_effects
from sim.bind import BoundPlant, bind
from sim.effects.gust import SINES, TURN
from tests.diagnosis.conftest import LONG_S, Fly
from tests.diagnosis.nominal import nominal_fit
from tests.soak import SOAK

# Truth: 3 mN m, 0.075 of what such an axis can be pushed with and nearly twice what is told as a gust, forgotten in 0.7 s. Every flight has
# the same draw of it (sim/effects/gust.py eq (1)), whose own size and time in so few seconds are what a flight can tell.
FLIGHTS = (91, 92) if SOAK else (91,)
GUST = {"elevation.gust": {"sigma": 3e-3, "T": 0.7}}


def drawn() -> dict[str, float]:
    """Standard deviation and correlation time of the draw in LONG_S, as those of the first-order process that it looks like."""
    sigma, T = GUST["elevation.gust"].values()
    t_s = np.arange(0.0, LONG_S, 0.01)
    i = np.arange(SINES)
    omega = np.tan(np.pi / 2 * (i + 0.5) / SINES) / T
    g = sigma * np.sqrt(2.0 / SINES) * np.cos(np.outer(t_s, omega) + i * float(TURN)).sum(axis=1)
    kept = float(g[1:] @ g[:-1] / (g[:-1] @ g[:-1]))
    return {"sigma": float(np.sqrt(np.mean(g**2))), "T": -0.01 / float(np.log(kept))}


def alone(plant: BoundPlant, logs: list[RunLog]) -> tuple[Case, FittedHypothesis]:
    case = make_case(effect_library(plant), logs)
    return case, as_fitted(case, nominal_fit(case))


@pytest.mark.soak
def test_a_gust_is_noise_of_its_axis_with_its_numbers(plant: BoundPlant, fly: Fly) -> None:
    # The draw's own size within three deviations of what is known of it, its time to a factor of two: sines are a process of first order
    # only in the mean of many draws.
    case, nominal = alone(plant, [fly(seed, GUST, LONG_S, rig_seed=90) for seed in FLIGHTS])
    assert nominal.effects == ()
    found, _ = draught(case, nominal)
    assert found is not None
    assert found.gusty.effects == ("elevation.gust",)
    assert found.gusty.evidence > found.quiet.evidence + 100.0
    values = nominal.fit.hypothesis.effects["elevation.gust"]
    sd = colour_sd(case, nominal.fit.hypothesis, case.library.effects["elevation.gust"])
    truth = drawn()
    assert abs(values["sigma"] - truth["sigma"]) < 3.0 * sd["sigma"]
    assert 0.5 < values["T"] / truth["T"] < 2.0
    assert 0.02 < sd["sigma"] / values["sigma"] < 0.2
    assert 0.05 < sd["T"] / values["T"] < 0.6


def test_still_air_has_no_gust(plant: BoundPlant, fly: Fly) -> None:
    case, nominal = alone(plant, [fly(93, rig_seed=90)])
    assert draught(case, nominal)[0] is None
    assert knocks(case, nominal)[0] is None
    assert max(white_shares(case, nominal.fit.hypothesis).values()) < 0.01


def test_an_arm_that_is_knocked_about_is_told_as_a_gust_of_the_shortest_memory(plant: BoundPlant, fly: Fly) -> None:
    # Truth: knocks without any memory, w = 0.2 rad/s per sqrt(s) on both axes, sigma = J w / sqrt(2 T) with T = 0.03 s. To a quarter: J is
    # drawn from its stated spread, noise is known to some per cent. The axes' usual torque is 0.04 N m.
    case, nominal = alone(plant, [fly(93, gusts=200.0, rig_seed=90)])
    assert nominal.effects == ()
    assert not any(case.library.effects[name].is_noise for name in nominal.fit.hypothesis.effects)
    shares = white_shares(case, nominal.fit.hypothesis)
    truth = {
        axis: plant.parameter(J) * 0.2 / np.sqrt(2 * 0.03) / 0.04
        for axis, J in (("elevation", "J_E"), ("azimuth", "J_A"))
    }
    assert shares == pytest.approx({f"{axis}.gust": share for axis, share in truth.items()}, rel=0.25)
    assert draught(case, nominal) == (None, ())
    found, rules = knocks(case, nominal)
    assert found is not None
    (name,) = found.gusty.effects
    assert rules[0].outcome == "a gust"
    values = found.gusty.fit.hypothesis.effects[name]
    assert values["T"] == 0.03
    assert values["sigma"] == pytest.approx(shares[name] * 0.04, rel=0.2)
    assert found.gusty.evidence > found.quiet.evidence + 100.0


@pytest.mark.soak
def test_an_axis_that_is_held_feels_no_gust(plant: BoundPlant, fly: Fly) -> None:
    # Truth: the air pushes the elevation, which is held.
    _, nominal = alone(plant, [replace(fly(93, GUST, 10.0, rig_seed=90), locked=("elevation",))])
    assert "elevation.gust" not in nominal.fit.hypothesis.effects


@pytest.mark.soak
def test_a_restless_room_is_told_by_no_other_name(plant: BoundPlant, fly: Fly) -> None:
    logs = [fly(seed, GUST, LONG_S, rig_seed=90) for seed in (91, 92)]
    result = diagnose(plant, Material(logs, [], [], [None] * len(logs)))
    assert result.diagnosis.verdict == "gap"
    named = {h.effect: h.probability for h in result.diagnosis.effects}
    assert sum(p for name, p in named.items() if name != "elevation.gust") < 0.05
    assert result.diagnosis.places[0].place == "elevation"


@pytest.mark.soak
def test_a_gust_that_the_plant_file_states_is_carried_along_and_not_flown_with(plant: BoundPlant, fly: Fly) -> None:
    # Truth: the log has another draw of the air than the plant file.
    stated = with_effects(
        plant, {"azimuth.gust": {"sigma": 5e-4, "T": 1.0}}, sd={"azimuth.gust": {"sigma": 1e-4, "T": 0.3}}
    )
    result = diagnose(stated, Material([fly(94, rig_seed=90)], [], [], [None]))
    assert result.diagnosis.verdict == "no gap"
    kept = bind(result.plant).effects["azimuth.gust"]["sigma"]
    assert (kept.value, kept.sd) == pytest.approx((5e-4, 1e-4))


@pytest.mark.soak
def test_a_gust_that_is_found_replaces_the_one_that_the_plant_file_states(plant: BoundPlant, fly: Fly) -> None:
    # Truth: the air is four times as restless as the plant file has it, on the same axis; three deviations.
    stated = with_effects(
        plant, {"elevation.gust": {"sigma": 3.75e-4, "T": 0.7}}, sd={"elevation.gust": {"sigma": 1.5e-4}}
    )
    case = make_case(effect_library(plant), [fly(91, GUST, LONG_S, rig_seed=90)], stated=stated)
    found, _ = draught(case, as_fitted(case, nominal_fit(case)))
    assert found is not None
    sigma = bind(improved_plant(case, found.gusty)).effects["elevation.gust"]["sigma"]
    assert abs(sigma.values[0] - drawn()["sigma"]) < 3.0 * sigma.sds[0] < 9e-4
