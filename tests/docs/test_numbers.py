"""No number stands in a page that code holds and no test compares."""

import re
from collections import Counter

import pytest

from tests.docs.reading.commands import PAGES
from tests.docs.reading.numbers import agrees, held, numbers, scopes, value

COUNTED_TO = 12
# Pages whose every number, but for counting and for what is given with its source, is one of the code's.
OF_THE_CODE: dict[str, dict[str, str]] = {
    "docs/diagnosis.md": {},
    "docs/log-check.md": {"161700": "triples of a hundred"},
    "docs/quality.md": {},
    "docs/json.md": {},
    "docs/other-firmware.md": {},
    "docs/watch.md": {"0.03": "deg, what an encoder's step leaves of one flight", "1234": "rows of an example"},
    "docs/firmware.md": {"32": "bits of the line's checksum, and of a word of either arithmetic"},
    "docs/hardware.md": {
        "3.3": "V, the supply of the chip's pins: STM32G071RB, data sheet",
        "4.7": "kOhm, of an open collector's pull-up: what the field takes",
        "100": "kOhm, one part in ten of the converter's range at 10 kOhm of source",
        "3.4": "section of RM0444",
        "130": "exit status of what Ctrl-C ends, by the shell's rule of 128 and the signal's number",
        "0483": "ST's identity on the USB",
        "374": "of the ST-LINK/V2-1, 374b",
        "100000": "--steps of a command line",
    },
}
HELD = {page: list(held(page)) for page in PAGES}


@pytest.mark.parametrize("page", [page for page in PAGES if HELD[page]])
def test_a_page_says_what_the_code_holds(page: str) -> None:
    told = Counter(
        (text, number) for text, number, _ in {(entry.text, entry.number, entry.expression) for entry in HELD[page]}
    )
    for (text, number), times in told.items():
        assert numbers(text).count(number) >= times, f"{number} stands less than {times} times in {text[:200]}"
    for entry in HELD[page]:
        assert agrees(entry.number, entry.expression), (entry.number, entry.expression, value(entry.expression))


@pytest.mark.parametrize("page", list(OF_THE_CODE))
def test_every_number_of_a_page_on_the_code_is_held(page: str) -> None:
    for text, comments in scopes(page):
        known = {pair.partition("=")[0] for comment in comments for pair in comment.split(",")}
        years = set(re.findall(r"\((1[89]\d\d|20\d\d)\)", text))
        left = set(numbers(text)) - known - years - set(OF_THE_CODE[page])
        assert not [number for number in left if "." in number or float(number) > COUNTED_TO], text[:80]
