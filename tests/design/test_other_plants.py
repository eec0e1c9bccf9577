"""Designs for plants that are no helicopter: one to three states an axis, integrating, unstable, coupled, with and without a schedule."""

from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from design.report import DesignReport
from design.settings import read_settings
from design.table import design
from records.errors import BadInput
from records.plant import load_plant
from records.table import ControllerTable
from sim.bind import BoundPlant, bind
from sim.manoeuvres import steps
from tests.angles import few_angles
from tests.other_plants import AEROSHIELD, INVERTED_ARM, MOTOR, QUANSER, written
from tests.own_plants import CART_POLE, FREE_SWING, FROM_THE_MAGNET, HEATER, MAGNET, PLAIN
from tests.soak import SOAK

MAGNET_WISHES: dict[str, Any] = {
    "sample_period_s": 0.0005,
    "ball": {
        "poles_rad_s": [-60, -70, -80, -90, -300, -350],
        "prefilter_time_constant_s": 0.1,
        "reference_min_m": -0.002,
        "reference_max_m": 0.002,
    },
}


@cache
def plant(name: str) -> BoundPlant:
    return bind(load_plant(Path("plants") / f"{name}.toml"))


@pytest.fixture(autouse=True)
def angles(monkeypatch: pytest.MonkeyPatch) -> None:
    """Reports at few angles, in a soak at all."""
    if not SOAK:
        few_angles(monkeypatch)


def designed(bound: BoundPlant, wishes: dict[str, Any]) -> tuple[ControllerTable, DesignReport]:
    wished = bind(replace(bound.plant, design=wishes))
    return design(wished, read_settings(wished))


def test_an_arm_with_a_propeller_is_scheduled_by_its_own_angle() -> None:
    table, report = designed(plant("aeroshield"), AEROSHIELD)
    (arm,) = report.axes
    assert (table.schedule.axis, table.order, len(table.loops)) == ("arm", 2, 1)
    assert arm.after_rounding.worst_rad_s == pytest.approx(-4.0, abs=0.1)
    assert table.axes[0].p[0] == (0.0, 0.0, 0.0)  # integral action, exactly
    assert table.axes[0].feedforward_V[1] > 0.0


def test_two_rotors_that_both_push_both_axes_keep_their_coupled_margin() -> None:
    """Truth: RGA of the static gains = 1/(1 + Ktt Kmp / (Kmt Ktp)) = 0.576, the same at each angle where both speeds are equal."""
    value = {name: entry.values[0] for name, entry in plant("quanser_aero").plant.parameters.items()}
    relative_gain = 1.0 / (1.0 + value["Ktt"] * value["Kmp"] / (value["Kmt"] * value["Ktp"]))
    table, report = designed(plant("quanser_aero"), QUANSER)
    assert [loop.axis for loop in table.loops] == ["pitch", "yaw"]
    assert [found.relative_gain[0] for found in report.coupling] == pytest.approx([relative_gain] * 9, rel=1e-6)
    assert report.coupled.stable


def test_the_other_pairing_of_these_rotors_is_refused_by_its_relative_gain() -> None:
    exchanged = {
        **QUANSER,
        "pitch": {**QUANSER["pitch"], "input": "u_T_V"},
        "yaw": {**QUANSER["yaw"], "input": "u_M_V"},
    }
    with pytest.raises(BadInput, match=r"relative gain from u_T_V to theta_rad: got 0\.42.*pair the loops otherwise"):
        designed(plant("quanser_aero"), exchanged)


def test_a_helicopter_whose_rotors_turn_both_axes_is_refused_by_its_relative_gain() -> None:
    """Truth: the coupled loop has a pole at +1.8 rad/s there, with each axis' own margins in order; two rotor lags make four states."""
    poles = {
        "elevation": {"poles_rad_s": [-3, -4.5, -8, -10, -12, -15, -16, -20]},
        "azimuth": {"poles_rad_s": [-2.5, -3, -4, -4.5, -5, -7, -20, -24]},
    }
    with pytest.raises(
        BadInput, match=r"elevation at psi = -35\.0 deg: relative gain from u_M_V to psi_rad: got -1\.14"
    ):
        designed(plant("ce150_velagic"), {**poles, "coefficient_degree": 4})


