"""Every equation of the theory bears a number, no number twice."""

import re

from tests.docs.readme import README, shown
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


def test_the_default_table_s_figures_are_those_of_a_run() -> None:
    """README.md shows what a run prints, and tests/docs/test_readme.py holds that."""
    table = PAGE.partition("**What the default table holds**")[2].partition("\nThe same controllers")[0]
    rows = [line for line in table.splitlines() if line.startswith(("| slowest", "| Ms", "| gain", "| both"))]
    printed = set(re.findall(r"-?\d+(?:\.\d+)?", shown(README.read_text(encoding="utf-8"))))
    assert len(rows) == 4
    assert (
        set(re.findall(r"(?<!\w)-?\d+(?:\.\d+)?", " ".join(row.partition("|")[2].partition("|")[2] for row in rows)))
        <= printed
    )
