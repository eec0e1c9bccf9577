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
        BadInput, match=r"got pan_rad and pan_A, both 'pan' without their units.*rename one in the equations: u_pan_"
    ):
        parse_loops([entry], "design")


@pytest.mark.parametrize(
    ("axis", "told"),
    [
        ("axis", r"\[0\]\.axis: name: got 'axis', which the table or its C has for something else"),
        ("digest", r"got 'digest', which the table or its C has"),
        ("NULL", r"got 'NULL', in C 'NULL'"),
        ("theta_rad", r"a loop called 'theta_rad', as a column is.*call it theta, say"),
        ("theta_ref_rad", r"a loop called 'theta_ref_rad', as a column is"),
    ],
)
def test_a_loop_called_as_something_else_in_its_c_is_refused(axis: str, told: str) -> None:
    with pytest.raises(BadInput, match=told):
        parse_loops([{"axis": axis, "output": "theta_rad", "input": "u_V", "motor": "main"}], "design")
