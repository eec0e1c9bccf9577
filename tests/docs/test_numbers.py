"""No number stands in a page that code holds and no test compares."""

import re

import pytest

from tests.docs.commands import PAGES
from tests.docs.numbers import agrees, held, numbers, scopes, value

# Pages whose every number, but for counting and for what mathematics gives, is one of the code's.
OF_THE_CODE = ("docs/diagnosis.md", "docs/log-check.md")
COUNTED_TO = 12
GIVEN = {
    "161700",  # triples of a hundred
}
HELD = {page: list(held(page)) for page in PAGES}


@pytest.mark.parametrize("page", [page for page in PAGES if HELD[page]])
def test_a_page_says_what_the_code_holds(page: str) -> None:
    for entry in HELD[page]:
        assert entry.number in numbers(entry.text), f"{entry.number} stands in no text beside {entry.expression}"
        assert agrees(entry.number, entry.expression), (entry.number, entry.expression, value(entry.expression))


@pytest.mark.parametrize("page", OF_THE_CODE)
def test_every_number_of_a_page_on_the_code_is_held(page: str) -> None:
    for text, comments in scopes(page):
        known = {pair.partition("=")[0] for comment in comments for pair in comment.split(",")}
        years = set(re.findall(r"\((1[89]\d\d|20\d\d)\)", text))
        left = numbers(text) - known - years - GIVEN
        assert not [number for number in left if "." in number or float(number) > COUNTED_TO], text[:80]
