"""The nine experiments of the paper, stage by stage: the truth comes back within its intervals, and what is wrong is told by parameter."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import binom

from identification.experiments.ce150 import swings
from identification.experiments.ce150.rig import Setup
from identification.experiments.table import KINDS, informed, perform
from identification.fit.belief import NOTHING
from identification.proof.linear_rotor import linear_rotor
from identification.proof.monte_carlo import coverage, judged, other_rig, repetition
from identification.proof.validation import compare_flights
from identification.results.facts import facts
from identification.results.result import identification
from identification.runs.prediction import blocks
from identification.stages.staged import identify_stage, identify_staged
from identification.uncertainty.residuals import residual_tests
from records.errors import BadInput
from records.experiment import load_experiment, save_experiment
from sim.bind import bind
from tests.angles import few_angles
from tests.identification.conftest import SEED
from tests.soak import SOAK


def test_the_paper_s_27_parameters_are_estimated_once_all_nine_are_done(stages):
    assert len(informed("ce150")) == 27
    assert set(stages[-1].belief.names) == set(informed("ce150"))
    matrix = stages[-1].belief.correlation
    assert np.linalg.eigvalsh(matrix)[0] > -1e-9


def test_few_parameters_lie_outside_their_95_per_cent_intervals(bound, truth, stages):
    """27 parameters of one rig or three: were the intervals true and the parameters independent, more were outside in one of 10^4.

    Parameters of one polynomial leave together, which the generous bound allows for.
    """
    found = (judged(SEED, truth, stages), *(repetition(bound, seed) for seed in ((11, 12) if SOAK else ())))
    outside = sum(not inside for entry in found for inside in entry.inside.values())
    assert outside <= binom.ppf(1 - 1e-4, len(found) * 27, 0.05)
    assert set(coverage(found)) == set(informed("ce150"))
    errors = [abs(entry.value[name] / entry.truth[name] - 1.0) for entry in found for name in ("J_E", "J_A", "K_A")]
    assert max(errors) < 5e-3


def test_another_seed_is_another_rig_and_the_same_seed_the_same_readings(bound, truth, experiments):
    again = perform("turned_by_hand", truth, 3).streams["motion"]
    for name, column in experiments["turned_by_hand"].streams["motion"].items():
        np.testing.assert_array_equal(again[name], column)
    assert other_rig(bound, 4).parameter("J_E") != truth.parameter("J_E")


def test_an_experiment_reads_back_as_it_was_saved(tmp_path, experiments):
    for kind, experiment in experiments.items():
        save_experiment(tmp_path / f"{kind}.toml", experiment)
        found = load_experiment(tmp_path / f"{kind}.toml")
        assert (found.kind, found.mount, found.locked) == (kind, experiment.mount, experiment.locked)
        assert found.facts == experiment.facts
        for name, stream in experiment.streams.items():
            for column, values in stream.items():
                np.testing.assert_array_equal(found.streams[name][column], values)


def test_speeds_are_right_whatever_the_clocks_of_board_and_oscilloscope(bound, truth, experiments):
    """The same pulses on a clock that is three seconds further on give the same readings once both know the common pulse."""
    first = experiments["main_rotor"]
    pulses = {"pulse_s": first.streams["photogate"]["pulse_s"] + 3.0}
    moved = replace(
        first,
        facts={**first.facts, "sync_scope_s": first.facts["sync_scope_s"] + 3.0},
        streams={**first.streams, "photogate": pulses},
    )
    own, other = (KINDS["main_rotor"].run(entry, bound) for entry in (first, moved))
    np.testing.assert_allclose(own.y, other.y, atol=1e-6)
    speeds = own.y[own.channel == 0]
    assert 300.0 < speeds.max() < 650.0


def test_the_polynomial_rotor_wins_against_the_manual_s_linear_one(bound, experiments, stages):
    """Figs. 7 and 8: smaller residuals in speed and thrust, for both rotors."""
    for stage in stages[:2]:
        linear = linear_rotor(KINDS[stage.kind].run(experiments[stage.kind], bound))
        for own, straight in zip(stage.result.residuals, linear.residuals, strict=True):
            assert straight.rms > 5.0 * own.rms


def test_the_weights_give_the_gravity_torque_and_a_centre_of_gravity_on_the_arm(truth, stages):
    gravity = next(stage for stage in stages if stage.kind == "gravity")
    place = gravity.belief.names.index("tau_gE")
    assert abs(gravity.belief.mean[place] - truth.parameter("tau_gE")) < 3.0 * gravity.belief.sd[place]
    assert gravity.belief.sd[place] < 5e-3 * truth.parameter("tau_gE")
    off = gravity.aids.names.index("Psi_m")
    assert abs(gravity.aids.mean[off]) < 3.0 * gravity.aids.sd[off]


def test_encoder_residuals_of_a_right_model_are_those_of_rounding(stages):
    for stage in stages:
        if stage.kind in ("elevation_swing", "azimuth_oscillation"):
            (test,) = stage.result.residuals
            assert test.rms == pytest.approx(test.floor, rel=0.05)
            assert test.white


def test_a_wrong_model_leaves_residuals_that_are_not_white(bound, experiments):
    run = KINDS["azimuth_oscillation"].run(experiments["azimuth_oscillation"], bound)
    p = run.bound.p.copy()
    p[[str(symbol) for symbol in run.bound.model.parameter_symbols].index("J_A")] *= 1.2
    (test,) = residual_tests(run, blocks(replace(run, bound=replace(run.bound, p=p)), (), np.zeros(0)))
    assert not test.white


def test_a_record_of_the_wrong_mount_is_refused_by_what_it_says(bound, experiments):
    record = replace(experiments["elevation_swing"], mount="upright")
    with pytest.raises(BadInput, match=r"elevation_swing: mount: got 'upright', expected 'turned'; .*J_E, b_vE, b_cE"):
        identify_stage(bound, record, NOTHING)


@pytest.mark.parametrize(
    ("kind", "words"),
    [
        ("azimuth_swing", "no stretch in which the axis moves"),
        ("elevation_swing", "a motion as on the mount 'upright'"),
    ],
)
def test_a_record_of_the_wrong_mount_is_refused_by_what_it_shows(monkeypatch, bound, truth, stages, kind, words):
    """Recorded upright, where nothing pulls the azimuth back and the arm falls, but labelled as turned."""
    monkeypatch.setattr(swings, "Setup", lambda **given: Setup(**{**given, "turned": 0.0, "mount_rad": 0.0}))
    record = perform(kind, truth, 5)
    belief = next(stage.belief for stage in stages if stage.kind == "gravity")
    with pytest.raises(BadInput, match=words):
        identify_stage(bound, record, belief)


def test_unlocked_axes_and_other_plants_are_refused(bound, experiments):
    record = experiments["elevation_steps"]
    with pytest.raises(BadInput, match="locked axes"):
        identify_stage(bound, replace(record, locked=()), NOTHING)
    with pytest.raises(BadInput, match="plant: got 'quanser_aero'"):
        identify_stage(bound, replace(record, plant="quanser_aero"), NOTHING)


def test_an_arm_without_its_weights_is_known_by_ratios_alone(bound, experiments):
    """Without experiment 3 a swing tells J_E, b_vE, b_cE and tau_gE by their ratios; that direction is named."""
    stages = identify_staged(bound, [experiments["elevation_swing"]])
    result = identification(bound.plant, [("swing", stages[0].result)], stages[0].belief)
    assert any("direction" in note and "J_E" in note and "tau_gE" in note for note in result.notes)
    told = facts(result)
    assert told["stages"][0]["not_identifiable"][0]["relative_sd"] > 0.5


def test_the_controller_designed_from_the_result_flies_the_rig(monkeypatch, bound, truth, stages):
    """V1 and V2: flown by the same controller, rig and identified plant stay within a degree of one another."""
    few_angles(monkeypatch)
    result = identification(bound.plant, [(stage.kind, stage.result) for stage in stages], stages[-1].belief)
    few = replace(result.plant, design={**result.plant.design, "operating_points": 17 if SOAK else 5})
    compared = compare_flights(bind(few), truth)
    assert compared.rms["psi_rad"] < np.radians(0.5)
    assert compared.rms["phi_rad"] < np.radians(0.5)
