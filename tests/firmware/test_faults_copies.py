"""A copy of a frame, held back by a bridge or a driver and delivered late: it is answered and does not act again."""

import pytest

from records.protocol import PROTOCOL
from tests.firmware.box import DIGEST, Box, word
from tests.firmware.desk import MODES

LOSS = PROTOCOL.constant("HOST_LOSS_PERIODS")
RAMP = PROTOCOL.constant("RAMP_PERIODS")
ZERO = {"psi_ref_rad": word(0.0), "phi_ref_rad": word(0.0)}


@pytest.mark.parametrize("mode", MODES)
def test_an_old_arm_does_not_start_a_board_that_has_lost_its_host(mode):
    box = Box()
    arm = box.line("ARM", mode=MODES[mode], digest_head=DIGEST[:8])
    box.feed(arm)
    for _ in range(LOSS + RAMP):
        box.tick()
    (answer,) = box.feed(arm)
    assert box.reason(answer) == "NOT_ARMED"
    assert box.state == "LOST"


def test_an_arm_whose_answer_was_lost_is_answered_again():
    box = Box()
    arm = box.line("ARM", mode=MODES["FLYING"], digest_head=DIGEST[:8])
    assert [box.reason(box.feed(arm)[0]) for _ in range(3)] == ["DONE"] * 3
    assert box.state == "FLYING"


def test_a_refused_arm_is_refused_again_for_the_same_reason():
    box = Box()
    arm = box.line("ARM", mode=MODES["FLYING"], digest_head=bytes(8))
    assert [box.reason(box.feed(arm)[0]) for _ in range(3)] == ["WRONG_TABLE"] * 3


def test_copies_of_one_reference_do_not_stand_in_for_a_host():
    box = Box()
    box.arm("FLYING")
    reference = box.line("REFERENCE", **ZERO)
    for _ in range(LOSS):
        assert box.feed(reference) == []
        box.tick()
    assert box.state == "RAMPING"


def test_a_refused_reference_says_so_each_time():
    box = Box()
    reference = box.line("REFERENCE", **ZERO)
    assert [box.reason(box.feed(reference)[0]) for _ in range(2)] == ["NOT_ARMED"] * 2


def test_an_old_preset_does_not_move_the_origin():
    box = Box()
    preset = box.line("PRESET", psi_counts=10, phi_counts=20)
    box.feed(preset)
    box.psi_counts, box.phi_counts = 100, 200
    box.tick()
    assert box.reason(box.feed(preset)[0]) == "DONE"
    box.arm("FLYING")
    (telemetry,) = box.tick()
    assert (telemetry.number("psi_counts"), telemetry.number("phi_counts")) == (110, 220)


def test_an_old_disarm_is_obeyed():
    box = Box()
    disarm = box.line("DISARM")
    box.feed(disarm)
    box.arm("FLYING")
    box.feed(disarm)
    assert box.state == "DISARMED"
