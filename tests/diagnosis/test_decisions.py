"""The constants that decide: few, each with its reason, each read where something is decided."""

import math
import re

from diagnosis import decisions
from diagnosis.detect.input_steps import LARGEST_STEP, SMALLEST_STEP, STEP_RATIO
from diagnosis.detect.waves import RATES_RAD_S
from diagnosis.fit.evidence import STEPS_COST, WAVES_COST
from records.deciding import deciding
from tests.test_project import ROOT

MOST = 40  # so many can be asked one by one what changes with them


def test_few_constants_decide_and_each_is_read_somewhere() -> None:
    names = [name for name, _ in deciding(vars(decisions))]
    assert len(names) <= MOST
    code = "".join(path.read_text() for path in (ROOT / "diagnosis").rglob("*.py"))
    assert [name for name in names if not re.search(rf"decisions\.{name}\b", code)] == []


def test_what_follows_from_them_follows_them() -> None:
    # Truth: chance goes three deviations, z^2 / 2 = 4.5 nats; two standard errors are odds of 1 - erf(sqrt 2) = 0.0455.
    assert decisions.chance_nats() == 4.5
    assert abs(decisions.surely_nats() - 3.09) < 0.01
    with decisions.changed("BEYOND_CHANCE", 2.0 / 3.0):
        assert decisions.chance_nats() == 2.0


def test_a_choice_costs_what_as_many_are_worth_as_are_tried() -> None:
    # Truth: ln of the rates of a sine, and of the steps between the ends of their grid in eight kinds of rounding.
    assert math.isclose(WAVES_COST, math.log(len(RATES_RAD_S)))
    steps = math.log(LARGEST_STEP / SMALLEST_STEP) / math.log(STEP_RATIO)
    assert abs(STEPS_COST - math.log(8 * steps)) < 0.05
