"""Why an answer is what it is: every rule in order, and a chance that no verdict overwrites."""

from dataclasses import replace

from records.diagnosis import Diagnosis
from records.reasons import Decision
from tests.twinlaw.pages.diagnose.told import WORDS, text_of
from twinlaw.pages.diagnose.summary import summary_text
from twinlaw.pages.diagnose.why import why_text

RULES = (
    Decision("false_alarm", "logs", 4e-13, 0.01, "probability", "a cause is looked for"),
    Decision("matters", "azimuth.coulomb", 0.23, 0.34, "nats", "no gap: too small to matter"),
)


def test_why_an_answer_is_what_it_is_shows_every_rule_in_order_on_page_and_terminal() -> None:
    traced = replace(WORDS, decisions=RULES, verdict_reason="effect_added")
    page, told = text_of(traced), why_text(traced)
    assert page.index("Why this answer") < page.index("false alarm") < page.index("matters", page.index("false alarm"))
    assert told.startswith("gap: effect_added\n")
    for number in ("4e-13", "0.34", "a cause is looked for"):
        assert number in page
        assert number in told


def test_a_gap_that_nothing_explains_keeps_its_chance_and_is_not_called_as_small_as_usual() -> None:
    # Truth: a chance of 4e-13 is not what a rig as stated shows, whatever the verdict.
    small = Diagnosis("no gap", 4e-13, verdict_reason="too_small", decisions=RULES)
    page, told = text_of(small), summary_text(small)
    for text in (page, told):
        assert "as small as on a rig" not in text
        assert "brings predictions over a second hardly closer" in text
        assert "below 1e-06" in text
