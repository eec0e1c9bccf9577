"""The library of effects is whole and consistent: the contract's table, places, bounds, twins, words."""

from pathlib import Path

import pytest
import sympy

from records.plant import load_plant
from records.text.units import dimension
from sim.bind import bind
from sim.composition.build import model_with
from sim.effects import effects_for
from sim.model import Model
from sim.plants import MODELS
from tests.own_plants import WHEEL
from tests.sim.conftest import PLANTS
from tests.soak import sampled

CE150 = """
main_input.deadzone d; tail_input.deadzone d; main_input.saturation limit; tail_input.saturation limit;
main_input.supply_sag s; tail_input.supply_sag s; main_input.delay tau; tail_input.delay tau;
main_input.slew_limit r; tail_input.slew_limit r; main_input.quantization q; tail_input.quantization q;
main_input.lag tau; tail_input.lag tau; main_rotor.warmup a T; tail_rotor.warmup a T;
main_rotor.dry_friction c; tail_rotor.dry_friction c; main_rotor.ground_effect a psi_0; tail_rotor.reverse_asymmetry r;
tail_rotor.downwash a; elevation.coulomb b; azimuth.coulomb b; elevation.stribeck b_s v_s; azimuth.stribeck b_s v_s;
elevation.quadratic_drag c; azimuth.quadratic_drag c; elevation.cable_spring k angle_0; azimuth.cable_spring k angle_0;
elevation.centre_of_gravity delta; elevation.weight_shift Delta t_1; elevation.tail_coupling k;
elevation.rotor_acceleration J; azimuth.rotor_acceleration J; elevation.disturbance torque t_0 duration;
azimuth.disturbance torque t_0 duration; elevation.flexible_mode gain omega_n zeta; azimuth.flexible_mode gain omega_n zeta;
azimuth.tilt m Phi_0; azimuth.gyroscopic K; azimuth.friction_asymmetry difference;
psi_sensor.offset offset; psi_sensor.scale scale; psi_sensor.quantization q; psi_sensor.delay tau; psi_sensor.lag tau;
psi_sensor.backlash width; phi_sensor.offset offset; phi_sensor.scale scale; phi_sensor.quantization q; phi_sensor.delay tau;
phi_sensor.lag tau; phi_sensor.backlash width; loop.delay tau; loop.dropped_frames p
"""
OTHERS = {
    "quanser_aero": "main_rotor.lag tail_rotor.lag main_input.gain tail_input.gain pitch.offset_force yaw.offset_force "
    "pitch.friction_asymmetry yaw.friction_asymmetry pitch.coulomb yaw.tilt theta_sensor.scale loop.delay",
    "aeroshield": "rotor.lag rotor.quadratic_thrust input.gain arm.offset_force arm.friction_asymmetry input.deadzone "
    "arm.coulomb theta_sensor.offset",
    "antx_2dof_drone": "rotor.quadratic_thrust input.gain input.delay pitch.offset_force pitch.friction_asymmetry",
    "emps": "input.gain carriage.coulomb carriage.offset_force carriage.friction_asymmetry q_sensor.scale motor.warmup",
    "pamh_aeropendulum": "rotor.lag rotor.quadratic_thrust input.gain arm.offset_force arm.coulomb arm.friction_asymmetry",
    "maglev_coil": "input.deadzone input.lag input.gain i_sensor.offset i_sensor.delay",
    "torque_limited_pendulum": "input.deadzone drive.lag pendulum.coulomb pendulum.offset_force theta_sensor.delay",
}
PLACES = {
    "ce150": "main_input tail_input main_rotor tail_rotor elevation azimuth psi_sensor phi_sensor loop",
    "ce150_velagic": "main_input tail_input main_rotor tail_rotor elevation azimuth psi_sensor phi_sensor loop",
    "quanser_aero": "main_input tail_input main_rotor tail_rotor pitch yaw theta_sensor psi_sensor loop",
    "aeroshield": "input rotor arm theta_sensor loop",
    "aeroshield_two_clocks": "input rotor arm theta_sensor loop",
    "pamh_aeropendulum": "input rotor arm theta_sensor loop",
    "antx_2dof_drone": "input rotor pitch theta_sensor loop",
    "emps": "input motor carriage q_sensor loop",
    "maglev_coil": "input i_sensor loop",
    "torque_limited_pendulum": "input drive pendulum theta_sensor loop",
}


@pytest.fixture(params=list(MODELS))
def model(request: pytest.FixtureRequest) -> Model:
    """Each nominal model in turn."""
    return MODELS[request.param]()


def test_the_contract_s_table_is_there_with_its_symbols() -> None:
    library = effects_for(MODELS["ce150"]())
    for entry in CE150.replace("\n", " ").split(";"):
        name, *symbols = entry.split()
        own, further = library[name].parameters[: len(symbols)], library[name].parameters[len(symbols) :]
        assert [parameter.symbol for parameter in own] == symbols
        # What the contract's formula does not have leaves it as it is: a shape that is 0 where a plant file does not give it.
        assert not any(parameter.refining for parameter in own), name
        assert all(parameter.refining for parameter in further), name


