"""A diagnosis that holds all that one can hold, and its page as text."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np

from records.diagnosis import (
    Band,
    Diagnosis,
    Estimate,
    Firmware,
    LiesIn,
    PlaceShare,
    RankedHypothesis,
    Region,
    Shrinkage,
    Span,
    Unknown,
)
from records.plant import load_plant
from records.reasons import Note
from sim.bind import bind
from twinlaw.pages.diagnose.pictures import Predicted
from twinlaw.pages.diagnose.report import diagnosis_page
from twinlaw.pages.diagnose.retune import Moved
from twinlaw.pages.page import page_text

ROOT = Path(__file__).resolve().parents[4]


CE150 = bind(load_plant(ROOT / "plants" / "ce150.toml"))


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
    firmware=Firmware(
        True,
        False,
        3.25,
        "each angle is one sample old",
        lies_in=LiesIn.FIRMWARE,
        sentence="each angle is one sample old",
    ),
    effects=(
        RankedHypothesis(
            "azimuth.cable_spring",
            "torque(phi) on azimuth",
            0.93,
            {"k": Estimate(0.00312, 0.00004, "N m/rad")},
            ("azimuth.tilt",),
        ),
        RankedHypothesis("azimuth.tilt", "torque(phi) on azimuth", 0.05, {"m": Estimate(0.004, 0.001, "N m")}),
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
    logs: tuple[Predicted, ...] = (),
) -> str:
    page = diagnosis_page(CE150, diagnosis, logs, ("a.csv", "b.csv"), moved=moved)
    return re.sub(r"\s+", " ", page_text(page))
