"""The README against the program: its output, its plot, its verbs, its commands."""

import re
from pathlib import Path

import pytest

from tests.docs import readme
from twinlaw.verbs import VERBS

PAGE = readme.README.read_text(encoding="utf-8")
RENEW = "renew it: .venv/bin/python -m tests.docs.readme"


def without_figures(text: str) -> list[str]:
    """Lines with every number and the width of every column taken out: figures move with compiler and chip, words must not."""
    return [" ".join(re.sub(r"\b[0-9a-f]{16}\b|-?\d+(\.\d+)?|-{2,}", "#", line).split()) for line in text.splitlines()]


def test_the_page_shows_what_a_run_prints(ran: tuple[Path, str]) -> None:
    assert without_figures(readme.shown(PAGE)) == without_figures(ran[1]), RENEW


def test_no_figure_on_the_page_is_far_from_the_run_s(ran: tuple[Path, str]) -> None:
    """Within 15 %, or 0.01: so far a new compiler may move a figure; a change that the page missed moves it further."""
    digests = re.compile(r"table [0-9a-f]{16}")
    numbers = [
        [float(n) for n in re.findall(r"-?\d+(?:\.\d+)?", digests.sub("", text))]
        for text in (readme.shown(PAGE), ran[1])
    ]
    assert numbers[0] == pytest.approx(numbers[1], rel=0.15, abs=0.01), RENEW


def test_the_plot_is_labelled_as_the_run_s(ran: tuple[Path, str]) -> None:
    labels = [
        re.findall(r"<text[^>]*>([^<]*)<", text) for text in (readme.PLOT.read_text("utf-8"), readme.plot(ran[0]))
    ]
    assert labels[0] == labels[1], RENEW


def test_every_verb_has_a_row() -> None:
    table = PAGE[PAGE.index("## The verbs") :]
    assert set(re.findall(r"`([a-z-]+)`", "".join(re.findall(r"^\| (`.*?) \|", table, flags=re.MULTILINE)))) == set(
        VERBS
    )


def test_every_linked_file_is_there() -> None:
    links = re.findall(r"\]\(([^)#]+)\)", PAGE)
    assert len(links) >= 6
    for link in links:
        assert (readme.ROOT / link).is_file(), link


def test_its_commands_name_verbs_options_and_targets_that_exist() -> None:
    for verb in re.findall(r"\.venv/bin/twinlaw ([a-z]+)", PAGE):
        assert verb in VERBS
    makefile = (readme.ROOT / "Makefile").read_text()
    for target in re.findall(r"^    make ([a-z]+)", PAGE, flags=re.MULTILINE):
        assert f"\n{target}:" in makefile