def test_what_refines_a_formula_is_a_shape_that_may_be_0(model: Model) -> None:
    for effect in effects_for(model).values():
        for parameter in effect.parameters:
            if parameter.refining:
                assert parameter.first == 0.0, effect.name
                assert not parameter.is_size, effect.name


@pytest.mark.parametrize("plant", list(OTHERS))
def test_other_plants_have_the_effects_that_apply(plant: str) -> None:
    assert set(OTHERS[plant].split()) <= set(effects_for(MODELS[plant]()))


@pytest.mark.parametrize("plant", list(PLACES))
def test_places_are_the_contract_s(plant: str) -> None:
    assert set(MODELS[plant]().places.names) == set(PLACES[plant].split())


def test_every_effect_acts_at_a_place_of_its_plant(model: Model) -> None:
    for name, effect in effects_for(model).items():
        assert effect.place in model.places.names
        assert effect.name == name == f"{effect.place}.{effect.kind}"
        assert effect.class_text == f"{effect.depends} on {effect.place}"


def test_every_effect_acts_in_one_way(model: Model) -> None:
    for effect in effects_for(model).values():
        ways = (effect.edit, effect.applied, effect.on_input, effect.on_output)
        assert sum(way is not None for way in ways) == 1, effect.name


def test_parameters_begin_and_vanish_within_their_bounds(model: Model) -> None:
    for effect in effects_for(model).values():
        assert any(parameter.is_size for parameter in effect.parameters), effect.name
        for parameter in effect.parameters:
            for value in (parameter.reference, parameter.first, parameter.touched, *parameter.starts):
                assert parameter.lower <= value <= parameter.upper, (effect.name, parameter.symbol)
            dimension(parameter.unit)
        assert effect.size.reference != effect.size.zero


def test_an_effect_that_needs_a_grid_has_one_or_acts_at_a_time(model: Model) -> None:
    for effect in effects_for(model).values():
        if not effect.smooth:
            times = {"t_0", "t_1", "t_s"} & set(effect.parameter)
            assert times or any(parameter.starts for parameter in effect.parameters), effect.name


@pytest.mark.parametrize("model", sampled(MODELS, keep=["ce150", "aeroshield", "maglev_coil"]), indirect=True)
def test_coefficients_of_all_effects_together_have_names_of_their_own(model: Model) -> None:
    together = model_with(model, tuple(effects_for(model)))
    names = [str(symbol) for symbol in (*together.parameter_symbols, *together.states, *together.inputs)]
    assert len(set(names)) == len(names)
    assert all(name.isidentifier() for name in names)


def test_twins_are_effects_of_the_plant_or_its_parameters(model: Model) -> None:
    library = effects_for(model)
    for effect in library.values():
        for twin, reason in effect.twins.items():
            assert twin in library or twin.startswith("parameters"), (effect.name, twin)
            assert twin != effect.name
            assert reason


def test_what_reads_no_way_of_an_axis_has_no_disc_no_coupling_and_no_count() -> None:
    of_sensors = {name for name in effects_for(MODELS["maglev_coil"]()) if name.startswith("i_sensor.")}
    assert of_sensors == {f"i_sensor.{kind}" for kind in ("offset", "scale", "lag", "delay", "quantization")}


def test_every_effect_has_its_words(model: Model) -> None:
    for effect in effects_for(model).values():
        assert effect.story.endswith("."), effect.name
        assert effect.equation
        assert effect.source


def test_a_nominal_parameter_that_does_the_same_is_one_of_the_plant(model: Model) -> None:
    parameters = load_plant(PLANTS / f"{model.name}.toml").parameters
    for effect in effects_for(model).values():
        assert not effect.same_as or effect.same_as in parameters


def test_the_same_set_in_any_order_is_the_same_object() -> None:
    one = model_with(MODELS["ce150"](), ("azimuth.tilt", "elevation.coulomb", "loop.delay"))
    assert one is model_with(MODELS["ce150"](), ("elevation.coulomb", "azimuth.tilt"))
    assert model_with(MODELS["ce150"](), ()) is MODELS["ce150"]()


def test_what_arrives_of_an_input_is_known_to_be_real(model: Model) -> None:
    """Where it is not, SymPy searches the equations for imaginary parts, minutes long once several effects act on one input."""
    for effect in effects_for(model).values():
        if effect.applied is not None:
            for expression in effect.applied(*effect.symbols).values():
                assert sympy.sympify(expression).is_extended_real, effect.name


def test_an_axis_without_a_position_is_told_by_its_own_speed(tmp_path: Path) -> None:
    """A wheel's state is omega_rad_s: no text of an effect there speaks of a change of omega."""
    effects = effects_for(bind(load_plant(WHEEL.write(tmp_path, "wheel"))).model)
    assert effects["arm.coulomb"].depends == "torque(sgn omega)"
    assert effects["arm.quadratic_drag"].depends == "torque(omega)"
    assert not any("omega_dot" in f"{effect.depends} {effect.equation}" for effect in effects.values())
