"""What running the firmware again showed is told before the plant, once, and blames no more than it knows."""

from dataclasses import replace

import pytest

from records.diagnosis import Firmware, LiesIn
from records.reasons import Note
from replay.firmware import FirmwareReplay
from tests.twinlaw.pages.diagnose.told import WORDS, text_of
from twinlaw.pages.diagnose.summary import summary_text
from twinlaw.pages.diagnose.verdict import verdict_sentence


def again(cause: str, first_s: float | None, replayed: bool = True) -> Firmware:
    """The record of a replay that does not agree, by the name of its cause and what it says."""
    name, _, sentence = cause.partition(": ")
    return FirmwareReplay(replayed, False, first_s, name, sentence).record()


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
    told = replace(WORDS, firmware=again(cause, first))
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
    told = replace(WORDS, firmware=again(f"late_output: {late}", 0.01), note_records=notes)
    summary = summary_text(told)
    assert summary.count(late) == 1
    assert (
        "firmware: Run again on the logged measurements of flight.csv, the controller's own code first differs at 0.01 s.\n"
        in summary
    )
    assert summary.count("other.csv: lost one") == 1
    assert f"flight.csv: {late}" not in text_of(told)
    unknown = replace(told, firmware=again("not_found: no other firmware gives all", 0.01), note_records=())
    assert summary_text(unknown).count("no other firmware gives all") == 1


def test_what_a_replay_says_of_the_log_alone_is_no_finding_of_the_firmware() -> None:
    told = replace(WORDS, firmware=again("log_rounding: the log rounded its inputs", 1.0))
    assert verdict_sentence(told).startswith("The rig has")


def test_without_the_table_or_a_controller_it_is_said_that_nothing_was_run_again() -> None:
    lost = replace(
        WORDS, firmware=again("table_not_found: table ab, which the log names, is gone", None, replayed=False)
    )
    for text in (text_of(lost), summary_text(lost)):
        assert "was not run again, so nothing is known of the firmware: table ab" in text
    assert "no controller's code was run again" in text_of(replace(WORDS, firmware=None)).replace("&#39;", "'")


@pytest.mark.parametrize(
    ("replay", "lies_in", "differs"),
    [
        (FirmwareReplay(True, True, None, None, None), None, False),
        (FirmwareReplay(False, False, None, "not_replayable", "a column lacks"), None, False),
        (FirmwareReplay(True, False, 1.0, "missing_rows", "rows lack"), LiesIn.LOG, False),
        (FirmwareReplay(True, False, 1.0, "fused_multiply_add", "so was it built"), LiesIn.UNSEEN, False),
        (FirmwareReplay(True, False, 1.0, "not_found", "nothing", behind_missing=True), LiesIn.UNSEEN, False),
        (FirmwareReplay(True, False, 1.0, "not_found", "nothing"), LiesIn.UNEXPLAINED, True),
        (FirmwareReplay(True, False, 1.0, "late_output + float64", "late"), LiesIn.COLUMNS, True),
        (FirmwareReplay(True, False, 1.0, "stale_sample + missing_rows", "stale"), LiesIn.FIRMWARE, True),
    ],
)
def test_where_a_difference_lies_follows_from_its_names_and_not_from_its_sentence(
    replay: FirmwareReplay, lies_in: LiesIn | None, differs: bool
) -> None:
    told = replay.record()
    assert (told.lies_in, told.differs) == (lies_in, differs)
    assert told.sentence == (replay.sentence or "")
    assert told.names == (() if replay.cause is None else tuple(replay.cause.split(" + ")))
