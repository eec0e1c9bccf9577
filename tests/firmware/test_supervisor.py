"""Each transition of the supervisor, by frames and ticks; silence of the host ends at 0 V on both motors."""

import pytest

from records.protocol import PROTOCOL
from tests.firmware.box import COUNTS_TO_RAD, Box, word

LOSS = PROTOCOL.constant("HOST_LOSS_PERIODS")
RAMP = PROTOCOL.constant("RAMP_PERIODS")


def flying(psi_ref_rad: float = 0.5) -> Box:
    box = Box()
    assert box.arm("FLYING") == "DONE"
    box.refer(psi_ref_rad)
    box.tick()
    return box


def lost(mode: str) -> Box:
    box = Box()
    box.arm(mode)
    for _ in range(LOSS + RAMP):
        box.tick()
    assert box.state == "LOST"
    return box


def test_it_starts_disarmed_with_the_power_stage_off():
    view = Box().view
    assert (view.state, view.power, view.main_ticks, view.tail_ticks) == (0, 0, 0, 0)


@pytest.mark.parametrize("mode", ["FLYING", "LOOP"])
def test_arming_enters_the_mode_and_only_flying_may_have_power(mode):
    box = Box()
    assert box.arm(mode) == "DONE"
    assert box.state == mode
    assert box.view.power == (mode == "FLYING")


@pytest.mark.parametrize("position", range(8))
def test_arming_is_refused_with_another_table_by_any_byte(position):
    digest = bytearray(range(1, 33))
    digest[position] ^= 0x80
    box = Box()
    assert box.arm("LOOP", bytes(digest)) == "WRONG_TABLE"
    assert box.state == "DISARMED"


def test_arming_is_refused_for_an_unknown_mode():
    box = Box()
    assert box.reason(box.ask("ARM", mode=9, digest_head=bytes(range(1, 9)))) == "UNKNOWN_MODE"
    assert box.state == "DISARMED"


def test_arming_is_refused_when_the_self_test_has_failed():
    box = Box()
    box.lib.box_fail_self_test(box.path)
    assert box.arm("LOOP") == "SELF_TEST_FAILED"
    assert box.ask("SELF_TEST").number("mismatches") == 1
    assert box.state == "DISARMED"


def test_arming_again_in_the_same_mode_changes_nothing():
    box = Box()
    box.arm("LOOP")
    box.sample()
    assert box.arm("LOOP") == "DONE"
    box.sample()
    assert box.view.steps == 2


def test_arming_in_another_mode_is_refused_while_armed():
    box = Box()
    box.arm("LOOP")
    assert box.arm("FLYING") == "OTHER_MODE"
    assert box.state == "LOOP"


@pytest.mark.parametrize("mode", ["FLYING", "LOOP"])
def test_disarming_is_immediate_and_zero(mode):
    box = Box()
    box.arm(mode)
    box.tick()
    assert box.reason(box.ask("DISARM")) == "DONE"
    view = box.view
    assert (box.state, view.power, view.main_ticks, view.tail_ticks) == ("DISARMED", 0, 0, 0)


@pytest.mark.parametrize("mode", ["FLYING", "LOOP"])
def test_the_host_is_lost_after_ten_missed_samples_and_not_before(mode):
    box = Box()
    box.arm(mode)
    states = []
    for _ in range(LOSS):
        box.tick()
        states.append(box.state)
    assert states == [mode] * (LOSS - 1) + ["RAMPING"]
    assert box.counters["host_losses"] == 1


def test_a_setpoint_each_nine_samples_keeps_the_host():
    box = flying()
    for _ in range(20):
        box.refer(0.5)
        for _ in range(LOSS - 1):
            box.tick()
    assert box.state == "FLYING"


def test_other_frames_do_not_stand_in_for_setpoints():
    box = flying()
    for _ in range(LOSS):
        box.ask("GET_COUNTERS")
        box.tick()
    assert box.state == "RAMPING"


@pytest.mark.parametrize("psi_ref_rad", [0.5, -0.5])
def test_the_ramp_is_linear_monotone_and_ends_at_zero_with_the_power_off(psi_ref_rad):
    box = flying(psi_ref_rad)
    for _ in range(LOSS - 2):
        box.tick()
    start = (box.view.main_ticks, box.view.tail_ticks)
    assert abs(start[0]) == 1600
    duties, powers = [], []
    for _ in range(RAMP):
        (frame,) = box.tick()
        assert frame.number("u_M_V") == word(0.0)  # the law rests; what is applied are the duties
        duties.append((box.view.main_ticks, box.view.tail_ticks))
        powers.append(box.view.power)
    assert powers == [1] * (RAMP - 1) + [0]
    for axis in (0, 1):
        expected = [int(start[axis] * left / RAMP) for left in range(RAMP - 1, -1, -1)]
        assert [pair[axis] for pair in duties] == expected
    assert duties[-1] == (0, 0)
    assert box.state == "LOST"
    assert RAMP <= 10


def test_a_ramp_in_the_loop_is_told_and_never_powered():
    box = Box()
    box.arm("LOOP")
    box.sample(psi_ref_rad=0.5)
    states, powers = [], []
    for _ in range(LOSS + RAMP):
        states += [frame.number("state") for frame in box.tick()]
        powers.append(box.view.power)
    enumeration = PROTOCOL.enumeration("state")
    assert states == [enumeration.code("RAMPING")] * (RAMP - 1) + [enumeration.code("LOST")]
    assert powers == [0] * (LOSS + RAMP)