def test_loops_whose_coupling_leaves_no_margin_are_refused_in_words() -> None:
    tight = {**QUANSER, "margins": {"max_sensitivity": 2.0}}
    with pytest.raises(BadInput, match=r"coupled margin.*with the other loops closed"):
        designed(plant("quanser_aero"), tight)


def test_a_motor_of_three_states_integrates_without_a_schedule(tmp_path: Path) -> None:
    table, report = designed(written("motor", tmp_path), MOTOR)
    assert (table.schedule, table.order, table.axes[0].feedforward_V) == (None, 3, (0.0,))
    assert report.axes[0].after_rounding.worst_rad_s == pytest.approx(-8.0, abs=0.5)


def test_an_arm_that_stands_on_its_hinge_is_held(tmp_path: Path) -> None:
    """Truth: the open loop has a pole to the right of 0, the closed one none."""
    bound = written("inverted_arm", tmp_path)
    table, report = designed(bound, INVERTED_ARM)
    assert report.axes[0].after_rounding.worst_rad_s < -2.0
    assert report.axes[0].worst_margins.gain_down > 0.0  # an unstable plant falls with too little gain
    assert table.order == 2


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            {"arm": {"poles_rad_s": [-4, -5, -6, -7, -8, -9]}},
            r"arm at theta = 5\.7 deg: poles: got 6 poles of a loop of 2 states",
        ),
        ({"arm": {"poles_rad_s": [-4, -5, -6, -7], "output": "psi_rad"}}, r"output 'psi_rad'.*theta_rad"),
        ({"schedule": "psi_rad"}, r"schedule: got 'psi_rad'.*theta_rad"),
        ({"theta_max_rad": 1.5}, r"input u_V.*V needed to rest there"),
    ],
)
def test_what_cannot_be_designed_is_one_line_that_names_it(change: dict[str, Any], message: str) -> None:
    with pytest.raises(BadInput, match=message) as caught:
        designed(plant("aeroshield"), {**AEROSHIELD, **change})
    assert "\n" not in str(caught.value)


def test_a_ball_under_a_magnet_is_held_without_a_word_about_margins(tmp_path: Path) -> None:
    """Truth: it falls by e in 1/44 s, so that no controller stands 20 ms more; designed at 0.5 ms, it stands the two samples."""
    table, report = designed(bind(load_plant(MAGNET.write(tmp_path, "magnet"))), MAGNET_WISHES)
    assert (table.order, table.sample_period_s) == (3, 0.0005)
    assert 0.001 < report.axes[0].worst_margins.delay_s < 0.02


def test_a_loop_whose_references_do_not_reach_0_rests_in_their_middle(tmp_path: Path) -> None:
    """Truth: 10 mm below the magnet C i^2 / z^2 = m g takes i = z sqrt(m g / C) = 1.0131 A and R i = 10.131 V."""
    away = {**MAGNET_WISHES["ball"], "reference_min_m": 0.008, "reference_max_m": 0.012}
    bound = bind(load_plant(FROM_THE_MAGNET.write(tmp_path, "magnet")))
    table, _ = designed(bound, {**MAGNET_WISHES, "ball": away})
    assert table.axes[0].feedforward_V[0] == pytest.approx(10.131, abs=1e-3)
    with pytest.raises(BadInput, match=r"plant 'magnet' at 0 m: equilibrium"):
        designed(bound, MAGNET_WISHES)


