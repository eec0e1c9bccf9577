"""The page of a diagnosis says what diagnosis.json holds, in words for someone who knows only the rig."""

import re
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from records.diagnosis import (
    Band,
    Diagnosis,
    ErrorResponse,
    Estimate,
    Firmware,
    Hypothesis,
    PlaceShare,
    Region,
    Shrinkage,
    Span,
    Unknown,
)
from records.plant import load_plant
from records.reasons import Decision, Note
from sim.bind import bind
from twinlaw.pages.diagnose.pictures import Predicted, curves, worst_of_the_retuned, worst_span
from twinlaw.pages.diagnose.report import diagnosis_page
from twinlaw.pages.diagnose.retune import Moved, moved_most
from twinlaw.pages.diagnose.shrinkage import shrinkage_sections
from twinlaw.pages.diagnose.summary import summary_text
from twinlaw.pages.diagnose.verdict import verdict_sentence
from twinlaw.pages.diagnose.why import why_text
from twinlaw.pages.diagnose.words import class_in_words, plain_notes
from twinlaw.pages.page import page_text

ROOT = Path(__file__).resolve().parents[3]
MOVED = Note("moved_parameter", "J_A", {"deviations": 12.0, "value": 0.0213, "stated": 0.0133})
STORIES = {"azimuth.cable_spring": "the cable to the board pulls the arm back."}

SHRINKAGE = Shrinkage(
    {"psi_rad": 0.01, "phi_rad": 0.08},
    {"psi_rad": 0.01, "phi_rad": 0.05},
    {"psi_rad": 0.01, "phi_rad": 0.005},
    {"psi_rad": 0.01, "phi_rad": 0.004},
    0.97,
    (0.95, 0.98),
)

GAP = Diagnosis(
    verdict="gap",
    false_alarm_probability=1.2e-5,
    places=(PlaceShare("azimuth", 0.81), PlaceShare("tail_rotor", 0.15), PlaceShare("loop", 0.04)),
    when=(Span(0.0, 30.0, 0.25), Span(30.0, 60.0, 0.75)),
    regions=(Region("phi_rad", -1.0, 0.0, 0.4), Region("phi_rad", 0.0, 1.0, 0.6)),
    bands=(Band(0.0, 0.2, 0.7), Band(0.2, 1.0, 0.3)),
    firmware=Firmware(True, False, 3.25, "each angle is one sample old"),
    effects=(
        Hypothesis(
            "azimuth.cable_spring",
            "torque(phi) on azimuth",
            0.93,
            {"k": Estimate(0.00312, 0.00004, "N m/rad")},
            ("azimuth.tilt",),
        ),
        Hypothesis("azimuth.tilt", "torque(phi) on azimuth", 0.05, {"m": Estimate(0.004, 0.001, "N m")}),
    ),
    unknown=Unknown(0.02, "azimuth", "torque(phi_dot)"),
    found=("azimuth.cable_spring",),
    shrinkage=SHRINKAGE,
    next_experiment={"name": "wide azimuth sweep", "expected": {"azimuth.tilt": 0.01}},
    notes=("log a.csv: 3 rows are missing",),
    note_records=(Note("missing_rows", "a", {"rows": 3}, "log a.csv: 3 rows are missing"),),
)


# What the tests of single words lay out: the same, of which nothing is drawn but the rig as blocks.
WORDS = replace(GAP, shrinkage=None, when=(), regions=(), bands=())


def predicted(rows: int = 3000) -> Predicted:
    t_s = 0.01 * np.arange(rows)
    wave = np.sin(t_s)
    wrong = wave + np.where((t_s > 20.0) & (t_s < 24.0), 0.3, 0.01)
    both = ("psi_rad", "phi_rad")
    return Predicted(
        "hold.csv",
        t_s,
        dict.fromkeys(both, wave),
        dict.fromkeys(both, wrong),
        dict.fromkeys(both, wave),
        dict.fromkeys(both, wave),
    )


def text_of(
    diagnosis: Diagnosis,
    moved: tuple[Moved, ...] = (),
    widths: dict[str, float] | None = None,
    logs: tuple[Predicted, ...] = (),
) -> str:
    model = bind(load_plant(ROOT / "plants" / "ce150.toml")).model
    page = diagnosis_page(
        "ce150",
        diagnosis,
        model,
        STORIES,
        logs,
        ("a.csv", "b.csv"),
        moved=moved,
        widths=widths or {},
    )
    return re.sub(r"\s+", " ", page_text(page))


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
        "pulls the arm back",
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
        (
            {"verdict": "no gap", "shrinkage": replace(SHRINKAGE, rms_before={"psi_rad": 0.01, "phi_rad": 0.005})},
            "once its parameters are re-tuned",
        ),
        ({"found": ()}, "does something in the azimuth that the plant file lacks"),
        ({"found": (), "unknown": Unknown(0.0)}, "most likely cable spring of the azimuth (93.0 %); but"),
        ({"found": (), "effects": (), "unknown": Unknown(0.97)}, "no effect of the library can be named"),
        (
            {"found": (), "effects": (), "unknown": Unknown(0.01), "note_records": (MOVED,)},
            "nothing else is missing: J_A.",
        ),
    ],
)
def test_each_verdict_is_one_plain_sentence(change: dict[str, object], said: str) -> None:
    assert said in verdict_sentence(replace(GAP, **change))  # type: ignore[arg-type]


