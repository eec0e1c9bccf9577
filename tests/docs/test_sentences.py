"""Pages are read in minutes: no sentence of one that a person wrote is long."""

import re
from collections.abc import Iterator

import pytest

from tests.docs.reading.commands import PAGES
from tests.test_project import ROOT

MOST_WORDS = 50
MADE = (
    "docs/effects.md",
    "docs/controllers.md",
    "docs/controllers-ce150_velagic.md",
)  # from the library's and the laws' own texts
NO_PROSE = ("|", "#", "    ", "!", "<")


def sentences(page: str) -> Iterator[str]:
    """Those of paragraphs and of items of lists; tables, headings and code have none."""
    text = re.sub(r"```.*?```|<!--.*?-->", "\n\n", page, flags=re.DOTALL)
    text = re.sub(r"^(\s*)(?=(-|\d+\.) )", r"\n\1", re.sub(r"\]\([^)]*\)", "]", text), flags=re.MULTILINE)
    for block in re.split(r"\n\s*\n", text):
        prose = " ".join(line.strip() for line in block.splitlines() if not line.startswith(NO_PROSE))
        yield from re.split(r"(?<=[.?!])\s+", prose)


@pytest.mark.parametrize("page", [page for page in PAGES if page not in MADE])
def test_no_sentence_is_long(page: str) -> None:
    told = sentences((ROOT / page).read_text(encoding="utf-8"))
    assert [sentence for sentence in told if len(sentence.split()) > MOST_WORDS] == []


def test_a_long_one_would_be_seen() -> None:
    page = f"# A heading\n\nShort. {'word ' * 51}end.\n\n- An item.\n- Another {'word ' * 20}.\n"
    assert max(len(sentence.split()) for sentence in sentences(page)) == 52
    assert len([sentence for sentence in sentences(page) if sentence]) == 4
