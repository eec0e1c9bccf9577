"""Why a flight is not green: told apart by flying the same law in double precision and in the other arithmetic."""

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from records.errors import BadInput
from sim.activity import Activity
from sim.tracking import Tracking
from tests.own_plants import NO_AXIS, SUSPENSION
from tests.twinlaw.workflows.test_flying import DESIGN
from twinlaw.pages.run.design_page import design_sections
from twinlaw.pages.run.flight import ChainFlight
from twinlaw.workflows.chain import causes
from twinlaw.workflows.chain.causes import cause
from twinlaw.workflows.chain.designing import design_controller
from twinlaw.workflows.chain.flying import fly_double, fly_host


def _flown(steady_m: float) -> tuple[Tracking, ...]:
    """A flight of steps of 100 mm that rests so far off: green up to half a per cent, amber up to two."""
    still = Activity(0.0, 0.0)
    return (Tracking("x_m", 1, 0.0, 1.0, steady_m, steady_m, 0.0, "u_V", still, 0.1),)


def _at_limit(steady_m: float) -> tuple[Tracking, ...]:
    """The same with 2 V, the most that its input can do, for 3 s on end."""
    return tuple(replace(entry, at_limit_s=3.0, limit_V=2.0) for entry in _flown(steady_m))


GREEN, AMBER, RED = _flown(1e-4), _flown(1e-3), _flown(1e-2)
BEYOND = r"^u_V stands at its limit of 2 V for 3 s on end: the references of x_m lie beyond what it can do\. Fly smaller ones"


@pytest.mark.parametrize(
    ("flown", "double", "fixed", "told"),
    [
        (GREEN, RED, RED, ""),
        (
            RED,
            GREEN,
            GREEN,
            r"off by 0.01 m \(x_m\).* green, off by 0.0001 m .*lost in float32's .*, or --arithmetic fixed",
        ),
        (RED, GREEN, RED, r"lost in float32's last digits\. Choose faster poles or a longer sample_period_s\.$"),
        (RED, GREEN, None, r"Choose faster poles or a longer sample_period_s\.$"),
        (RED, AMBER, GREEN, r"double precision the same law is amber.* lost in float32"),
        (
            RED,
            RED,
            GREEN,
            r"double precision the same law is red.* it is the law, not its arithmetic\. Choose other poles",
        ),
        (_at_limit(1e-4), GREEN, GREEN, ""),
        (_at_limit(1e-3), AMBER, GREEN, BEYOND),
        (_at_limit(1e-2), RED, GREEN, BEYOND),
        (_at_limit(1e-3), GREEN, GREEN, r"lost in float32's .*, or --arithmetic fixed"),
        ((*_at_limit(1e-4), *AMBER), AMBER, GREEN, r"it is the law, not its arithmetic\. Choose other poles"),
    ],
)
def test_the_arithmetic_is_to_blame_where_double_flies_better_and_a_limit_where_it_does_not(
    flown: Any, double: Any, fixed: Any, told: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def host(*_: object) -> ChainFlight:
        if fixed is None:
            raise BadInput("law", "controller", "fixed", "float32", "none")
        return ChainFlight(None, fixed, {})  # type: ignore[arg-type]

    monkeypatch.setattr(causes, "fly_double", lambda *_: ChainFlight(None, double, {}))  # type: ignore[arg-type]
    monkeypatch.setattr(causes, "fly_host", host)
    found = cause(None, None, "float32", flown)  # type: ignore[arg-type]
    assert re.search(told, found) if told else not found


@pytest.mark.soak
def test_a_quarter_of_a_car_loses_its_last_digits_in_float32(tmp_path: Path) -> None:
    # Truth: with poles from -4 rad/s on at 2 ms double precision ends at its reference; float32 hunts by 0.4 mm, 1.3 % of a step.
    plant = SUSPENSION.write(tmp_path, "suspension")
    plant.write_text(plant.read_text() + DESIGN)
    designed = design_controller(plant)
    flown = fly_host(designed.bound, designed.table, "float32").tracking
    found = cause(designed.bound, designed.table, "float32", flown)
    assert re.search(r"the same law is green, off by 0 m .*lost in float32's last digits\. .*--arithmetic fixed", found)


NO_INTEGRAL = """
[design]
sample_period_s = 0.0005

[design.current]
poles_rad_s = [-150.0, -200.0]
free_degree = "q0_zero"
reference_min_A = -4.0
reference_max_A = 4.0
"""


def test_an_error_that_a_law_without_integral_action_leaves_is_told_with_the_key_that_ends_it(tmp_path: Path) -> None:
    # Truth: q_0 = 0 leaves P(1) > 0, so the gain at rest is finite, and the one feed-forward of an unscheduled table is that of 0 A.
    plant = NO_AXIS.write(tmp_path, "coil")
    plant.write_text(plant.read_text() + NO_INTEGRAL)
    designed = design_controller(plant)
    flown = fly_double(designed.bound, designed.table).tracking
    found = cause(designed.bound, designed.table, "float32", flown)
    assert found.endswith('what the feed-forward misses stays: give free_degree = "integral" in [design.current].')
    assert "Choose other poles" not in found
    (text,) = [
        text for part in design_sections(designed.report) if part.title == "Coefficients" for text in part.sentences
    ]
    assert "does not integrate" in text
