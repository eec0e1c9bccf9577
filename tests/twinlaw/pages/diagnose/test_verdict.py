"""A verdict is one plain sentence for someone who knows only the rig."""

from dataclasses import replace

import pytest

from records.diagnosis import Unknown
from records.reasons import Note
from tests.twinlaw.pages.diagnose.told import GAP, SHRINKAGE, text_of
from twinlaw.pages.diagnose.summary import summary_text
from twinlaw.pages.diagnose.verdict import verdict_sentence

MOVED = Note("moved_parameter", "J_A", {"deviations": 12.0, "value": 0.0213, "stated": 0.0133})
STIFFER = Note(
    "moved_effect", "azimuth.cable_spring", {"symbol": "k", "deviations": 25.8, "value": 0.0045, "stated": 0.003}
)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({}, "The rig has what the plant file lacks: cable spring of the azimuth with k = "),
        ({}, "(93.0 % sure)"),
        ({"partly": 0.04}, "(93.0 % sure)"),
        ({"partly": 0.06}, "(93.0 % sure, 6.0 % that a part of it is right)"),
        ({"unknown": Unknown(0.07)}, "Next comes an effect that has no name here (7.0 %)"),
        (
            {"effects": (replace(GAP.effects[0], probability=0.4),)},
            "lacks: most likely cable spring of the azimuth with k = ",
        ),
        ({"verdict": "no gap"}, "explains these logs"),
        ({"verdict": "cannot tell"}, "too little motion"),
        ({"verdict": "no gap", "shrinkage": None}, "file explains these logs: nothing"),
        # Truth: 0.05 rad of 0.004 that the sensor leaves; from twice that on noise is laid to it in the first sentence.
        (
            {"verdict": "no gap", "shrinkage": replace(SHRINKAGE, rms_after={"psi_rad": 0.01, "phi_rad": 0.05})},
            ", noise apart: nothing that they could show is missing, yet predictions over a second miss phi_rad by 12.5 times",
        ),
        (
            {"verdict": "no gap", "shrinkage": replace(SHRINKAGE, rms_before={"psi_rad": 0.01, "phi_rad": 0.005})},
            "once its parameters are re-tuned",
        ),
        ({"found": ()}, "does something in the azimuth that the plant file lacks"),
        ({"found": (), "unknown": Unknown(0.0)}, "most likely cable spring of the azimuth (93.0 %); but"),
        ({"found": (), "effects": (), "unknown": Unknown(0.97)}, "no effect of the library can be named"),
        (
            {"found": (), "effects": (), "unknown": Unknown(0.97, "azimuth", "torque(phi_dot) on azimuth")},
            "does something in the azimuth that the plant file lacks, a torque or force that depends on how fast phi changes; no effect of",
        ),
        (
            {"found": (), "effects": (), "unknown": Unknown(0.01), "note_records": (MOVED,)},
            "nothing else is missing: J_A = 0.0213 (the file states 0.0133).",
        ),
        (
            {"found": (), "effects": (), "unknown": Unknown(0.01), "note_records": (STIFFER,)},
            "nothing else is missing: k of the cable spring of the azimuth = 0.0045 (the file states 0.003).",
        ),
    ],
)
def test_each_verdict_is_one_plain_sentence(change: dict[str, object], said: str) -> None:
    assert said in verdict_sentence(replace(GAP, **change))  # type: ignore[arg-type]


def test_where_nothing_was_found_no_share_of_the_error_is_told() -> None:
    nothing = replace(GAP, verdict="no gap", false_alarm_probability=1.0, found=(), effects=())
    nothing = replace(nothing, shrinkage=replace(SHRINKAGE, fraction=0.0, fraction_ci95=(0.0, 0.0)))
    told = summary_text(nothing)
    assert "removable" not in told
    assert "no gap: what remains is as small as on a rig" in told
    page = text_of(nothing)
    assert "gap shrinks" not in page
    assert "How well the plant predicts" in page


def test_no_gap_whose_predictions_miss_the_logs_held_out_is_not_called_as_small_as_usual() -> None:
    # Truth: 11.5 floors off on the logs held out, so more is left than sensors leave, whatever explains it.
    after = {"psi_rad": 0.01, "phi_rad": 0.046}
    off = replace(GAP, verdict="no gap", false_alarm_probability=0.006, found=(), effects=())
    told = summary_text(replace(off, shrinkage=replace(SHRINKAGE, rms_after=after)))
    assert "as small as on a rig" not in told
    assert "miss phi_rad by 11.5 times what its sensor leaves: 0.6 % of rigs" in told


def test_no_gap_that_chance_does_not_give_says_why_it_is_none() -> None:
    small = replace(GAP, verdict="no gap", false_alarm_probability=1e-9, found=(), effects=())
    assert "no gap: something is there, too small to count, although a rig" in summary_text(small)


def test_what_is_called_too_small_says_what_it_leaves() -> None:
    # Truth: 11.5 floors off on the logs held out: no reader is told that as much is small.
    after = replace(SHRINKAGE, rms_after={"psi_rad": 0.01, "phi_rad": 0.046})
    off = replace(GAP, verdict="no gap", verdict_reason="too_small", found=(), effects=(), shrinkage=after)
    told = summary_text(replace(off, false_alarm_probability=1e-9))
    assert "The rest is noise to the model: predictions over a second miss phi_rad by 11.5 times" in told
    assert (
        "no gap: something is there that nothing known here brings closer: predictions over a second miss phi_rad by 11.5"
        in told
    )
    assert "small to count" not in told
