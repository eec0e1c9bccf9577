"""PID and LQG of plants that are no helicopter: designed, equal in all bits, flown with their references, told in their own units."""

import json
from dataclasses import replace
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pytest

from controllers import loading, pid_tuning
from controllers.lqg_gains import Share, wished_speeds
from controllers.settling import demand_settling
from controllers.table import CONTROLLERS
from design.settings import read_settings
from design.table import design
from records.errors import BadInput
from records.plant import load_plant
from records.quality import OVERSHOOT
from rig.emulator.board import EmulatedBoard
from rig.flight.target_law import TargetLaw
from rig.programming.image import build_firmware
from sim.bind import BoundPlant, bind
from sim.tracking import left
from tests.other_plants import plant_file
from tests.own_plants import HEATER, PLAIN, TWO_ALIKE, OwnPlant
from tests.soak import SOAK, sampled
from twinlaw.workflows.chain.flying import fly_double, fly_host
from twinlaw.workflows.new_plant import plant_texts
from verification.comparison.conditions import spread
from verification.comparison.flights import flown_law, fly_plan
from verification.comparison.manoeuvres import figures, spread_figure
from verification.equality import compare
from verification.host_law import HostLaw
from verification.stimuli import standard_stimuli

NAMES = ("pid", "lqg")
PLANTS = ("aeroshield", "quanser_aero", "motor", "inverted_arm", "heater")
# A PID a loop leaves quanser_aero's two, which push each other's axes, unstable together.
DESIGNED = [(name, of) for of in PLANTS for name in NAMES if (name, of) != ("pid", "quanser_aero")]
STEPS = 100_000 if SOAK else 5_000
TARGET_STEPS = 100_000 if SOAK else 300


CHAIN = OwnPlant(
    {"m": (1.0, 0.1, "kg")},
    {"x_m": 1e-5},
    """
X, V, F, G, U = symbol("x_m"), symbol("v_m_s"), symbol("f_N"), symbol("g_N_s"), symbol("u_N_s2")
return Model(
    name="NAME", states=(X, V, F, G), inputs=(U,), outputs={"x_m": X}, parameters=PARAMETERS,
    rates={X: V, F: G, G: U},
    axes=(Axis("cart", X, V, p["m"], F, sympy.Integer(0), None, None),),
    input_limits={U: (-100, 100)},
    places=Places(
        inputs={"input": InputPlace(U, "N s^-2", 10.0)},
        axes={"cart": AxisPlace("x_m", "N", 1.0)},
        sensors={"x_sensor": SensorPlace("x_m", "m")},
    ),
)
""",
)
SPRING = OwnPlant(
    {"k": (1.5, 0.1, "s^-1")},
    {"v_m": 1e-3},
    """
x, v, u = symbol("a_1"), symbol("v_m"), symbol("u_V")
return Model(
    name="NAME", states=(x, v), inputs=(u,), outputs={"v_m": v}, parameters=PARAMETERS,
    rates={x: v, v: p["k"] * (u - x - v)}, axes=(), input_limits={u: (-12, 12)},
    places=Places(inputs={"input": InputPlace(u, "V", 12.0)}, sensors={"gauge": SensorPlace("v_m", "m", 1.0)}),
)
""",
)
SPRING_WISHES = """
[design]
[design.wheel]
poles_rad_s = [-2, -3, -6, -8]
reference_min_m = -0.5
reference_max_m = 0.5
"""
CHAIN_WISHES = """
[design]
[design.cart]
poles_rad_s = [-2, -3, -4, -5, -12, -14, -16, -18]
reference_min_m = -0.1
reference_max_m = 0.1
"""


@cache
def plant(name: str) -> BoundPlant:
    """The plant of that name with wishes for its loops."""
    with TemporaryDirectory() as folder:
        if name != "heater":
            return bind(load_plant(plant_file(name, Path(folder))))
        for file, text in plant_texts("my_heater", "heater").items():
            (Path(folder) / file).write_text(text, encoding="utf-8")
        return bind(load_plant(Path(folder) / "plant.toml"))


@cache
def designed(name: str, of: str) -> Any:
    """The table of a controller on a plant."""
    return CONTROLLERS[name].design(plant(of), read_settings(plant(of)))


