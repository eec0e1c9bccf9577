"""What a page does to its text before a browser breaks it into lines."""

import pytest

from records.quality import Colour
from twinlaw.pages.page import Page, Section, Table, as_sentence, page_text


def test_a_line_ends_neither_before_a_per_cent_sign_nor_within_an_option() -> None:
    said = Section("Parameters", ("5 % of <x>: hold one of them (--free), or --trim-s",))
    page = page_text(Page("a", "b", Colour.GREEN, "Green: 5 %.", (), (said,)))
    assert (
        '<p>5\u00a0% of &lt;x&gt;: hold one of them (<span class="whole">--free</span>), or <span class="whole">--trim-s</span></p>'
    ) in page
    assert "Green: 5\u00a0%." in page


def test_a_short_cell_or_an_interval_is_one_line_whatever_stands_in_it() -> None:
    table = Table(
        [
            (
                "3.22e-17",
                "0.057 + 0.439i",
                "a sentence that may be broken",
                "green",
                "0.06 dB, 0.7 deg, 5 %",
                "1.01531e-06 .. 1.01674e-06",
            )
        ]
    )
    page = page_text(Page("a", "b", Colour.GREEN, "", (), (Section("Why", tables=(table,)),)))
    assert '<td class="whole">3.22e-17</td><td class="whole">0.057 + 0.439i</td>' in page
    assert '<td class="whole">1.01531e-06 .. 1.01674e-06</td>' in page  # a browser breaks lines behind a hyphen
    assert "<td>a sentence" in page
    assert "<td>0.06\u00a0dB, 0.7\u00a0deg, 5\u00a0%</td>" in page
    assert '<td class="good whole">green</td>' in page


@pytest.mark.parametrize(
    ("note", "sentence"),
    [
        ("a shift of one row cannot be seen", "A shift of one row cannot be seen."),
        ("psi_rad is NaN in 3 rows; not measured", "psi_rad is NaN in 3 rows; not measured."),
        ("log.csv: lost one.", "log.csv: lost one."),
        ("J_E moved by 2 sd", "J_E moved by 2 sd."),
    ],
)
def test_a_note_stands_on_the_page_as_a_sentence_and_names_keep_their_letters(note: str, sentence: str) -> None:
    assert as_sentence(note) == sentence
