"""Plant files, units and the binding to their equations: round trip, and every way of being wrong."""

import tomllib
from pathlib import Path

import numpy as np
import pytest

from records.errors import BadInput
from records.plant import load_plant, parse_plant, plant_text
from records.text.units import dimension, dimensions, label
from sim.bind import bind

PLANTS = Path(__file__).parents[2] / "plants"


@pytest.fixture
def content():
    """The CE150's file as nested dictionaries, free to be spoilt."""
    return tomllib.loads((PLANTS / "ce150.toml").read_text())


def read(content):
    return bind(parse_plant(content, "ce150", "ce150.toml"))


@pytest.mark.parametrize("name", ["ce150", "ce150_seed_literal"])
def test_a_plant_written_out_reads_back_equal(name, tmp_path):
    plant = load_plant(PLANTS / f"{name}.toml")
    (tmp_path / f"{name}.toml").write_text(plant_text(plant))
    assert load_plant(tmp_path / f"{name}.toml") == plant
    assert plant_text(load_plant(tmp_path / f"{name}.toml")) == plant_text(plant)


def test_the_parameter_vector_is_in_the_order_of_the_model(content):
    bound = read(content)
    values = dict(zip(map(str, bound.model.parameter_symbols), bound.p, strict=True))
    assert (values["p_bM_1"], values["J_E"], values["cf_sign"]) == (0.0035, 0.00437, -1.0)
    assert bound.sd[[str(s) for s in bound.model.parameter_symbols].index("tau_gE")] == 0.000766
    assert bound.parameter("K_M") == 363.0


def change(content, path, value):
    """Set or, for None, remove an entry."""
    *parents, last = path.split(".")
    for key in parents:
        content = content[key]
    if value is None:
        del content[last]
    else:
        content[last] = value


@pytest.mark.parametrize(
    ("path", "value", "message"),
    [
        ("schema", "plant/2", "schema: got 'plant/2', expected 'plant/1'"),
        ("schema", None, "schema: got nothing"),
        ("model", None, "got nothing, expected the file of the plant's equations, beside this one, or a model"),
        ("model", "ufo", "model: got 'ufo', expected one of ce150"),
        ("model", 7, "model: text: got 7"),
        ("wind", 3, "key 'wind': got an unknown key"),
        ("parameters", [], r"parameters: a table: got \[\]"),
        ("parameters.J_E", None, "parameter 'J_E': got nothing"),
        ("parameters.J_E", 4, r"parameters\.J_E: a table: got 4"),
        ("parameters.J_X", {"value": 1, "sd": 0, "unit": "m", "source": "x"}, "parameter 'J_X': got an unknown name"),
        ("parameters.J_E.value", None, r"parameters\.J_E: key 'value': got nothing"),
        ("parameters.J_E.colour", "red", "key 'colour': got an unknown key"),
        ("parameters.J_E.value", float("nan"), r"parameters\.J_E\.value: number: got nan, expected a finite number"),
        ("parameters.J_E.value", "heavy", "number: got 'heavy'"),
        ("parameters.J_E.value", True, "number: got True"),
        ("parameters.J_E.value", -4e-3, r"parameters\.J_E: sign: got -0\.004, expected a positive value"),
        ("parameters.b_cE.value", -1e-4, "sign: got -0.0001, expected a non-negative value"),
        ("parameters.J_E.value", [4e-3, 1e-3], r"parameters\.J_E\.sd: list of numbers: got 0\.000218, expected a list"),
        ("parameters.J_E.sd", -1e-4, "sd: got -0.0001, expected a standard deviation >= 0"),
        ("parameters.J_E.sd", float("inf"), r"J_E\.sd: number: got inf"),
        ("parameters.J_E.unit", "kg m", r"parameters\.J_E: unit: got 'kg m', expected 'kg m\^2'"),
        ("parameters.J_E.unit", "stone", "unit symbol 'stone' is not one of"),
        ("parameters.J_E.unit", "", r"J_E\.unit: text: got ''"),
        ("parameters.J_E.source", "", r"J_E\.source: text"),
        ("parameters.p_bM.value", [3.0, 0.0035], r"p_bM\.sd: list of numbers: got 3 entries, expected 2 entries"),
        ("parameters.p_bM.unit", "[s^-1, rad^-1]", "expected one unit, or 3"),
        ("sensors", 3, "sensors: a table: got 3"),
        ("sensors.psi_rad", None, "sensor 'psi_rad': got nothing"),
        ("sensors.roll_rad", {"resolution_rad": 1e-3}, "sensor 'roll_rad': got an unknown name"),
        ("sensors.psi_rad.resolution_rad", 0.0, "resolution_rad: number: got 0.0, expected a number above 0"),
        ("sensors.psi_rad.step_rad", 1e-3, "key 'step_rad': got an unknown key"),
        (
            "parameters.u_max.value",
            -1.0,
            "limits of u_M_V: got from 0 to -1, of \\(u_min, u_max\\), expected the least value, then a larger one",
        ),
        ("design", 3, "design: a table: got 3"),
        ("effects", "wind", "effects: a table: got 'wind'"),
    ],
)
def test_a_wrong_plant_file_is_refused_by_name(content, path, value, message):
    change(content, path, value)
    with pytest.raises(BadInput, match=message):
        read(content)


