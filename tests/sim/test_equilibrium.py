"""Rest points of the CE150 against facts/ce150.md B1, in the digits stated there."""

import numpy as np
import pytest

from records.errors import BadInput
from records.plant import load_plant
from sim.bind import bind
from sim.equilibrium import equilibrium, rest_with
from sim.kernel.reference import reference
from tests.own_plants import FOUR_TANKS, FROM_THE_MAGNET, HANGING, HEATER, TANKS, OwnPlant

U_M0_V = {
    -45: 4.653,
    -40: 4.859,
    -30: 5.191,
    -20: 5.424,
    -10: 5.562,
    0: 5.607,
    10: 5.562,
    20: 5.424,
    30: 5.191,
    40: 4.859,
}
RATES = 1e-11  # of what is left of dx/dt, where single terms reach 2000 rad/s^2

TWO_ON_ONE = OwnPlant(
    {"C": (20.0, 2.0, "J K^-1"), "G": (0.6, 0.06, "W K^-1")},
    {"T_K": 0.01},
    """
T, large, small = symbol("T_K"), symbol("large_W"), symbol("small_W")
return Model(
    name="NAME", states=(T,), inputs=(large, small), outputs={"T_K": T}, parameters=PARAMETERS,
    rates={T: (large + small - p["G"] * T) / p["C"]}, axes=(), input_limits={large: (0, 60), small: (0, 10)},
    places=Places(
        inputs={"oven": InputPlace(large, "W", 60.0), "lamp": InputPlace(small, "W", 10.0)},
        sensors={"probe": SensorPlace("T_K", "K", 50.0)},
    ),
)
""",
)


@pytest.mark.parametrize("psi_deg", U_M0_V)
def test_the_main_rotor_input_follows_the_published_curve(bound, psi_deg):
    assert equilibrium(bound, np.radians(psi_deg)).u0[0] == pytest.approx(U_M0_V[psi_deg], abs=6e-4)


def test_the_tail_input_hardly_depends_on_elevation(bound):
    u_T0 = [equilibrium(bound, np.radians(psi_deg)).u0[1] for psi_deg in range(-40, 41, 5)]
    assert min(u_T0) == pytest.approx(1.81, abs=5e-3)
    assert max(u_T0) == pytest.approx(1.97, abs=5e-3)


@pytest.mark.parametrize("psi_deg", range(-45, 46, 5))
def test_nothing_moves_at_a_rest_point(bound, literal, psi_deg):
    for plant in (bound, literal):
        point = equilibrium(plant, np.radians(psi_deg))
        rates = reference(plant.model).rates(0.0, point.x0, point.u0, plant.p, [0, 0])
        assert np.max(np.abs(rates)) < RATES


def test_the_azimuth_may_be_given_too(bound):
    at = equilibrium(bound, 0.1, 0.7)
    assert at.x0[4] == 0.7
    assert np.array_equal(at.u0, equilibrium(bound, 0.1).u0)


@pytest.mark.parametrize(
    ("psi_deg", "eigenvalues"),
    [(-40, [-0.211 + 2.364j, -0.211 - 2.364j]), (0, [0.0, -0.421]), (20, [1.534]), (40, [2.172])],
)
def test_the_arm_has_the_published_eigenvalues(bound, psi_deg, eigenvalues):
    point = equilibrium(bound, np.radians(psi_deg))
    A = reference(bound.model).A(0.0, point.x0, point.u0, bound.p, [0, 0])
    found = np.linalg.eigvals(A)
    for value in eigenvalues:
        assert np.min(np.abs(found - value)) < 6e-4


def test_an_angle_beyond_the_stops_is_refused_by_name(bound):
    with pytest.raises(BadInput, match=r"elevation angle: got 46 deg, expected -45 to 45 deg, the stops"):
        equilibrium(bound, np.radians(46.0))


def test_an_input_beyond_its_range_is_named(bound):
    weak = bound.p.copy()
    weak[[str(s) for s in bound.model.parameter_symbols].index("u_max")] = 5.0
    with pytest.raises(BadInput, match=r"at 0 deg: input u_M_V: got 5.607 V needed to rest there, expected 0 to 5 V"):
        equilibrium(type(bound)(bound.plant, bound.model, weak, bound.sd), 0.0)


def test_a_plant_without_positions_rests_where_what_it_measures_is_wanted(tmp_path):
    """Truth by hand: what flows between the tanks flows out, so the first stands twice as high; u = s sqrt(2 g h2) / k. To 1e-9."""
    bound = bind(load_plant(TANKS.write(tmp_path, "tanks")))
    point = rest_with(bound, [0], [0.4])
    np.testing.assert_allclose(point.x0, [0.8, 0.4], rtol=1e-9)
    np.testing.assert_allclose(point.u0, [1e-4 * np.sqrt(2 * 9.81 * 0.4) / 5e-5], rtol=1e-9)
    with pytest.raises(BadInput, match=r"at 4 m: input u_V.*0 to 12 V"):
        rest_with(bound, [0], [4.0])