def test_a_slow_plant_is_given_the_time_to_arrive(tmp_path: Path) -> None:
    """Truth: eight time constants of 50 s of its slowest pole and twice 40 s of its filter make 1040 s a hold, of which there are four."""
    wishes = {
        "poles_rad_s": [-0.02, -0.03],
        "prefilter_time_constant_s": 40.0,
        "reference_min_K": 5.0,
        "reference_max_K": 40.0,
    }
    bound = bind(load_plant(HEATER.write(tmp_path, "oven")))
    table, _ = designed(bound, {"sample_period_s": 0.05, "body": wishes})
    assert steps(bound, table).t_s[-1] == pytest.approx(4 * 1040.0)


def test_a_plant_without_an_input_has_no_loop_and_is_told_so(tmp_path: Path) -> None:
    swing = bind(load_plant(FREE_SWING.write(tmp_path, "swing")))
    told = r"design: loops: got equations of swing without an input, .*`twinlaw simulate` shows"
    for wishes in ({}, {"arm": {"poles_rad_s": [-4, -5, -6, -7]}}):
        with pytest.raises(BadInput, match=told):
            designed(swing, wishes)


def test_equations_that_change_with_the_time_have_no_loop_and_are_told_so(tmp_path: Path) -> None:
    """Truth: of a motor that grows warm over 10 s a law would be placed, and its margins told, as it is at 0 s, where it has no thrust."""
    fading = replace(PLAIN, body=PLAIN.body.replace('p["K"] * u', 'p["K"] * u * (1 - sympy.exp(-TIME / 10))'))
    file = fading.write(tmp_path, "fading")
    equations = file.parent / "fading.py"
    equations.write_text(equations.read_text().replace("from sim.model import ", "from sim.model import TIME, "))
    with pytest.raises(BadInput, match=r"design: loops: got equations of fading that change with the time t_s"):
        designed(bind(load_plant(file)), {"arm": {"poles_rad_s": [-4, -5, -6, -7]}})


def test_of_several_outputs_one_is_asked_for(tmp_path: Path) -> None:
    cart = bind(load_plant(CART_POLE.write(tmp_path, "cart")))
    with pytest.raises(
        BadInput, match=r"design\.pole: key 'output': got nothing, expected one of x_m, theta_rad, tip_m; write"
    ):
        designed(cart, {"pole": {"poles_rad_s": [-4, -5, -6, -7]}})


def test_a_loop_called_as_a_keyword_is_refused_where_it_stands() -> None:
    with pytest.raises(BadInput, match=r"design\.register\.axis: name: got 'register', in C 'register', a word of"):
        designed(plant("aeroshield"), {"register": AEROSHIELD["arm"]})


def test_a_loop_of_a_current_by_a_duty_is_asked_for_its_range_in_its_own_unit() -> None:
    with pytest.raises(BadInput, match=r"design.coil: key 'reference_min_A': got nothing"):
        read_settings(bind(replace(plant("maglev_coil").plant, design={"coil": {"poles_rad_s": [-1.0, -2.0]}})))


def test_wishes_left_out_are_those_of_the_model_s_own_file(tmp_path: Path) -> None:
    """Truth: plants/aeroshield.toml; equations of one's own have no such file, and name their poles."""
    stated = read_settings(plant("aeroshield"))
    left_out = {**AEROSHIELD, "arm": {}}
    assert read_settings(bind(replace(plant("aeroshield").plant, design=left_out))) == stated
    with pytest.raises(BadInput, match="'poles_rad_s'"):
        designed(written("motor", tmp_path), {**MOTOR, "shaft": {}})


def test_degrees_without_a_schedule_are_refused(tmp_path: Path) -> None:
    with pytest.raises(BadInput, match="nothing is scheduled"):
        designed(written("motor", tmp_path), {**MOTOR, "coefficient_degree": 2})


def test_gains_that_vanish_at_rest_are_refused(tmp_path: Path) -> None:
    """Quanser's rotors push by the square of their voltage: level, at 0 V, neither moves anything."""
    level = {**QUANSER, "theta_min_rad": -0.2}
    with pytest.raises(BadInput):
        designed(plant("quanser_aero"), level)