def test_two_coefficients_for_three_are_refused(content):
    change(content, "parameters.p_bM.value", [3.0, 0.0035])
    change(content, "parameters.p_bM.sd", [0.0, 0.0])
    change(content, "parameters.p_bM.unit", "[s^-1, rad^-1]")
    with pytest.raises(BadInput, match=r"p_bM: value: got 2 coefficients, expected a list of 3 coefficients"):
        read(content)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (None, r"got No such file .*; name yours with --plant, or one of .*/plants"),
        ("model = [", "got no TOML"),
        (b"\xff\xfe", "got no UTF-8 text"),
    ],
)
def test_a_file_that_is_no_plant_is_refused(tmp_path, text, message):
    path = tmp_path / "p.toml"
    if text is not None:
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(BadInput, match=message):
        load_plant(path)


def test_the_folder_of_a_plant_is_told_its_file(tmp_path):
    (tmp_path / "plant.toml").write_text("")
    with pytest.raises(BadInput, match=r"got Is a directory.*; name the file in it, .*plant\.toml"):
        load_plant(tmp_path)


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("N m s^2", "kg m^2"),
        ("N m s", "kg m^2/s"),
        ("rad s^-2 V^-1", "s^-2/V"),
        ("1", "-"),
        ("N*m (torque)", "kg m^2 s^-2"),
        ("J s^-1 K^-1", "W/K"),
        ("V A^-1 s", "H"),
        ("Ohm F", "s"),
        ("Pa m^3 s^-1", "W"),
        ("m^3 s^-1 V^-1 Pa^-0.5", "m^3.5 kg^-0.5 V^-1"),
    ],
)
def test_units_that_mean_the_same_have_the_same_dimensions(one, other):
    assert dimension(one) == dimension(other)


def test_lists_of_units_are_read_one_by_one():
    assert dimensions("[s^-1, rad^-1, rad^-2 s]") == ((0, 0, -1, 0, 0), (0, 0, 0, 0, 0), (0, 0, 1, 0, 0))
    assert not np.array_equal(dimension("kg m"), dimension("kg m^2"))


@pytest.mark.parametrize(
    ("name", "shown"),
    [("a_y_m_s2", "a_y [m/s^2]"), ("p_rad_s", "p [rad/s]"), ("u_M_V", "u_M [V]"), ("psi_rad", "psi [rad]"), ("M", "M")],
)
def test_an_axis_shows_a_column_s_name_and_unit(name, shown):
    assert label(name) == shown