@pytest.mark.parametrize(("name", "of"), sampled(DESIGNED, [("pid", "aeroshield"), ("lqg", "motor")]))
def test_it_flies_with_its_references_in_double_precision_and_as_generated(name: str, of: str) -> None:
    # Truth: what settles leaves no reference, and the generated law flies as the law in double precision does.
    table = designed(name, of)
    demand_settling(plant(of), table, CONTROLLERS[name].float_law(table), "any plant")
    flown = fly_double(plant(of), table)
    assert left(flown.tracking) == ()
    single = fly_host(plant(of), table, "float32")
    for loop, exact, generated in zip(table.loops, flown.tracking, single.tracking, strict=True):
        step = 0.02 * (table.axis(loop.axis).reference_max_rad - table.axis(loop.axis).reference_min_rad)
        assert generated.mean_error_rad == pytest.approx(exact.mean_error_rad, abs=step)


@pytest.mark.parametrize(("name", "of"), sampled(DESIGNED, [entry for entry in DESIGNED if entry[1] != "inverted_arm"]))
def test_twin_and_host_are_equal_in_all_bits(name: str, of: str) -> None:
    row, table = CONTROLLERS[name], designed(name, of)
    twin, host = row.twin(table), HostLaw(row.generate(table), loops=table.loops)
    stimuli = standard_stimuli(table, 6 * STEPS, words=twin.state_words)
    result = compare(twin, host, [replace(entry, inputs=entry.inputs[:40]) for entry in stimuli])
    assert (result.equality.mismatches, result.first_mismatch, host.self_test()) == (0, None, 0)


ON_TARGET = [("lqg", "quanser_aero"), ("pid", "heater")]


@pytest.mark.parametrize(("name", "of"), sampled(ON_TARGET, keep=ON_TARGET[:1]))
def test_host_and_target_are_equal_in_all_bits(name: str, of: str) -> None:
    row, table = CONTROLLERS[name], designed(name, of)
    texts = row.generate(table)
    host = HostLaw(texts, loops=table.loops)
    board = EmulatedBoard(build_firmware(texts, loops=table.loops).elf)
    target = TargetLaw(board, state_words=host.state_words, loops=table.loops)
    result = compare(host, target, standard_stimuli(table, TARGET_STEPS, words=host.state_words))
    assert (result.equality.mismatches, target.self_test()) == (0, 0)
    assert target.table_digest() == table.digest


def test_loops_of_different_orders_share_one_law() -> None:
    # Truth: a loop of fewer states has moves whose coefficients are 0.
    gains = designed("lqg", "quanser_aero").axes[0].gains
    assert len(gains.k) == len(gains.l) == len(gains.a) + 1


def test_coupled_loops_are_slowed_down_until_they_hold_together() -> None:
    # Truth: both inputs of quanser_aero push both its axes, and at the wished speed the loops together are unstable or below a margin.
    for of, axis, is_slowed in (("quanser_aero", "pitch", True), ("aeroshield", "arm", False)):
        regulator_rad_s = designed("lqg", of).origin[axis]["regulator_rad_s"]
        wished_rad_s = wished_speeds(read_settings(plant(of)).axis(axis), Share(1.0, 1.0)).regulator_rad_s
        assert (
            regulator_rad_s < 0.5 * wished_rad_s
            if is_slowed
            else regulator_rad_s == pytest.approx(wished_rad_s, rel=1e-6)
        )


@pytest.mark.soak
def test_where_no_common_speed_holds_both_the_loops_speeds_are_taken_apart() -> None:
    # Truth: below the horizontal the elevation's input turns ce150_velagic's azimuth, which presses the arm down; alike, even at an eighth
    # of their speeds, both loops have a pole at +0.04 rad/s. At 8 instead of 2 times the elevation's speed the azimuth holds it.
    table = designed("lqg", "ce150_velagic")
    demand_settling(plant("ce150_velagic"), table, CONTROLLERS["lqg"].float_law(table), "any plant")
    speeds = [table.origin[axis]["regulator_rad_s"] for axis in ("elevation", "azimuth")]
    assert speeds == pytest.approx([1.295 / 2.0, 2.0 * 2.59])