def test_arming_anew_starts_from_zero_and_not_from_the_last_flight():
    box = flying(0.5)
    assert box.view.main_ticks == 1600
    box.ask("DISARM")
    box.arm("FLYING")
    assert (box.view.main_ticks, box.view.tail_ticks) == (0, 0)


@pytest.mark.parametrize(("psi_ref_rad", "duty"), [(1.5, 3200), (-1.5, -3200), (9.0, 3200)])
def test_duties_beyond_full_scale_are_clamped(psi_ref_rad, duty):
    assert flying(psi_ref_rad).view.main_ticks == duty


def test_the_law_rests_while_the_ramp_runs():
    box = flying()
    for _ in range(LOSS - 1):
        box.tick()
    steps = box.view.steps
    box.tick()
    assert box.state == "RAMPING"
    assert box.view.steps == steps


@pytest.mark.parametrize("mode", ["FLYING", "LOOP"])
def test_setpoints_alone_do_not_bring_a_lost_board_back(mode):
    box = lost(mode)
    words = {"psi_ref_rad": word(0.0), "phi_ref_rad": word(0.0)}
    assert box.reason(box.ask("REFERENCE", **words)) == "NOT_ARMED"
    assert box.reason(box.sample()) == "NOT_ARMED"
    box.tick()
    assert box.state == "LOST"


@pytest.mark.parametrize("mode", ["FLYING", "LOOP"])
def test_arming_brings_a_lost_board_back_with_a_fresh_law(mode):
    box = lost(mode)
    box.psi_counts = 100
    assert box.arm(mode) == "DONE"
    if mode == "LOOP":
        box.sample()
    else:
        box.tick()
    assert box.state == mode
    assert box.view.steps == 1


def test_arming_during_the_ramp_brings_it_back():
    box = flying()
    for _ in range(LOSS):
        box.tick()
    assert box.state == "RAMPING"
    assert box.arm("FLYING") == "DONE"
    box.tick()
    assert box.state == "FLYING"


def test_it_holds_the_place_where_it_was_armed_until_a_reference_comes():
    box = Box()
    box.psi_counts, box.phi_counts = 100, -50
    box.tick()
    box.arm("FLYING")
    box.tick()
    assert box.view.psi_start_rad == pytest.approx(100 * COUNTS_TO_RAD, rel=1e-6)
    assert box.view.phi_start_rad == pytest.approx(-50 * COUNTS_TO_RAD, rel=1e-6)
    assert box.view.psi_ref_rad == box.view.psi_start_rad
    assert box.view.main_ticks == 0


def test_only_the_latest_reference_counts():
    box = flying()
    for reference in (0.1, 0.2, 0.3):
        assert box.refer(reference) == []
    box.tick()
    assert box.view.psi_ref_rad == pytest.approx(0.3, rel=1e-6)


def test_one_step_of_the_law_for_each_sample():
    box = Box()
    box.arm("LOOP")
    for _ in range(50):
        box.sample()
    box.tick()
    assert box.view.steps == 50


def test_the_law_restarts_at_the_angles_that_the_host_names():
    box = Box()
    box.arm("LOOP")
    box.sample()
    assert box.reason(box.ask("RESET_LAW", psi_rad=word(0.25), phi_rad=word(-0.5))) == "DONE"
    assert (box.view.steps, box.view.psi_start_rad, box.view.phi_start_rad) == (0, 0.25, -0.5)
    box.sample()
    assert box.view.psi_start_rad == 0.25


def test_telemetry_comes_each_tick_of_a_flight_to_its_very_end_and_only_then():
    box = Box()
    assert box.tick() == []
    box.arm("FLYING")
    states = []
    for _ in range(LOSS + RAMP + 3):
        states += [frame.number("state") for frame in box.tick()]
    names = {choice.code: choice.name for choice in PROTOCOL.enumeration("state").choices}
    expected = ["FLYING"] * (LOSS - 1) + ["RAMPING"] * (RAMP - 1) + ["LOST"]
    assert [names[code] for code in states] == expected


def test_telemetry_reports_encoders_references_inputs_and_the_last_accepted_frame():
    box = flying(0.5)
    box.psi_counts, box.phi_counts = 10, -20
    box.refer(0.75)
    (frame,) = box.tick()
    assert (frame.number("psi_counts"), frame.number("phi_counts")) == (10, -20)
    assert frame.number("psi_ref_rad") == word(0.75)
    assert frame.number("echo_sequence") == box.sequence - 1
    assert frame.number("device_time_us") == box.now_us
    assert frame.number("duty_main_ticks") == box.view.main_ticks


def test_preset_names_the_present_position_and_is_refused_while_armed():
    box = Box()
    box.psi_counts, box.phi_counts = 1000, -2000
    box.tick()
    assert box.reason(box.ask("PRESET", psi_counts=-300, phi_counts=40)) == "DONE"
    box.psi_counts += 5
    box.arm("FLYING")
    assert box.reason(box.ask("PRESET", psi_counts=0, phi_counts=0)) == "ARMED"
    (frame,) = box.tick()
    assert (frame.number("psi_counts"), frame.number("phi_counts")) == (-295, 40)


def test_identity_tells_schema_table_and_reset():
    frame = Box().ask("IDENTIFY")
    assert frame.octets("schema_hash") == PROTOCOL.schema_hash
    assert frame.octets("table_digest") == bytes(range(1, 33))
    assert frame.number("sample_period_us") == 10_000
    assert frame.octets("unique_id")[0] == 0xA0
    assert frame.number("reset_cause") == PROTOCOL.enumeration("reset_cause").code("WATCHDOG")
