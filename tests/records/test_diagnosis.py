"""diagnosis.json: what is written is read back, and a file of the contract's keys alone is one, too."""

import json
from dataclasses import replace

import pytest

from records.diagnosis import (
    Agreement,
    ClosedLoop,
    Diagnosis,
    ErrorResponse,
    PlaceShare,
    RankedHypothesis,
    Shrinkage,
    Unknown,
    diagnosis_text,
    parse_diagnosis,
)
from records.errors import BadInput
from records.quality import MISFIT, Quality

RMS = {"psi_rad": 0.01, "phi_rad": 0.02}
LOOP = ClosedLoop({**RMS, "u_M_V": 0.3}, RMS, RMS, RMS, None, None, ("nominal",), ("hold",))
AGREEMENT = Agreement(0.026, {"nominal": 0.5, "after": 1.0}, {"after": 0.99}, {}, {"before": -20.0})
WHOLE = Diagnosis(
    verdict="gap",
    false_alarm_probability=0.001,
    places=(PlaceShare("azimuth", 1.0),),
    effects=(RankedHypothesis("azimuth.tilt", "torque(phi) on azimuth", 0.9, {}, ("azimuth.wind",)),),
    unknown=Unknown(0.1),
    shrinkage=Shrinkage(RMS, RMS, RMS, RMS, 0.9, (0.8, 0.95), {"psi_rad": AGREEMENT}, LOOP),
    notes=("one",),
)


@pytest.mark.parametrize(
    "diagnosis",
    [WHOLE, replace(WHOLE, shrinkage=None), Diagnosis("no gap", None)],
    ids=["whole", "no hold-out", "least"],
)
def test_what_is_written_is_read_back(diagnosis: Diagnosis) -> None:
    assert parse_diagnosis(json.loads(diagnosis_text(diagnosis)), "file") == diagnosis
    coloured = json.loads(diagnosis_text(diagnosis, Quality((MISFIT.look("psi_rad", 7.0),))))
    assert coloured["quality"]["colour"] == "red"
    assert parse_diagnosis(coloured, "file") == diagnosis


def test_a_file_without_the_further_keys_of_shrinkage_is_read() -> None:
    content = json.loads(diagnosis_text(WHOLE))
    for key in ("agreement", "closed_loop"):
        del content["shrinkage"][key]
    found = parse_diagnosis(content, "file")
    assert found.shrinkage is not None
    assert found.shrinkage.agreement == {}
    assert found.shrinkage.closed_loop is None


def test_error_responses_are_read_back_and_may_lack_in_a_file_of_the_contract() -> None:
    row = ErrorResponse("psi_rad", "u_M_V", 0.5, 1.0, 0.12, 0.01, -1.4, 0.83)
    told = replace(WHOLE, error_responses=(row,))
    content = json.loads(diagnosis_text(told))
    assert parse_diagnosis(content, "file") == told
    del content["error_responses"]
    assert parse_diagnosis(content, "file") == replace(WHOLE, error_responses=())


@pytest.mark.parametrize(("part", "key"), [("shrinkage", "rms_after"), ("unknown", "probability")])
def test_a_missing_key_of_the_contract_is_named(part: str, key: str) -> None:
    content = json.loads(diagnosis_text(WHOLE))
    del content[part][key]
    with pytest.raises(BadInput, match=key):
        parse_diagnosis(content, "file")
