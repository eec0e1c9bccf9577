"""Objects for a microcontroller are named by all that can change them, and by nothing else."""

import pytest

from toolchain.host import CText
from toolchain.target import compile_objects

UNIT = '#include "own.h"\nconst char *place(void) { return PLACE; }\n'
HEADER = '/* of table 1 */\n#define DIGEST "1"\n#define PLACE "http://here" // a link\nconst char *place(void);\n'


def made(unit: str, header: str) -> str:
    """Name of the object of a unit with its header, with as few flags as a compiler needs."""
    (found,) = compile_objects([CText("own.h", header), CText("unit.c", unit)], flags=("-ffreestanding",))
    return found.name


@pytest.mark.parametrize(("old", "new"), [("of table 1", "of table 2"), ('DIGEST "1"', 'DIGEST "2"'), ("a link", "it")])
def test_comments_and_definitions_that_nobody_uses_make_no_other_object(old: str, new: str) -> None:
    assert made(UNIT, HEADER.replace(old, new)) == made(UNIT, HEADER)


@pytest.mark.parametrize(
    ("unit", "header"),
    [
        (UNIT, HEADER.replace("http://here", "http://there")),  # in a string no comment begins
        (UNIT.replace("PLACE", "DIGEST"), HEADER),
        (UNIT, HEADER.replace("/* of", "/* of\n")),  # the lines that debug information names
    ],
)
def test_what_is_used_and_where_it_stands_make_another_object(unit: str, header: str) -> None:
    assert made(unit, header) != made(UNIT, HEADER)