SAME_EVERYWHERE = """
[design]
schedule = "theta_rad"
theta_min_rad = -0.5
theta_max_rad = 0.5
operating_points = 5
feedforward_degree = {feedforward_degree}
[design.arm]
poles_rad_s = [-3, -4, -8, -10]
"""


@pytest.mark.parametrize("feedforward_degree", [0, 2])
def test_a_schedule_that_changes_nothing_is_no_obstacle(feedforward_degree: int, tmp_path: Path) -> None:
    # Truth: a wheel is the same at every angle, so every coefficient of its law is a constant.
    level = OwnPlant({**PLAIN.parameters, "G": (0.0, 0.0, "N m")}, PLAIN.sensors, PLAIN.body)
    path = level.write(tmp_path, "level")
    path.write_text(path.read_text() + SAME_EVERYWHERE.format(feedforward_degree=feedforward_degree))
    wheel = bind(load_plant(path))
    table = CONTROLLERS["lqg"].design(wheel, read_settings(wheel))
    assert all(len(row) == 1 for row in (*table.axes[0].gains.k, table.axes[0].gains.g_V_rad))
    host = HostLaw(CONTROLLERS["lqg"].generate(table), loops=table.loops)
    assert host.self_test() == 0


@pytest.mark.parametrize("name", ["pid", "lqg"])
def test_references_that_end_before_the_schedule_does_are_no_obstacle(name: str, tmp_path: Path) -> None:
    """Truth: the law holds its references within +-0.2 rad; from rest at the schedule's end, 0.5 rad, it flies there and stays."""
    path = PLAIN.write(tmp_path, "plain")
    narrow = "reference_min_rad = -0.2\nreference_max_rad = 0.2\nprefilter_time_constant_s = 0.3\n"
    path.write_text(path.read_text() + SAME_EVERYWHERE.format(feedforward_degree=2) + narrow)
    arm = bind(load_plant(path))
    table = CONTROLLERS[name].design(arm, read_settings(arm))
    demand_settling(arm, table, CONTROLLERS[name].float_law(table), "any plant")


ROOM = OwnPlant(
    {"C": (80.0, 8.0, "J K^-1"), "W": (500.0, 50.0, "J K^-1"), "G": (4.0, 0.4, "W K^-1"), "H": (9.0, 0.9, "W K^-1")},
    {"air_K": 0.01},
    """
wall, air, heat = symbol("wall_K"), symbol("air_K"), symbol("heat_W")
return Model(
    name="NAME", states=(wall, air), inputs=(heat,), outputs={"air_K": air}, parameters=PARAMETERS,
    rates={
        wall: (p["H"] * (air - wall) - p["G"] * wall) / p["W"], air: (heat - p["H"] * (air - wall)) / p["C"],
    },
    axes=(), input_limits={heat: (0, 600)},
    places=Places(inputs={"heater": InputPlace(heat, "W", 300.0)}, sensors={"probe": SensorPlace("air_K", "K", 50.0)}),
)
""",
)
ROOM_WISHES = """
[design]
sample_period_s = 0.05
[design.air]
poles_rad_s = [-0.05, -0.06, -0.2, -0.25]
prefilter_time_constant_s = 20.0
reference_min_K = 10.0
reference_max_K = 50.0
"""


@pytest.mark.soak
def test_a_slow_zero_keeps_the_filter_of_the_reference_and_no_step_overshoots(tmp_path: Path) -> None:
    # Truth: the wall's zero at -(H + G)/W = -0.026 rad/s is slower than the loop; without the filter steps overshoot by a fifth.
    path = ROOM.write(tmp_path, "room")
    path.write_text(path.read_text() + ROOM_WISHES)
    room = bind(load_plant(path))
    table = CONTROLLERS["lqg"].design(room, read_settings(room))
    assert table.axes[0].prefilter_time_constant_s == 20.0
    assert max(entry.overshoot for entry in fly_double(room, table).tracking) <= OVERSHOOT.green
    assert designed("lqg", "aeroshield").axes[0].prefilter_time_constant_s == 0.0


ALIKE_WISHES = """
[design]
sample_period_s = 0.05
[design.body]
poles_rad_s = [-0.2, -0.25]
prefilter_time_constant_s = 2.0
reference_min_K = 10.0
reference_max_K = 50.0
"""