def test_an_empty_record_still_makes_a_page() -> None:
    assert "explains these logs" in text_of(Diagnosis("no gap", 0.4))


def test_names_from_a_log_are_escaped() -> None:
    assert "<b>" not in text_of(replace(WORDS, note_records=(Note("missing_rows", "a", {}, "<b>bold</b>"),)))


def test_the_curves_show_where_the_stated_plant_errs_most() -> None:
    log = predicted()
    shown = log.t_s[worst_span(log)]
    assert shown[0] <= 20.01
    assert shown[-1] >= 23.98


def test_the_curves_show_where_the_improved_plant_gains_most_in_the_output_of_the_gap() -> None:
    log = predicted()
    wave = log.measured["phi_rad"]
    off = wave + np.where((log.t_s > 9.0) & (log.t_s < 13.0), 0.1, 0.001)
    slightly = wave + np.where(log.t_s > 27.0, 0.002, 0.001)
    log = replace(
        log,
        before={"psi_rad": slightly, "phi_rad": off},
        after=dict.fromkeys(("psi_rad", "phi_rad"), wave + 0.001),
    )
    output, rows = worst_of_the_retuned(log)
    assert output == "phi_rad"
    assert log.t_s[rows][0] <= 9.01
    assert log.t_s[rows][-1] >= 12.98
    told = curves(log)
    assert "errs most against the improved one, in phi" in told.sentences[0]
    brief = {
        name: {output: values[:300] for output, values in getattr(log, name).items()}
        for name in ("measured", "nominal", "before", "after")
    }
    assert "The 8 s" not in curves(replace(log, t_s=log.t_s[:300], **brief)).sentences[0]
    assert "error of phi" in told.plots[0]


def test_what_was_measured_is_seen_below_the_predictions() -> None:
    drawn = curves(predicted()).plots[0]
    measured, retuned = drawn.index("stroke-width: 5"), drawn.index("stroke-width: 2;")
    assert measured < retuned


ALONE = replace(
    GAP,
    found=(),
    effects=(replace(GAP.effects[1], probability=0.03),),
    unknown=Unknown(0.1),
    shrinkage=None,
    firmware=None,
)
FURTHEST = (Moved("J_A", 12.04), Moved("K_M", -0.4))


def test_other_parameters_stand_among_the_hypotheses_with_their_probability_and_how_far_they_moved() -> None:
    lines = summary_text(ALONE, FURTHEST).splitlines()
    assert lines[1].split("  ")[0] == "other parameters alone"
    assert "0.870" in lines[1]
    assert "J_A +12.0 sd, K_M -0.4 sd" in lines[1]
    page = text_of(ALONE, FURTHEST)
    assert re.search(
        r'other parameters alone</td><td></td><td class="whole">87.0.%</td><td>J_A \+12.0 sd, K_M -0.4 sd', page
    )


def test_a_re_tune_that_explains_the_hold_out_is_said_with_its_parameters() -> None:
    tuned = replace(
        GAP, verdict="no gap", found=(), effects=(), shrinkage=replace(SHRINKAGE, rms_before=SHRINKAGE.rms_after)
    )
    told = summary_text(tuned, FURTHEST)
    assert "phi 4.58 -> 0.286 deg" in told
    assert "J_A +12.0 sd" in told
    page = text_of(tuned, FURTHEST)
    assert "lowers the error of phi from 4.58 to 0.286 deg" in page
    assert "J_A +12.0 sd" in page


def test_what_moved_is_told_in_standard_deviations_the_furthest_first_and_at_most_three() -> None:
    bound = bind(load_plant(ROOT / "plants" / "ce150.toml"))
    parameters = dict(bound.plant.parameters)
    for name, away in (("K_M", 0.5), ("J_A", -2.0), ("J_E", 1.0), ("K_E", 0.3), ("K_A", 0.01)):
        entry: Any = parameters[name]
        parameters[name] = replace(entry, value=entry.value + away * entry.sd, sd=0.1 * entry.sd)
    lag = {"tau": {"value": 0.02, "sd": 0.0001, "unit": "s"}}
    result: Any = SimpleNamespace(
        plant=replace(bound.plant, parameters=parameters, effects={"psi_sensor": {"lag": lag}}),
        case=SimpleNamespace(
            library=SimpleNamespace(bound=bound),
            stated={"psi_sensor.lag": {"tau": 0.01}},
            stated_sd={"psi_sensor.lag": {"tau": 0.002}},
        ),
    )
    told = [entry.text for entry in moved_most(result)]
    assert told == ["tau of psi_sensor.lag +5.0 sd", "J_A -2.0 sd", "J_E +1.0 sd"]


