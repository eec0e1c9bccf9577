"""What a step costs on the emulated board when the law is flown, down to angles and references where float32 runs out of places."""

import pytest

from tests.law_tables import ce150_table
from tests.soak import SOAK
from tests.verification.cycles import FLOWN, cycles


@pytest.mark.parametrize(("arithmetic", "most"), [("float32", 10_000), ("fixed", 2_000)])
def test_a_flown_step_stays_below_what_was_aimed_at(arithmetic: str, most: int) -> None:
    flown = {
        name: dearest
        for name, _, dearest in cycles(ce150_table(), arithmetic, 20_000 if SOAK else 5_000)
        if name in FLOWN
    }
    assert len(flown) == len(FLOWN if arithmetic == "float32" else FLOWN[:2])
    assert max(flown.values()) < most, flown
