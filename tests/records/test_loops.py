"""The names of a law's loops, which become names in its C."""

import pytest

from records.errors import BadInput
from records.loops import parse_loops


@pytest.mark.parametrize(
    ("part", "name", "word"),
    [("axis", "double", "double"), ("output", "int_rad", "int"), ("input", "this_V", "this"), ("motor", "new", "new")],
)
def test_a_name_that_is_a_keyword_of_c_is_refused(part: str, name: str, word: str) -> None:
    plain = {"axis": "arm", "output": "theta_rad", "input": "u_V", "motor": "main"}
    assert parse_loops([plain], "design")[0].symbol == "theta"
    with pytest.raises(BadInput, match=rf"design\[0\]\.{part}: name: got '{name}', in C '{word}'"):
        parse_loops([{**plain, part: name}], "design")


def test_columns_that_differ_by_their_units_alone_are_named() -> None:
    entry = {"axis": "pan", "output": "pan_rad", "input": "pan_A", "motor": "pan"}
    with pytest.raises(
        BadInput,
        match=r"got pan_A and pan_rad, both 'PAN' in capitals without their units.*rename one in the equations: u_pan_",
    ):
        parse_loops([entry], "design")


@pytest.mark.parametrize(
    ("second", "told"),
    [
        ({"output": "Nod_rad"}, r"Nod_rad and nod_rad, both 'NOD'"),
        ({"input": "U_A"}, r"U_A and u_V, both 'U'"),
        ({"output": "nod_ref_rad"}, r"nod_ref_rad and nod_ref_rad, both 'NOD_REF'"),
        ({"input": "nod_ref_V"}, r"nod_ref_V and nod_ref_rad, both 'NOD_REF'"),
    ],
)
def test_columns_of_two_loops_that_would_be_one_macro_or_member_are_refused(second: dict[str, str], told: str) -> None:
    # Truth: law.h has LAW_NOD_REF_MIN_RAD and LAW_U_MIN_V of nod_rad and u_V, and a member nod_ref_rad; zig refuses a second of them.
    loops = [
        {"axis": "nod", "output": "nod_rad", "input": "u_V", "motor": "nod"},
        {"axis": "turn", "output": "turn_rad", "input": "v_V", "motor": "turn"},
    ]
    assert len(parse_loops(loops, "design")) == len(loops)
    with pytest.raises(BadInput, match=told):
        parse_loops([loops[0], {**loops[1], **second}], "design")


@pytest.mark.parametrize(
    ("axis", "told"),
    [
        ("axis", r"\[0\]\.axis: name: got 'axis', which the table or its C has for something else"),
        ("digest", r"got 'digest', which the table or its C has"),
        ("NULL", r"got 'NULL', in capitals as the macros of C headers are.*write null, say"),
        ("TIM1", r"got 'TIM1', in capitals"),
        ("theta_rad", r"a loop called 'theta_rad', as a column is.*call it theta, say"),
        ("theta_ref_rad", r"a loop called 'theta_ref_rad', as a column is"),
    ],
)
def test_a_loop_called_as_something_else_in_its_c_is_refused(axis: str, told: str) -> None:
    with pytest.raises(BadInput, match=told):
        parse_loops([{"axis": axis, "output": "theta_rad", "input": "u_V", "motor": "main"}], "design")
