"""The flight tests of a study: four manoeuvres to identify each condition, three flights to validate it, four between the conditions."""

from collections.abc import Sequence

from identification.envelope.conditions import IDENTIFIED, LEFT_OUT, Condition
from identification.envelope.flight import CONTROLS
from identification.envelope.truth.fly import FlightTest

# The thesis validates HA6000ft-50kts by these three (2.2.3).
VALIDATIONS = (("level", "longitudinal"), ("descending", "none"), ("level", "lateral"))


def plan(
    identified: Sequence[Condition] = IDENTIFIED, left_out: Sequence[Condition] = LEFT_OUT
) -> tuple[FlightTest, ...]:
    """All tests; every 2-3-1-1 is flown with a height and sign of its own."""
    tests = []
    for at in identified:
        tests += [FlightTest(at, "level", control, 0, "identification") for control in CONTROLS]
        tests += [FlightTest(at, *flown, number, "validation") for number, flown in enumerate(VALIDATIONS, start=1)]
    for at in left_out:
        tests += [FlightTest(at, "level", control, 0, "interpolation") for control in CONTROLS]
    return tuple(tests)
