"""Every equation of the theory bears a number, no number twice."""

import re

from tests.test_project import ROOT

PAGE = (ROOT / "docs" / "theory.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"(?:^    .*\n)+", PAGE, flags=re.MULTILINE)
NUMBER = re.compile(r"\(([A-Z]\.)?\d+\)$")


def test_every_equation_bears_a_number() -> None:
    # A system, or an equation over several lines, bears it at the end of its last line.
    assert len(BLOCKS) >= 8
    for block in BLOCKS:
        assert NUMBER.search(block.rstrip()), block


def test_no_number_is_given_twice() -> None:
    lines = [line for block in BLOCKS for line in block.splitlines()]
    found = [match[0] for line in lines if (match := NUMBER.search(line.rstrip()))]
    assert sorted(found) == sorted(set(found))
    assert {"(4)", "(8)", "(17)", "(22)", "(26)", "(D.4)", "(P.1)"} <= set(found)


def test_sections_are_numbered_in_order() -> None:
    numbers = [int(number) for number in re.findall(r"^## (\d+)\.", PAGE, flags=re.MULTILINE)]
    assert numbers == list(range(1, len(numbers) + 1))