def test_joint_effects_have_a_line_each_and_their_names_once() -> None:
    joint = Hypothesis(
        "azimuth.flexible_mode + azimuth.coulomb",
        "mode(torque) on azimuth + torque(sgn phi_dot) on azimuth",
        0.9,
        {
            "azimuth.flexible_mode.gain": Estimate(0.5, 0.1, "-"),
            "azimuth.flexible_mode.zeta": Estimate(0.2, 0.1, "1"),
            "azimuth.coulomb.b": Estimate(1e-4, 1e-5, "N m"),
        },
    )
    told = replace(WORDS, effects=(joint,), found=(), firmware=None)
    page = text_of(told).replace("\u00a0", " ")
    assert page.count("azimuth.flexible_mode") == 1
    assert "<td>gain = 0.50 ± 0.10, zeta = 0.20 ± 0.10</td>" in page
    assert "<td>b = 0.000100 ± 0.000010 N m</td>" in page
    lines = summary_text(told).splitlines()
    assert "gain 0.50 ± 0.10, zeta 0.20 ± 0.10" in lines[1]
    assert re.match(r"  with azimuth.coulomb +b 0.000100 ± 0.000010 N m$", lines[2])


def test_a_number_that_may_be_any_between_its_bounds_is_not_printed() -> None:
    dead = Hypothesis(
        "tail_input.deadzone",
        "dead band of u_T_V on tail_input",
        0.9,
        {"d": Estimate(0.01, 0.001, "V"), "w": Estimate(6e-9, 60.0, "1"), "n": Estimate(19.0, 0.1, "rad rad^-1")},
    )
    told, widths = replace(WORDS, effects=(dead,)), {"tail_input.deadzone.w": 3.0, "tail_input.deadzone.d": 0.4}
    assert "d = 0.0100 ± 0.0010 V, w not told by these data, n = 19.00 ± 0.10 per rad" in text_of(told, widths=widths)
    assert "d 0.0100 ± 0.0010 V, w not told by these data, n 19.00 ± 0.10 per rad" in summary_text(told, (), widths)


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
    assert "no gap: something is there, too small or too unsure to count, although a rig" in summary_text(small)


def test_words_stand_beside_what_is_short_or_has_no_meaning() -> None:
    assert class_in_words("torque(domega_M/dt)").endswith("a torque that depends on how fast omega_M changes")
    assert class_in_words("torque(psi, sgn psi_dot) on elevation").endswith(
        "depends on psi and the direction in which psi moves"
    )
    assert class_in_words("dead band of u_V on input") == "dead band of u_V on input"
    kept = Note("something_else_missing", "a.b", {"gain_nats": 0.1, "left_nats": 0.9})
    said = (
        "a.b makes predictions of the hold-out 1.1 times as good, yet they stay 2.5 times as far off as "
        "the sensors and the noise would leave them: something else is missing"
    )
    assert plain_notes([kept, kept]) == [said]
    (plain,) = plain_notes([Note("contradiction", "b", {"gain_nats": 250.0, "moved": {"K_M": 4.2}})])
    assert "b would be e^250 times likelier with numbers of its own (K_M +4.2," in plain


def test_an_answer_many_times_the_models_is_told_without_powers_of_ten() -> None:
    rows = tuple(
        ErrorResponse("psi_rad", "u_M_V", 1.0, 2.0, error, sd, 0.7, coherence)
        for error, sd, coherence in ((12.14, 2.1, 0.97), (0.04541, 0.0052, 0.9))
    )
    told = summary_text(replace(WORDS, error_responses=rows))
    assert "psi to u_M from 1 to 2 Hz differs by 1210 ± 210 %, phase 40 deg (coherence 0.97)" in told
    assert "4.54 ± 0.52 %" in text_of(replace(WORDS, error_responses=rows))


def test_bars_of_one_unit_have_one_scale_that_is_said_to_be_logarithmic() -> None:
    rms = {"psi_rad": 0.4, "phi_rad": 0.0005}
    told = Shrinkage(rms, rms, rms, rms, None, None)
    drawn = shrinkage_sections(told, True)[0].plots[0]
    assert drawn.count("logarithmic scale") == 2
    labels = re.findall(r"<text[^>]*>([\d.]+)</text>", drawn)
    assert labels.count("10") == labels.count("0.1") == 2


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
