"""Every source that a page cites is in the glossary's list, and every entry of the list is cited."""

import re

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
