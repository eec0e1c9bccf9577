"""The names of a law's loops, which become names in its C."""

import pytest

from records.errors import BadInput
from records.table import parse_loops


@pytest.mark.parametrize(
    ("part", "name", "word"),
    [("axis", "double", "double"), ("output", "int_rad", "int"), ("input", "this_V", "this"), ("motor", "new", "new")],
)
def test_a_name_of_which_c_would_be_given_a_word_of_its_own_is_refused(part: str, name: str, word: str) -> None:
    plain = {"axis": "arm", "output": "theta_rad", "input": "u_V", "motor": "main"}
    assert parse_loops([plain], "design")[0].symbol == "theta"
    with pytest.raises(BadInput, match=rf"design\[0\]\.{part}: name: got '{name}', of which C is given '{word}'"):
        parse_loops([{**plain, part: name}], "design")
