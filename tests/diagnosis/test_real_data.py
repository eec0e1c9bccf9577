"""The diagnosis on a real rig's log whose answer was published with it. Skipped where the recordings are not there."""

import re
from pathlib import Path

import pytest

from diagnosis.engine import Material, diagnose
from diagnosis.result import Result
from records.plant import load_plant
from sim.bind import bind
from tests.recorded import recorded

COULOMB_N, OFFSET_N = 20.39, -3.16  # published with the benchmark, from other data of the same rig
SAME = 0.03


@pytest.fixture(scope="module")
def emps() -> Result:
    """The positioning system: its plain run to explain, the run with force pulses to check on."""
    plain, pulses = (recorded("emps", record) for record in ("DATA_EMPS", "DATA_EMPS_PULSES"))
    plant = bind(load_plant(Path("plants/emps.toml")))
    return diagnose(plant, Material([plain], [pulses], ["pulses"], [None, None]))


def test_friction_and_offset_of_the_positioning_system_are_found(emps: Result) -> None:
    first = emps.diagnosis.effects[0]
    assert emps.diagnosis.verdict == "gap"
    assert set(emps.diagnosis.found) == set(first.effect.split(" + "))
    assert "carriage.coulomb" in emps.diagnosis.found
    assert first.parameters["carriage.coulomb.b"].value == pytest.approx(COULOMB_N, rel=SAME)
    # A constant force and a friction that differs by direction are one while the carriage moves: half the difference is the offset.
    (offset,) = (value.value for name, value in first.parameters.items() if re.search(r"offset$|difference$", name))
    force = offset / 2.0 if "carriage.friction_asymmetry" in emps.diagnosis.found else offset
    assert force == pytest.approx(OFFSET_N, rel=SAME)
    assert emps.diagnosis.places[0].place == "carriage"


def test_most_of_the_error_is_gone_in_the_run_with_pulses(emps: Result) -> None:
    shrinkage = emps.diagnosis.shrinkage
    assert shrinkage is not None
    assert shrinkage.fraction is not None
    assert shrinkage.fraction > 0.85
    assert shrinkage.rms_after["q_m"] < 0.4 * shrinkage.rms_before["q_m"] < 0.2 * shrinkage.rms_nominal["q_m"]
