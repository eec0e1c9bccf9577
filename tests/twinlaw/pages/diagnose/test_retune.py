"""Parameters that a fit moved are told with how far, as a cause among the others and as what explains a hold-out."""

import re
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

from records.diagnosis import Unknown
from records.plant import load_plant
from sim.bind import bind
from tests.twinlaw.pages.diagnose.told import GAP, ROOT, SHRINKAGE, text_of
from twinlaw.pages.diagnose.retune import Moved, moved_most
from twinlaw.pages.diagnose.summary import summary_text

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
    assert lines[2].split("  ")[0] == "other parameters alone"
    assert "0.870" in lines[2]
    assert "J_A +12.0 sd, K_M -0.4 sd" in lines[2]
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
