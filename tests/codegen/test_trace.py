"""From a constant of the C back to the plant: every constant is traced, and what the trace says is true of the C and the design."""

import json
import re
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from codegen.law import generate_law
from codegen.traceability.literals import LEFT_OUT
from codegen.traceability.origin import names, trace
from design.settings import read_settings
from records.errors import BadInput
from records.plant import load_plant
from records.table import ControllerTable, table_text
from sim.bind import BoundPlant, bind
from tests.other_plants import plant_file
from tests.plants import stated_table
from twinlaw import design, load
from twinlaw.command import main

PLANT = Path("plants/ce150.toml")


@cache
def designed() -> tuple[BoundPlant, ControllerTable]:
    bound = bind(load_plant(PLANT))
    return bound, stated_table("ce150")


def traced(name: str) -> Any:
    bound, table = designed()
    return trace(bound, read_settings(bound), table, name)


def test_every_coefficient_of_the_c_can_be_traced_and_has_its_literal_there() -> None:
    _, table = designed()
    law_c = generate_law(table)["law.c"]
    in_c = {}
    for array, body in re.findall(r"static const law_number (\w+)\[\d+\] = \{[^\n]*\n(.*?)\};", law_c, flags=re.DOTALL):
        in_c.update({f"{array}[{power}]": text for power, text in re.findall(r"\[(\d+)\] = (\S+),", body)})
    known = {constant.name: constant.literal.text for constant in names(table)}
    assert len(in_c) > 30
    assert {name: known[name] for name in in_c} == in_c


def test_in_fixed_point_every_word_of_the_c_can_be_traced_with_its_places() -> None:
    _, table = designed()
    law_c = generate_law(table, "fixed")["law.c"]
    in_c = {}
    for function, body in re.findall(r"static int32_t (\w+)\(const powers .*?\{(.*?)\n    \};", law_c, flags=re.DOTALL):
        in_c[function] = re.findall(r"= (-?\d+), (/\* \d+ places \*/)", body)
    known: dict[str, list[tuple[str, str]]] = {}
    for constant in names(table, "fixed"):
        function = constant.name.partition("[")[0].removesuffix("_V_rad")
        if constant.letter and constant.literal is not LEFT_OUT:
            word, places = constant.literal.text.split(" ", 1)
            known.setdefault(function, []).append((word, places))
    assert sum(len(words) for words in in_c.values()) > 30
    assert known == in_c


@pytest.mark.parametrize("arithmetic", ["float32", "fixed"])
def test_limits_and_steps_of_the_header_can_be_traced(arithmetic: str) -> None:
    _, table = designed()
    texts = generate_law(table, arithmetic)
    known = {constant.name for constant in names(table, arithmetic)}
    defined = set(re.findall(r"#define (\w+) \S", texts["law.h"] + texts["law.c"]))
    assert defined <= known
    for constant in names(table, arithmetic):
        number = constant.literal.text.partition(" ")[0]
        if constant.name.endswith(("_US", "_TICKS", "_PLACES", "_CODE", "_HEX", "_MISSING")):
            assert re.search(rf"#define {constant.name} {number}\s", texts["law.h"])
        elif constant.name.endswith("RESOLUTION_RAD") and arithmetic == "fixed":
            assert f", {number}, " in texts["law.c"]
        elif constant.name.startswith("LAW_"):
            assert f"#define {constant.name} ({number})" in texts["law.h"]


def test_a_coefficient_below_the_last_place_says_that_it_was_left_out() -> None:
    _, table = designed()
    left_out = {constant.name for constant in names(table, "fixed") if constant.literal is LEFT_OUT}
    assert "elevation_u_ff_V[1]" in left_out, "the plant is even in Psi there: the fit's odd term is a rounding error"
    assert not {constant.name for constant in names(table) if constant.literal is LEFT_OUT}


def test_a_coefficient_leads_to_poles_points_and_parameters_with_sources() -> None:
    bound, table = designed()
    found = traced("LAW_ELEVATION_Q1[2]")
    assert found.name == "elevation_q_1_V_rad[2]"
    assert found.value == table.axes[0].q_V_rad[1][2]
    assert [re for re, _ in found.poles_rad_s] == [-3.25, -12.6, -3.4, -3.4, -10.1, -10.1, -21.8]
    assert len(found.points) == read_settings(bound).operating_points
    worst = max(abs(point.designed - point.fitted) / abs(point.designed) for point in found.points)
    assert worst < 0.01, "the fit is within 1 % of what was designed"
    assert all(entry.source for entry in found.parameters)
    assert found.table_digest == table.digest


