"""The flight tests of a study: four manoeuvres to identify each condition, three flights to validate it, four between the conditions."""

from collections.abc import Sequence

from identification.envelope.flights.conditions import IDENTIFIED, LEFT_OUT, Condition
from identification.envelope.flights.flight import CONTROLS
from identification.envelope.truth.fly import FlightTest

# The thesis validates HA6000ft-50kts by a longitudinal and a lateral 2-3-1-1 and by a quiet descent (2.2.3), and others by other
# missions "when possible" (1.6.3): every second condition descends, the rest climb.
MISSIONS = ("ascending", "descending")


def plan(
    identified: Sequence[Condition] = IDENTIFIED, left_out: Sequence[Condition] = LEFT_OUT
) -> tuple[FlightTest, ...]:
    """All tests; every 2-3-1-1 is flown with a height and sign of its own."""
    tests = []
    for i, at in enumerate(identified):
        tests += [FlightTest(at, "level", control, 0, "identification") for control in CONTROLS]
        flown = (("level", "longitudinal"), (MISSIONS[i % 2], "none"), ("level", "lateral"))
        tests += [FlightTest(at, *entry, number, "validation") for number, entry in enumerate(flown, start=1)]
    for at in left_out:
        tests += [FlightTest(at, "level", control, 0, "interpolation") for control in CONTROLS]
    return tuple(tests)