def test_levels_whose_roots_have_no_value_below_0_come_to_rest(tmp_path):
    """Truth by hand, all alike: each pump's flow leaves below, k u = a sqrt(2 g h), and its share above as much of that. To 1e-9."""
    bound = bind(load_plant(FOUR_TANKS.write(tmp_path, "four_tanks")))
    point = rest_with(bound, [0, 1], [0.12, 0.12])
    above_m = 0.35**2 * 0.12
    np.testing.assert_allclose(point.x0, [0.12, 0.12, above_m, above_m], rtol=1e-9)
    np.testing.assert_allclose(point.u0, [6.4e-6 * np.sqrt(2 * 9.81 * 0.12) / 3.3e-6] * 2, rtol=1e-9)


def test_a_plant_without_positions_rests_also_with_an_effect_that_is_flat_elsewhere(tmp_path):
    """Truth by hand: heat = G T = 4 W holds 5 K, below the 5 W at which the heater saturates; beyond, no slope leads there."""
    path = HEATER.write(tmp_path, "heater")
    entry = '\n[effects.heater.saturation.limit]\nvalue = 5.0\nsd = 0.0\nunit = "W"\nsource = "a test"\n'
    path.write_text(path.read_text() + entry)
    point = rest_with(bind(load_plant(path)), [0], [5.0])
    np.testing.assert_allclose(point.u0, [4.0], rtol=1e-6)


def test_of_a_plant_with_positions_those_that_are_measured_are_held(bound):
    np.testing.assert_array_equal(rest_with(bound, [0], [0.3]).x0, equilibrium(bound, 0.3).x0)


def test_of_more_positions_than_inputs_the_wanted_ones_are_held_and_others_find_their_place(tmp_path):
    """Truth by hand: the weight G = 0.2 N m stretches the spring of 1 N m/rad by 0.2 rad, wherever the load is wanted; u = G / K."""
    hanging = bind(load_plant(HANGING.write(tmp_path, "hanging")))
    point = rest_with(hanging, [1], [0.3])
    np.testing.assert_allclose(point.x0, [0.5, 0.0, 0.3, 0.0], atol=1e-9)
    np.testing.assert_allclose(point.u0, [0.2 / 0.05], rtol=1e-9)
    assert point.psi_rad == point.x0[0]
    with pytest.raises(BadInput, match="whether its inputs can hold it there"):
        rest_with(hanging, [0, 1], [0.0, 0.3])


def test_inputs_that_are_not_driven_stay_at_their_least_effort_where_the_others_hold_it(tmp_path):
    """Truth by hand: G T = 6 W hold 10 K, which either heater does alone; 12 W hold 20 K, of which one gives 10 at most. To 1e-9."""
    bound = bind(load_plant(TWO_ON_ONE.write(tmp_path, "two_on_one")))
    np.testing.assert_allclose(rest_with(bound, [0], [10.0], [1]).u0, [0.0, 6.0], atol=1e-9)
    np.testing.assert_allclose(rest_with(bound, [0], [10.0], [0]).u0, [6.0, 0.0], atol=1e-9)
    with pytest.raises(BadInput, match=r"input small_W: got 12 W needed to rest there, expected 0 to 10 W"):
        rest_with(bound, [0], [20.0], [1])


def test_a_ball_that_cannot_reach_its_magnet_rests_where_a_sensor_with_an_effect_is_wanted_to_show_it(tmp_path):
    """Truth: 8 mm on a sensor that shows 1.03 times the gap; the weight asks for C i^2 = m g z^2. The stops are at 2 and 20 mm."""
    body = FROM_THE_MAGNET.body.replace("0, None, None", "0, 0.002, 0.02")
    path = OwnPlant(FROM_THE_MAGNET.parameters, FROM_THE_MAGNET.sensors, body).write(tmp_path, "ball")
    stretched = '\n[effects.light.scale.scale]\nvalue = 1.03\nsd = 0.0\nunit = "1"\nsource = "a test"\n'
    path.write_text(path.read_text() + stretched)
    found = rest_with(bind(load_plant(path)), [0], [0.008])
    assert found.x0 == pytest.approx([0.008 / 1.03, 0.0, np.sqrt(0.068 * 9.81 / 6.5e-5) * 0.008 / 1.03], abs=1e-9)
