"""Seed 001, section 3: from data of the paper's own parameter set, in the order u1, u2, u3, kG, the set comes back.

Outside soaks u1 alone: all four stages are done by the test of `twinlaw identify` on this plant.
"""

from dataclasses import replace

import numpy as np
import pytest

from identification.experiments.table import kinds_of, perform
from identification.experiments.velagic.figures import responses
from identification.fit.belief import NOTHING
from identification.results.result import identification
from identification.search.methods import Search
from identification.stages.staged import AskedOfStage, identify_stage
from records.errors import BadInput
from sim.bind import bind
from tests.plants import bound as plant_of
from tests.soak import SOAK

ALL = ("a_1", "b_1", "B_psi", "tau_G", "I_inv", "a_2", "b_2", "B_phi", "Ic_inv", "a_3", "b_3", "k_G")
HELD = ("tau_G", "B_phi")
OWN = (("a_1", "b_1", "B_psi", "I_inv"), ("a_2", "b_2", "Ic_inv"), ("a_3", "b_3"), ("k_G",))[: 4 if SOAK else 1]


@pytest.fixture(scope="module")
def truth():
    """The paper's set."""
    return plant_of("ce150_velagic")


@pytest.fixture(scope="module")
def elsewhere(truth):
    """What the estimation is given: every free parameter 5 % off, up and down in turn, within the searched ranges."""
    free = [name for name in ALL if name not in HELD]
    return plant_of(
        "ce150_velagic", **{name: truth.parameter(name) * (1.05 if k % 2 else 0.95) for k, name in enumerate(free)}
    )


@pytest.fixture(scope="module")
def records(truth, main_motor):
    later = list(kinds_of("ce150_velagic"))[1 : len(OWN)]
    return [main_motor, *(perform(kind, truth, 1) for kind in later)]


def staged(start, records):
    """The paper's order: genetic search, gradient method beside it, then the fit."""
    stages, belief = [], NOTHING
    for record in records:
        stages.append(
            identify_stage(start, record, belief, AskedOfStage(wanted=Search("genetic", 1, beside=("gradient",))))
        )
        belief = stages[-1].belief
    return stages


@pytest.fixture(scope="module")
def found(elsewhere, records):
    return staged(elsewhere, records)


def test_the_paper_s_set_comes_back(truth, found):
    """Torques, friction and k_G to 0.1 %, the inverse inertias, of which little shows, to 0.6 %; each within 4 of its sd."""
    belief = found[-1].belief
    assert set(belief.names) == {name for names in OWN for name in names}
    for name, value, sd in zip(belief.names, belief.mean, belief.sd, strict=True):
        assert value == pytest.approx(truth.parameter(name), rel=6e-3 if name.endswith("_inv") else 1e-3), name
        assert abs(value - truth.parameter(name)) < 4.0 * sd, name


def test_the_stages_are_the_paper_s(found):
    assert tuple(stage.result.own for stage in found) == OWN


def test_the_genetic_algorithm_alone_comes_near_and_the_gradient_method_nearer(truth, found):
    """Genetic: 0.3 deg in the mean of 3000 readings, within 15 % (inertias 30 %). Gradient: 0.025 deg and 0.1 % (inertias 0.6 %)."""
    for stage in found:
        genetic, gradient = stage.result.searched
        assert (genetic.method, gradient.method) == ("genetic", "gradient")
        assert genetic.error < 0.3 * 3000
        assert gradient.error < 0.025 * 3000
        for name, coarse, fine in zip(genetic.names, genetic.values, gradient.values, strict=True):
            inertia = name.endswith("_inv")
            assert coarse == pytest.approx(truth.parameter(name), rel=0.3 if inertia else 0.15), name
            assert fine == pytest.approx(truth.parameter(name), rel=6e-3 if inertia else 1e-3), name


def test_the_fitness_rises_as_in_fig_6(found):
    """Fig. 6 runs from 8.4e4 to 9.6e4 in 150 generations; without the paper's model errors it ends higher."""
    genetic = found[0].result.searched[0]
    assert len(genetic.best) == 150
    assert 8.4e4 < genetic.best[0] < 9.6e4 < genetic.best[-1] < 1e5
    assert genetic.best[-1] == pytest.approx(1e5 - genetic.error)


def test_all_five_of_u1_are_known_by_ratios_alone_and_that_direction_is_named(truth, elsewhere, records):
    """With tau_G free as in the paper: every torque over tau_G to 0.1 %, tau_G itself not told."""
    stage = identify_stage(
        elsewhere, records[0], NOTHING, AskedOfStage(free=ALL)
    )  # from where it starts: no search is asked about
    belief = stage.belief
    assert set(belief.names) == {"a_1", "b_1", "B_psi", "tau_G", "I_inv"}
    for name in ("a_1", "b_1", "B_psi"):
        ratio = truth.parameter(name) / truth.parameter("tau_G")
        assert belief.value(name) / belief.value("tau_G") == pytest.approx(ratio, rel=1e-3), name
    product = truth.parameter("I_inv") * truth.parameter("tau_G")
    assert belief.value("I_inv") * belief.value("tau_G") == pytest.approx(product, rel=6e-3)
    result = identification(elsewhere.plant, [("u1", stage.result)], belief)
    assert any("direction" in note and "tau_G" in note and "I_inv" in note for note in result.notes)
    assert belief.sd[belief.names.index("tau_G")] > 0.1 * belief.value("tau_G")


@pytest.mark.soak
def test_figs_12_to_14_of_the_found_plant_are_the_rig_s(truth, elsewhere, found):
    """0.05 deg rms in each; the plant that it began with misses the azimuth of Figs. 13 and 14 by degrees."""
    stages = [(stage.kind, stage.result) for stage in found]
    plant = bind(identification(elsewhere.plant, stages, found[-1].belief).plant)
    shown, before = responses(truth, plant), responses(truth, elsewhere)
    assert list(shown) == ["12a", "12b", "13a", "13b", "14"]
    for number, response in shown.items():
        assert np.degrees(response.rms_rad) < 0.05, number
        assert number.startswith("12") or np.degrees(before[number].rms_rad) > 1.0, number
    lifted = shown["12a"].u_MU[np.argmax(shown["12a"].measured_rad > np.radians(-44.5)), 0]
    assert 0.44 < lifted < 0.47  # "almost no change in the range of [0, 0.47]"


def test_a_record_of_an_unfixed_azimuth_is_refused_for_u1(elsewhere, records):
    with pytest.raises(BadInput, match="locked axes"):
        identify_stage(elsewhere, replace(records[0], locked=()), NOTHING)


def test_an_experiment_of_another_plant_is_refused(elsewhere, records):
    with pytest.raises(BadInput, match="plant"):
        identify_stage(elsewhere, replace(records[0], plant="emps"), NOTHING)
