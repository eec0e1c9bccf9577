"""What a page does to its text before a browser breaks it into lines."""

from records.quality import Colour
from twinlaw.pages.page import Page, Section, page_text


def test_a_line_ends_neither_before_a_per_cent_sign_nor_within_an_option() -> None:
    said = Section("Parameters", ("5 % of <x>: hold one of them (--free), or --trim-s",))
    page = page_text(Page("a", "b", Colour.GREEN, "Green: 5 %.", (), (said,)))
    assert (
        '<p>5\u00a0% of &lt;x&gt;: hold one of them (<span class="option">--free</span>), or <span class="option">--trim-s</span></p>'
    ) in page
    assert "Green: 5\u00a0%." in page
