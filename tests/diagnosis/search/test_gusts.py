"""Gusts: found with their size and time where the air is restless, not looked for where something else explains the logs."""

from dataclasses import replace

import pytest

from diagnosis.diagnose import Material, _detected, _with_gusts, diagnose
from diagnosis.explain.improved import improved_plant
from diagnosis.fit.evidence import FittedHypothesis, evidence
from diagnosis.fit.nominal import nominal_fit
from diagnosis.hypothesis.case import Case, make_case
from diagnosis.library.effect_library import effect_library
from diagnosis.search.beam import Search
from diagnosis.search.gusts import gust_sd, gusts
from records.log import RunLog
from sim.added_effects import with_effects
from sim.bind import BoundPlant, bind
from tests.diagnosis.conftest import Fly

# Truth: 1 mN m, a fortieth of what such an axis can be pushed with, forgotten in 0.7 s.
GUST = {"elevation.gust": {"sigma": 1e-3, "T": 0.7}}


def alone(plant: BoundPlant, logs: list[RunLog]) -> tuple[Case, FittedHypothesis]:
    case = make_case(effect_library(plant), logs)
    nominal = nominal_fit(case)
    return case, FittedHypothesis((), nominal, evidence(nominal, case.library.effects))


def test_a_gust_is_found_on_its_axis_with_its_numbers(plant: BoundPlant, fly: Fly) -> None:
    # 60 s hold 86 times 0.7 s: the size is known to some 10 %, the time to some 30 %; three such deviations.
    case, nominal = alone(plant, [fly(seed, GUST, rig_seed=90) for seed in (91, 92)])
    found = {entry.effects[0]: entry for entry in gusts(case, nominal)}
    gust = found["elevation.gust"]
    assert gust.evidence > nominal.evidence + 100.0
    assert found["azimuth.gust"].evidence < nominal.evidence
    values = gust.fit.hypothesis.effects["elevation.gust"]
    sd = gust_sd(case, gust.fit.hypothesis, case.library.effects["elevation.gust"])
    for symbol, truth in GUST["elevation.gust"].items():
        assert abs(values[symbol] - truth) < 3.0 * sd[symbol]
    assert 0.02 < sd["sigma"] / values["sigma"] < 0.2
    assert 0.05 < sd["T"] / values["T"] < 0.6


def test_still_air_has_no_gust(plant: BoundPlant, fly: Fly) -> None:
    case, nominal = alone(plant, [fly(93, rig_seed=90)])
    assert all(entry.evidence < nominal.evidence for entry in gusts(case, nominal))


def test_an_axis_that_is_held_feels_no_gust(plant: BoundPlant, fly: Fly) -> None:
    case, nominal = alone(plant, [replace(fly(93, rig_seed=90), locked=("azimuth",))])
    assert [entry.effects for entry in gusts(case, nominal)] == [("elevation.gust",)]


def test_gusts_are_weighed_where_nothing_else_explains_the_logs(plant: BoundPlant, fly: Fly) -> None:
    # Truth: gusts on the elevation, and a search that found nothing.
    seen = _detected(make_case(effect_library(plant), [fly(91, GUST, 20.0, rig_seed=90)]), None)
    nothing = Search((seen.retuned,), seen.retuned, False, seen.linearisation, seen.score_tests)
    found, _, weighed, rules = _with_gusts(seen, nothing, None)
    assert found.fitted[0].effects == ("elevation.gust",)
    assert weighed.fitted[0].effects == ("elevation.gust",)
    told = {rule.rule: rule.outcome for rule in rules if rule.of != "azimuth.gust"}
    assert (told["well_explained"], told["gust_explains"]) == ("gusts asked", "weighed")


@pytest.mark.soak
def test_a_restless_room_is_told_by_no_other_name(plant: BoundPlant, fly: Fly) -> None:
    # Before gusts were asked for, such logs were told as a springy arm beside a push, 0.80 together.
    logs = [fly(seed, GUST, rig_seed=90) for seed in (91, 92)]
    result = diagnose(plant, Material(logs, [], [], [None] * len(logs)))
    assert result.diagnosis.verdict == "gap"
    named = {h.effect: h.probability for h in result.diagnosis.effects}
    assert sum(p for name, p in named.items() if name != "elevation.gust") < 0.05
    assert result.diagnosis.places[0].place == "elevation"


def test_a_gust_that_the_plant_file_states_is_carried_along_and_not_flown_with(plant: BoundPlant, fly: Fly) -> None:
    # Truth: the log has another draw of the air than the plant file.
    stated = with_effects(
        plant, {"azimuth.gust": {"sigma": 5e-4, "T": 1.0}}, sd={"azimuth.gust": {"sigma": 1e-4, "T": 0.3}}
    )
    result = diagnose(stated, Material([fly(94, rig_seed=90)], [], [], [None]))
    assert result.diagnosis.verdict == "no gap"
    kept = bind(result.plant).effects["azimuth.gust"]["sigma"]
    assert (kept.value, kept.sd) == pytest.approx((5e-4, 1e-4))


def test_a_gust_that_is_found_replaces_the_one_that_the_plant_file_states(plant: BoundPlant, fly: Fly) -> None:
    # Truth: the air is four times as restless as the plant file has it, on the same axis; three deviations.
    stated = with_effects(
        plant, {"elevation.gust": {"sigma": 2.5e-4, "T": 0.7}}, sd={"elevation.gust": {"sigma": 1e-4}}
    )
    case = make_case(effect_library(plant), [fly(seed, GUST, rig_seed=90) for seed in (91, 92)], stated=stated)
    nominal = nominal_fit(case)
    found = {
        entry.effects[0]: entry
        for entry in gusts(case, FittedHypothesis((), nominal, evidence(nominal, case.library.effects)))
    }
    sigma = bind(improved_plant(case, found["elevation.gust"].fit)).effects["elevation.gust"]["sigma"]
    assert abs(sigma.values[0] - GUST["elevation.gust"]["sigma"]) < 3.0 * sigma.sds[0] < 6e-4
