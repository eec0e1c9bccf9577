"""The page of a diagnosis says what diagnosis.json holds, in words for someone who knows only the rig."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from records.diagnosis import (
    Band,
    Diagnosis,
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
from sim.bind import bind
from twinlaw.diagnosis_page import Predicted, diagnosis_page, verdict_sentence
from twinlaw.page import page_text

ROOT = Path(__file__).resolve().parents[2]
MOVED = "parameter J_A is +12.0 standard deviations from its stated value: 0.0213 instead of 0.0133"
STORIES = {"azimuth.cable_spring": "the cable to the board pulls the arm back."}

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
    shrinkage=Shrinkage(
        {"psi_rad": 0.01, "phi_rad": 0.08},
        {"psi_rad": 0.01, "phi_rad": 0.05},
        {"psi_rad": 0.01, "phi_rad": 0.005},
        {"psi_rad": 0.01, "phi_rad": 0.004},
        0.97,
        (0.95, 0.98),
    ),
    next_experiment={"name": "wide azimuth sweep", "expected": {"azimuth.tilt": 0.01}},
    notes=("log a.csv: 3 rows are missing",),
)


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


def text_of(diagnosis: Diagnosis) -> str:
    places = bind(load_plant(ROOT / "plants" / "ce150.toml")).model.places
    page = page_text(diagnosis_page("ce150", diagnosis, places, STORIES, (predicted(),), ("a.csv", "b.csv")))
    return re.sub(r"\s+", " ", page)


def test_the_page_says_all_that_the_record_holds() -> None:
    page = text_of(GAP)
    told = (
        "81 % of the gap",
        "93.0 %",
        "k = 0.00312 ± 4e-05 N m/rad",
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


def test_the_page_needs_no_network_and_no_script() -> None:
    page = text_of(GAP)
    assert "<script" not in page
    assert re.findall(r"""(?:src|href)=["'](?!#)""", page.replace("xlink:href", "href")) == []


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({}, "The rig has what the plant file lacks: cable spring of the azimuth (93.0 % sure)"),
        (
            {"effects": (replace(GAP.effects[0], probability=0.4),)},
            "lacks: most likely cable spring of the azimuth (40.0 % sure)",
        ),
        ({"verdict": "no gap"}, "explains these logs"),
        ({"verdict": "cannot tell"}, "too little motion"),
        ({"found": ()}, "does something in the azimuth that the plant file lacks"),
        ({"found": (), "unknown": Unknown(0.0)}, "most likely cable spring of the azimuth (93.0 %); but"),
        ({"found": (), "effects": (), "unknown": Unknown(0.97)}, "no effect of the library can be named"),
        (
            {"found": (), "effects": (), "unknown": Unknown(0.01), "notes": (MOVED,)},
            "nothing else is missing: J_A.",
        ),
    ],
)
def test_each_verdict_is_one_plain_sentence(change: dict[str, object], said: str) -> None:
    assert said in verdict_sentence(replace(GAP, **change))  # type: ignore[arg-type]


def test_an_empty_record_still_makes_a_page() -> None:
    assert "explains these logs" in text_of(Diagnosis("no gap", 0.4))


def test_names_from_a_log_are_escaped() -> None:
    assert "<b>" not in text_of(replace(GAP, notes=("<b>bold</b>",)))


def test_the_curves_show_where_the_stated_plant_errs_most() -> None:
    from twinlaw.diagnosis_pictures import worst_span

    log = predicted()
    shown = log.t_s[worst_span(log)]
    assert shown[0] <= 20.01
    assert shown[-1] >= 23.98
