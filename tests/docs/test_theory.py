"""Every equation of the theory bears a number, no number twice; its tables are those of the default design."""

import re
from itertools import product

import pytest

from tests.docs.reading.readme import README, shown
from tests.plants import bound
from tests.test_project import ROOT
from twinlaw.workflows.chain.designing import design_plant

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


@pytest.mark.soak
def test_the_poles_of_stored_tables_and_the_error_of_the_feed_forward_are_those_of_a_design() -> None:
    report = design_plant(bound("ce150")).report
    axes = ("elevation", "azimuth")
    poles = {
        (axis, m.form, m.storage): m.slowest.worst_rad_s
        for axis in axes
        for m in report.axis(axis).migrations
        if m.source == "design"
    }
    table = PAGE.partition("The same controllers stored with fewer digits")[2].partition("\nA table that is")[0]
    rows = [[cell.strip(" `*") for cell in line.split("|")[1:-1]] for line in table.splitlines() if line[:1] == "|"][2:]
    for storage, *cells in rows:
        for (axis, form), cell in zip(product(axes, ("delta", "direct")), cells, strict=True):
            digits = len(cell.partition(".")[2])
            assert round(poles[axis, form, storage], digits) == float(cell), (axis, form, storage)
    errors_mV = [f"{1e3 * report.axis(axis).feedforward_error_V:.2g} mV" for axis in axes]
    assert f"| fit error of the feed-forward | {' | '.join(errors_mV)} |" in PAGE
