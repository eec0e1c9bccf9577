"""An encoder that jumps, stands still or wraps: the flight ends by the ramp where counts can tell, and only there."""

import pytest

from records.protocol import PROTOCOL
from tests.firmware.box import Box

JUMP = PROTOCOL.constant("ENCODER_JUMP_COUNTS")
STILL = PROTOCOL.constant("ENCODER_STILL_PERIODS")
RAMP = PROTOCOL.constant("RAMP_PERIODS")
AXES = ["psi_counts", "phi_counts"]


def flying(psi_ref_rad: float = 0.5) -> Box:
    box = Box()
    box.tick()
    assert box.arm("FLYING") == "DONE"
    fly(box, psi_ref_rad)
    return box


def fly(box: Box, psi_ref_rad: float = 0.5) -> None:
    """One sample with its setpoint."""
    box.refer(psi_ref_rad)
    box.tick()


def move(box: Box, axis: str, counts: int) -> None:
    setattr(box, axis, getattr(box, axis) + counts)


@pytest.mark.parametrize("axis", AXES)
@pytest.mark.parametrize("sign", [1, -1])
def test_a_jump_ends_the_flight_by_the_ramp_although_the_host_is_there(axis, sign):
    box = flying()
    move(box, axis, sign * JUMP)
    duties = []
    for _ in range(RAMP):
        fly(box)
        duties.append(box.view.main_ticks)
    assert duties == [1600 * left // RAMP for left in range(RAMP - 1, -1, -1)]
    assert (box.state, box.view.power) == ("LOST", 0)
    assert (box.counters["encoder_faults"], box.counters["host_losses"]) == (1, 0)


@pytest.mark.parametrize("axis", AXES)
@pytest.mark.parametrize("sign", [1, -1])
def test_the_fastest_believable_turn_is_no_jump(axis, sign):
    box = flying()
    for _ in range(20):
        move(box, axis, sign * (JUMP - 1))
        fly(box)
    assert box.state == "FLYING"


def test_a_late_main_loop_may_see_as_many_counts_as_its_ticks_allow():
    box = flying()
    move(box, "psi_counts", 3 * JUMP - 1)
    box.refer(0.5)
    box.tick(passed=3)
    assert box.state == "FLYING"


def test_after_an_encoder_fault_flying_is_refused_until_preset_tells_where_the_plant_is():
    box = flying()
    move(box, "phi_counts", 5 * JUMP)
    for _ in range(RAMP):
        fly(box)
    assert box.arm("FLYING") == "POSITION_LOST"
    assert box.arm("LOOP") == "DONE"  # the host's own plant has encoders of its own
    box.ask("DISARM")
    assert box.reason(box.ask("PRESET", psi_counts=0, phi_counts=0)) == "DONE"
    assert box.arm("FLYING") == "DONE"
    fly(box)
    assert (box.state, box.counters["encoder_faults"]) == ("FLYING", 1)


def test_a_preset_just_before_take_off_is_no_jump():
    box = Box()
    box.psi_counts = 30_000
    box.tick()
    box.ask("PRESET", psi_counts=-700, phi_counts=9_000)
    box.arm("FLYING")
    fly(box)
    assert box.state == "FLYING"


def test_what_the_encoders_do_between_flights_is_no_fault():
    box = Box()
    for counts in (0, 30_000, -30_000, 7):
        box.psi_counts = counts
        box.tick()
    assert box.arm("FLYING") == "DONE"
    fly(box)
    assert (box.state, box.counters["encoder_faults"]) == ("FLYING", 0)


@pytest.mark.parametrize("psi_ref_rad", [1.5, -1.5])
def test_no_count_in_a_second_of_full_drive_ends_the_flight(psi_ref_rad):
    box = flying(psi_ref_rad)
    assert abs(box.view.main_ticks) == 3200
    for _ in range(STILL - 1):
        fly(box, psi_ref_rad)
    assert box.state == "FLYING"
    fly(box, psi_ref_rad)
    assert (box.state, box.counters["encoder_faults"]) == ("RAMPING", 1)


def test_one_count_is_enough_to_believe_an_encoder_for_another_second():
    box = flying(1.5)
    for _ in range(3):
        for _ in range(STILL - 1):
            fly(box, 1.5)
        move(box, "psi_counts", 1)
        fly(box, 1.5)
    assert box.state == "FLYING"


def test_a_still_encoder_below_full_drive_looks_like_a_plant_at_rest():
    box = flying(0.9)
    for _ in range(3 * STILL):
        fly(box, 0.9)
    assert box.state == "FLYING"


@pytest.mark.parametrize("start", [2**31 - 100, -(2**31) + 100])
def test_the_wrap_of_32_bits_is_no_jump(start):
    box = Box()
    box.psi_counts = start
    box.tick()
    box.arm("FLYING")
    for step in range(1, 5):
        wrapped = start + (50 * step if start > 0 else -50 * step)
        box.psi_counts = (wrapped + 2**31) % 2**32 - 2**31
        fly(box, 0.0)
    assert box.counters["encoder_faults"] == 0
