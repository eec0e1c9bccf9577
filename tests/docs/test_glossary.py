"""Every source that a page cites is in the glossary's list, and every entry of the list is cited."""

import ast
import re
from pathlib import Path

import pytest

from tests.docs.reading.commands import PAGES
from tests.test_project import ROOT

CITED = re.compile(r"(\S+) \((1[89]\d\d|20\d\d)\)")
LIST = "## Books and papers"
CITING = ("docs/diagnosis.md", "docs/glossary.md")


def cited(text: str) -> set[tuple[str, str]]:
    """Last name and year of every source that a text names: "Rao (1948)", "Cox and Hinkley (1974)"."""
    return set(CITED.findall(text))


def test_what_is_cited_is_listed_and_what_is_listed_is_cited() -> None:
    text = {page: (ROOT / page).read_text(encoding="utf-8") for page in CITING}
    terms, _, books = text["docs/glossary.md"].partition(LIST)
    listed = {found.groups() for line in books.splitlines() if (found := CITED.search(line))}
    assert cited(terms) | cited(text["docs/diagnosis.md"]) == listed


def test_the_list_is_in_order_of_its_authors() -> None:
    books = (ROOT / "docs" / "glossary.md").read_text(encoding="utf-8").partition(LIST)[2]
    names = [line.removeprefix("- ").partition(" (")[0] for line in books.splitlines() if line.startswith("- ")]
    assert names == sorted(names)
    assert len(names) > 40


def test_the_glossary_is_reached_from_the_first_page() -> None:
    assert "docs/glossary.md" in PAGES
    assert "](docs/glossary.md)" in (ROOT / "README.md").read_text(encoding="utf-8")


# What the diagnosis once called what the field has a term for: process noise, filter input, effect library, hypothesis, low process noise,
# confidence cap, simulated experiment, presliding friction, thread map.
OLD_WORDS = {"unrest", "tape", "kit", "supposed", "calm", "strain", "candour", "rehearsal", "abreast"}


def named_in(path: Path) -> set[str]:
    """The words of every name that a module gives, its own among them."""
    given = {path.stem}
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            given.add(node.name)
        elif isinstance(node, ast.arg):
            given.add(node.arg)
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            given.add(node.id)
    return {word for name in given for word in re.sub(r"(?<=[a-z])(?=[A-Z])", "_", name).lower().split("_")}


@pytest.mark.parametrize("package", ["diagnosis", "logcheck", "replay", "twinlaw"])
def test_no_name_is_one_of_the_words_before_the_field_s(package: str) -> None:
    found = {path: named_in(path) & OLD_WORDS for path in sorted((ROOT / package).rglob("*.py"))}
    assert {path.relative_to(ROOT).as_posix(): words for path, words in found.items() if words} == {}
