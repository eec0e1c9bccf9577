"""What running the firmware again showed is told before the plant, once, and blames no more than it knows."""

from dataclasses import replace

import pytest

from records.diagnosis import Firmware
from records.reasons import Note
from tests.twinlaw.pages.diagnose.told import WORDS, text_of
from twinlaw.pages.diagnose.summary import summary_text
from twinlaw.pages.diagnose.verdict import verdict_sentence


@pytest.mark.parametrize(
    ("cause", "first", "said"),
    [
        ("float64: the firmware computes in double precision", 0.01, "does not do what its table says: the"),
        (
            "late_output: the firmware sent its output one sample late, or the log has it so",
            0.01,
            "The log does not hold what the firmware of its table computes: the firmware sent its output one sample late, or",
        ),
        (
            "output_sign: the firmware sends u_T_V with its sign turned, or the log has it so",
            0.0,
            "The log does not hold what the firmware of its table computes: the firmware sends u_T_V with",
        ),
        (
            "not_found: no other firmware gives all logged inputs",
            19.99,
            "The log holds commands from 19.99 s on that the firmware of its table does not",
        ),
    ],
)
def test_what_the_firmware_did_otherwise_is_said_before_the_plant(cause: str, first: float, said: str) -> None:
    told = replace(WORDS, firmware=Firmware(True, False, first, cause))
    sentence = verdict_sentence(told)
    assert 0 <= sentence.index(said) < sentence.index("The rig has")
    # The colour says no more than that sentence: where either may be at fault, the firmware is not blamed.
    blamed = said.startswith("does not do what its table says")
    assert ("the firmware does not do as its table says" in summary_text(told).splitlines()[-1]) == blamed
    assert said in summary_text(told).splitlines()[0]
    assert cause.partition(":")[0] not in text_of(told)


def test_what_running_the_firmware_again_showed_is_said_once_with_the_name_of_its_log() -> None:
    """Truth: flight.csv was sent one sample late and other.csv lost a sample: each cause stands once, with its log."""
    late = "the firmware sent its output one sample late, or the log has it so"
    notes = [
        Note("firmware", "flight.csv", {}, f"flight.csv: {late}"),
        Note("firmware", "other.csv", {}, "other.csv: lost one"),
    ]
    told = replace(WORDS, firmware=Firmware(True, False, 0.01, f"late_output: {late}"), note_records=notes)
    summary = summary_text(told)
    assert summary.count(late) == 1
    assert (
        "firmware: Run again on the logged measurements of flight.csv, the controller's own code first differs at 0.01 s.\n"
        in summary
    )
    assert summary.count("other.csv: lost one") == 1
    assert f"flight.csv: {late}" not in text_of(told)
    unknown = replace(
        told, firmware=Firmware(True, False, 0.01, "not_found: no other firmware gives all"), note_records=()
    )
    assert summary_text(unknown).count("no other firmware gives all") == 1


def test_what_a_replay_says_of_the_log_alone_is_no_finding_of_the_firmware() -> None:
    told = replace(WORDS, firmware=Firmware(True, False, 1.0, "log_rounding: the log rounded its inputs"))
    assert verdict_sentence(told).startswith("The rig has")


def test_without_the_table_or_a_controller_it_is_said_that_nothing_was_run_again() -> None:
    lost = replace(
        WORDS, firmware=Firmware(False, False, None, "table_not_found: table ab, which the log names, is gone")
    )
    for text in (text_of(lost), summary_text(lost)):
        assert "was not run again, so nothing is known of the firmware: table ab" in text
    assert "no controller's code was run again" in text_of(replace(WORDS, firmware=None)).replace("&#39;", "'")