def test_the_gain_of_the_loop_is_shared_by_rotor_and_inertia() -> None:
    """Truth: the loop's gain is K_M over J_E, so that q goes with -1 % per % of K_M and +1 % per % of J_E."""
    influence = {entry.name: entry.sensitivity for entry in traced("elevation_q_3_V_rad[0]").parameters}
    assert influence["K_M"] == pytest.approx(-1.0, abs=0.01)
    assert influence["J_E"] == pytest.approx(1.0, abs=0.05)
    assert not {"J_A", "b_vA"} & set(influence), "the azimuth has no part in the elevation's gains"


def test_a_coefficient_of_a_polynomial_bears_its_own_unit() -> None:
    # Truth: speeds in rad/s to powers 0, 1, 2 add to a rate in s^-1.
    units = {entry.name: entry.unit for entry in traced("elevation_q_3_V_rad[0]").parameters}
    assert (units["p_bM[0]"], units["p_bM[1]"], units["p_bM[2]"]) == ("s^-1", "rad^-1", "rad^-2 s")


def test_a_limit_is_the_plant_s_own_parameter() -> None:
    (parameter,) = traced("LAW_U_T_MAX_V").parameters
    assert (parameter.name, parameter.value, parameter.sensitivity) == ("uT_max", 10.0, None)
    assert traced("azimuth_limits.u_max_V") == traced("LAW_U_T_MAX_V")


def test_unknown_names_other_plants_and_tables_without_origin_are_refused() -> None:
    bound, table = designed()
    settings = read_settings(bound)
    with pytest.raises(BadInput, match="list them"):
        traced("elevation_q_9[0]")
    with pytest.raises(BadInput, match=r"elevation_q_1_V_rad\[0\] to elevation_q_1_V_rad\[2\]"):
        traced("elevation_q_1_V_rad")
    with pytest.raises(BadInput, match="PLAUSIBLE_V"):
        traced("PLAUSABLE_V")
    with pytest.raises(BadInput, match="operating points"):
        trace(bound, settings, replace(table, origin={}), "elevation_q_1_V_rad[0]")
    heavier = replace(bound.plant.parameters["J_E"], value=5e-3)
    other = bind(replace(bound.plant, parameters={**bound.plant.parameters, "J_E": heavier}))
    with pytest.raises(BadInput, match="designed on"):
        trace(other, settings, table, "elevation_q_1_V_rad[0]")


def test_the_verb_lists_traces_and_speaks_json(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "controller.json"
    path.write_text(table_text(designed()[1]))
    assert main(["trace", "--table", str(path)]) == 0
    c_text = traced("elevation_q_1_V_rad[2]").c_text
    listed = capsys.readouterr().out
    assert re.search(rf"elevation_q_1_V_rad\[2\] +{re.escape(c_text)} ", listed)
    assert f'"{designed()[1].digest}"' in listed
    assert main(["trace", "azimuth_u_ff_V[0]", "--table", str(path)]) == 0
    told = capsys.readouterr().out
    assert "K_T" in told
    assert "input at rest" in told
    assert main(["trace", "azimuth_p_1[0]", "--table", str(path), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["name"] == "azimuth_p_1[0]"
    assert main(["trace", "azimuth_p_1[0]", "--table", str(path), "--arithmetic", "fixed"]) == 0
    assert "places */ [1]" in capsys.readouterr().out
    assert main(["trace", "nonsense", "--table", str(path)]) == 2


def test_a_law_without_schedule_is_traced_in_its_own_words(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Truth: the motor's law has one point, rest, and one input; no angle of a helicopter's is told."""
    plant, table = plant_file("motor", tmp_path), tmp_path / "controller.json"
    table.write_text(table_text(design(load(plant)).table), encoding="utf-8")
    assert main(["trace", "shaft_q_1_V_rad[0]", "--plant", str(plant), "--table", str(table)]) == 0
    told = capsys.readouterr().out
    assert "rest  u 0.0000 V" in told
    assert not [word for word in ("Psi", "u_M", "least squares") if word in told]
