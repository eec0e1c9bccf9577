"""The benchmark's own rig is the CE150 of the published facts, and free of effects it is the project's plant."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from blind.rigs.first.pilot import rotor_slope
from blind.rigs.first.simulation import BRISTLES, FASTEST_RAD_S, PROGRAM
from blind.simulation.ce150 import Rig, draw_rig, restated, stated_zero
from blind.simulation.flight import predict
from blind.simulation.record import Record
from blind.simulation.rest import rest
from records.plant import load_plant
from sim.bind import bind
from sim.simulate import Conditions, simulate
from tests.blind.conftest import PLANT, calm_flight, lively_flight

STATES = ("psi_rad", "psi_dot_rad_s", "phi_rad", "phi_dot_rad_s", "omega_M_rad_s", "omega_T_rad_s")
MAIN_REST_V = {-40: 4.859, -30: 5.191, -20: 5.424, -10: 5.562, 0: 5.607}


@pytest.mark.parametrize(("elevation_deg", "expected_V"), MAIN_REST_V.items())
def test_rest_voltages_are_the_published_ones_within_a_millivolt(
    rig: Rig, elevation_deg: int, expected_V: float
) -> None:
    volts, _ = rest(rig, np.deg2rad(elevation_deg), FASTEST_RAD_S)
    assert volts[0] == pytest.approx(expected_V, abs=1e-3)
    assert rest(rig, -np.deg2rad(elevation_deg), FASTEST_RAD_S)[0][0] == pytest.approx(expected_V, abs=1e-3)
    assert 1.80 <= volts[1] <= 1.97


def test_the_arm_leaves_the_lower_stop_at_the_published_voltage(rig: Rig) -> None:
    assert rest(rig, -np.pi / 4, FASTEST_RAD_S)[0][0] == pytest.approx(4.653, abs=2e-3)


def test_rotor_time_constants_at_hover_are_the_published_ones(rig: Rig) -> None:
    _, speeds = rest(rig, 0.0, FASTEST_RAD_S)
    assert 1.0 / rig.value("p_bM") == pytest.approx(0.333, abs=1e-3)
    assert 6.6 <= rotor_slope(rig, "M", speeds[0])[0] <= 10.0


def test_a_step_to_rest_holds_the_angle_and_the_published_voltage(flown: Callable[..., Record]) -> None:
    record = flown(calm_flight(8.0, np.deg2rad(-30.0)), {})
    assert np.abs(record.y_rad[-200:, 0] + np.deg2rad(30.0)).max() < 4e-3
    assert record.u_V[-200:, 0].mean() == pytest.approx(MAIN_REST_V[-30], abs=0.01)


def test_without_effects_it_is_the_projects_plant_far_below_one_encoder_count(flown: Callable[..., Record]) -> None:
    """Free 1 s runs from the same states: bristles at 100 us against located Coulomb friction, RMS below a third of the floor."""
    record = flown(lively_flight(20.0), {})
    bound = bind(load_plant(PLANT))
    states = [str(state) for state in bound.model.states]
    order = [states.index(name) for name in STATES]
    misses = []
    for first in range(0, len(record.t_s), 100):
        rows = slice(first, first + 100)
        x0 = np.empty(6)
        x0[order] = record.apparent[first]
        runs = simulate(bound, record.t_s[rows], x0, record.u_V[rows], Conditions(resolution=[0.0, 0.0], substeps=4))
        misses.append(runs.y - record.exact_rad[rows])
    rms = np.sqrt(np.mean(np.concatenate(misses) ** 2, axis=0))
    assert np.all(rms < 1.5e-4), rms


def test_the_shadow_of_the_rig_itself_repeats_it_exactly_in_still_air(flown: Callable[..., Record]) -> None:
    hidden = {("play_V", 1): 0.3, ("sensor_delay_s", 0): 0.02, ("cable_Nm_rad", 1): 5e-3, ("cable_slip_rad", 1): 0.2}
    record = flown(lively_flight(5.0), hidden)
    np.testing.assert_array_equal(record.shadow[:, 0], record.exact_rad)


def test_the_coarse_prediction_used_for_the_retune_follows_the_fine_one(rig: Rig, flown: Callable[..., Record]) -> None:
    record = flown(lively_flight(10.0), {})
    assert np.abs(predict(PROGRAM, rig, BRISTLES, record, 5e-4) - record.shadow[:, 1]).max() < 4e-3


def test_drawn_parameters_stay_within_two_and_a_half_sd_and_friction_stays_positive(rig: Rig) -> None:
    for seed in range(40):
        drawn = draw_rig(rig, np.random.default_rng(seed))
        for name, value in drawn.values.items():
            assert np.all(np.abs(value - rig.values[name]) <= 2.5 * rig.sds[name] + 1e-15) or name.startswith("b_c")
        assert drawn.value("b_cE") > 0.0


def test_an_absent_friction_is_stated_as_zero_and_the_file_stays_a_plant(tmp_path: Path) -> None:
    path = tmp_path / "plant.toml"
    path.write_text(restated(PLANT.read_text(), stated_zero(["b_cA"])))
    plant, stated = load_plant(path), load_plant(PLANT)
    assert plant.parameters["b_cA"].value == plant.parameters["b_cA"].sd == 0.0
    assert plant.parameters["b_cE"] == stated.parameters["b_cE"]
