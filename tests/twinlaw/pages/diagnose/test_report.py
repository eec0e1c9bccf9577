"""The page of a diagnosis says what diagnosis.json holds, needs no network, and escapes what a log names."""

import re
from dataclasses import replace

import pytest

from records.diagnosis import Diagnosis
from records.reasons import Note
from tests.twinlaw.pages.diagnose.told import GAP, WORDS, predicted, text_of


@pytest.fixture(scope="module")
def whole_page() -> str:
    """With every picture that the page can have."""
    return text_of(GAP, logs=(predicted(),))


def test_the_page_says_all_that_the_record_holds(whole_page: str) -> None:
    page = whole_page
    told = (
        "81 % of the gap",
        "93.0 %",
        "k = 0.003120 ± 0.000040 N m/rad",
        "pull it back to one angle",
        "cannot tell cable spring of the azimuth from tilt of the azimuth",
    )
    told += (
        "97.0 %",
        "each angle is one sample old",
        "3.25 s",
        "wide azimuth sweep",
        "3 rows are missing",
        "a.csv, b.csv",
        "1.2e-05",
        "hold.csv",
    )
    assert [words for words in told if words not in page] == []


def test_the_page_needs_no_network_and_no_script(whole_page: str) -> None:
    page = whole_page
    assert page.count("<svg") == 4
    assert "<script" not in page
    assert re.findall(r"""(?:src|href)=["'](?!#)""", page.replace("xlink:href", "href")) == []


def test_an_empty_record_still_makes_a_page() -> None:
    assert "explains these logs" in text_of(Diagnosis("no gap", 0.4))


def test_names_from_a_log_are_escaped() -> None:
    assert "<b>" not in text_of(replace(WORDS, note_records=(Note("missing_rows", "a", {}, "<b>bold</b>"),)))