def test_two_parts_alike_that_no_output_tells_from_one_have_its_law(tmp_path: Path) -> None:
    # Truth: both temperatures are always equal, so the plant is the one body; all coefficients are, to the digits that a table keeps.
    tables = []
    for name, own in (("one", HEATER), ("two", TWO_ALIKE)):
        path = own.write(tmp_path / name, "body")
        path.write_text(path.read_text() + ALIKE_WISHES)
        bound = bind(load_plant(path))
        settings = read_settings(bound)
        designed_by_all = [CONTROLLERS[controller].design(bound, settings) for controller in NAMES]
        for controller, table in zip(NAMES, designed_by_all, strict=True):
            demand_settling(bound, table, CONTROLLERS[controller].float_law(table), "any plant")
        tables.append((design(bound, settings)[0].axes, designed_by_all[1].axes))
    assert tables[0] == tables[1]


def test_loops_that_push_one_another_stay_with_their_references_on_spread_plants() -> None:
    # Truth: of 30 plants of quanser_aero with parameters within 10 %, each of an unused seed, every step settles and overshoots by at most
    # 5 %, what counts as green.
    bound, table = plant("quanser_aero"), designed("lqg", "quanser_aero")
    law = flown_law(bound, CONTROLLERS["lqg"].generate(table))
    plan = figures(bound)[spread_figure(bound)].manoeuvre(bound, table.sample_period_s)
    for p in spread(bound, 30, 4711):
        for merit in fly_plan(bound, law, plan, p[np.newaxis])[0].merits().values():
            assert merit.settling_s is not None
            assert merit.overshoot <= OVERSHOOT.green + 1e-6


def test_a_table_states_its_gains_in_its_loop_s_units_and_reads_back(tmp_path: Path) -> None:
    table = designed("pid", "heater")
    text = CONTROLLERS["pid"].text(table)
    gains = json.loads(text)[table.loops[0].axis]["gains"]
    assert {"k_p_W_K", "y_max_K"} <= set(gains)
    (tmp_path / "controller.json").write_text(text, encoding="utf-8")
    assert loading.load(tmp_path / "controller.json")[1] == table


@pytest.mark.parametrize("name", NAMES)
def test_an_input_that_holds_the_output_nowhere_is_refused_in_words(name: str, tmp_path: Path) -> None:
    # Truth: v' = k (u - x - v), x' = v comes to rest at v = 0 under any steady u; an integrator would drift behind that zero, unseen.
    path = SPRING.write(tmp_path, "spring")
    path.write_text(path.read_text() + SPRING_WISHES)
    spring = bind(load_plant(path))
    with pytest.raises(BadInput, match="wheel at rest: loop: got a steady u_V that does not move v_m"):
        CONTROLLERS[name].design(spring, read_settings(spring))


def test_loops_that_are_robust_alone_and_unstable_together_are_refused_in_words() -> None:
    # Truth: with both PIDs closed the linearised quanser_aero has a pole at +0.06 rad/s, and 18 of 100 spread ones do not settle.
    with pytest.raises(BadInput, match=r"slowest pole of all loops together: got 0\.0\d* rad/s, expected below 0"):
        CONTROLLERS["pid"].design(plant("quanser_aero"), read_settings(plant("quanser_aero")))


def test_what_three_gains_cannot_hold_is_refused_in_words(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # Truth: four integrators in a row lag by 360 deg; a PID gives back less than 90.
    path = CHAIN.write(tmp_path, "chain")
    path.write_text(path.read_text() + CHAIN_WISHES)
    chain = bind(load_plant(path))
    asked: list[float] = []
    sensitivity = pid_tuning._sensitivity
    monkeypatch.setattr(pid_tuning, "_sensitivity", lambda loop, *k: (asked.append(k[0]), sensitivity(loop, *k))[1])
    with pytest.raises(
        BadInput,
        match=r"PID of the cart: got no gains with that robustness .*x_m lags u_N_s2 by 360 deg.* the lag is 217 deg at most; .*two states",
    ):
        CONTROLLERS["pid"].design(chain, read_settings(chain))
    # A search that finds nothing would else go on to gains of 0, and divide by them.
    assert min(asked) > 0.1 * asked[0] / pid_tuning.WIDEST
    assert np.isfinite(CONTROLLERS["lqg"].design(chain, read_settings(chain)).axes[0].gains.y_max_rad)
