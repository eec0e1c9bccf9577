"""The real image when the main loop is late, the stack overflows, the encoders brown out or the outputs are at their limits."""

import pytest

from records.protocol import PROTOCOL
from rig.emulator.answers import BoardConfig
from tests.firmware.desk import Desk
from tests.rig.emulator.probe import set_registers

TICK_S = 0.01
WATCHDOG_S = 0.125
LOSS = PROTOCOL.constant("HOST_LOSS_PERIODS")
RAMP = PROTOCOL.constant("RAMP_PERIODS")
JUMP = PROTOCOL.constant("ENCODER_JUMP_COUNTS")
FULL_DRIVE = 3200
# Thumb: push {r0}; movs r1, #60; 1: subs r1, #1; bne 1b; b to the push: 4 bytes of stack each 190 cycles or so.
DIG_DOWN = bytes.fromhex("01b4 3c21 0139 fdd1 fae7".replace(" ", ""))
PUSH_FOR_EVER = bytes.fromhex("ffb4 fde7".replace(" ", ""))  # push {r0-r7}; b to it


@pytest.fixture
def desk(stand_in) -> Desk:
    return flying(Desk(stand_in, config=BoardConfig(stop_on_fault=False)))


def flying(desk: Desk, psi_ref_rad: float = 0.5) -> Desk:
    """Armed, with drive on the main motor, at rest just after a tick."""
    desk.arm("FLYING")
    desk.board.run_until_symbol("TIM6_Handler", desk.board.time_s + 2 * TICK_S)
    desk.run(0.001)
    fly(desk, psi_ref_rad)
    assert desk.drives
    return desk


def fly(desk: Desk, psi_ref_rad: float = 0.5) -> None:
    """One sample with its setpoint."""
    desk.refer(psi_ref_rad)
    desk.run(TICK_S)


def jump_to(desk: Desk, code: bytes) -> None:
    """The next control step goes astray into `code`, interrupts on."""
    desk.board.run_until_symbol("path_tick", desk.board.time_s + 2 * TICK_S)
    address = desk.board.scratch_address()
    desk.board.write_memory(address, bytes.fromhex("62b6") + code)  # cpsie i
    registers = desk.board.registers()
    set_registers(desk.board, [*registers[:15], address, registers[16]])


def starts_anew(desk: Desk) -> None:
    """The watchdog has reset the board, it says so, and it flies again."""
    assert [reset.cause for reset in desk.board.resets] == ["power", "watchdog"]
    desk.start()
    desk.board.uart_read()
    cause = PROTOCOL.enumeration("reset_cause").code("WATCHDOG")
    assert desk.ask("IDENTIFY").number("reset_cause") == cause
    assert desk.state == "DISARMED"
    flying(desk)


@pytest.mark.parametrize("late", range(2, LOSS + 5))
def test_ticks_that_the_main_loop_missed_count_as_samples_without_a_host(desk, late):
    desk.poke("ticks", desk.peek("ticks") + late - 1)
    desk.run(TICK_S)
    missed = 1 + late  # one since the last setpoint, before the clock jumped
    left = RAMP if missed < LOSS else max(0, RAMP - 1 - (missed - LOSS))
    seen = desk.board.pwm().main_ticks
    assert seen in (
        1600 * left // RAMP,
        1600 * max(0, RAMP - 1 - (missed - 1 - LOSS)) // RAMP if missed > LOSS else 1600,
    )
    assert desk.counters["tick_overruns"] == late - 1


def test_a_clock_that_runs_backward_is_a_lost_host_and_no_more(desk):
    desk.poke("ticks", desk.peek("ticks") - 5)
    desk.run(TICK_S)
    assert not desk.drives
    assert desk.state == "LOST"
    flying(desk)


def test_a_stack_that_leaves_its_reserve_is_found_by_the_next_tick_although_the_main_loop_is_lost(desk):
    jump_to(desk, DIG_DOWN)
    begin_s = desk.board.time_s
    desk.board.run_until_s(begin_s + 0.0008)
    assert desk.board.stack_bytes < 4096
    assert desk.drives
    desk.board.run_until_s(begin_s + 1.02 * TICK_S)
    assert 4096 + 32 < desk.board.stack_bytes < 28_672  # out of its reserve, not yet in the variables
    assert not desk.drives
    desk.board.run_until_s(begin_s + WATCHDOG_S + 2 * TICK_S)
    starts_anew(desk)


def test_a_stack_that_runs_over_all_variables_before_a_tick_ends_in_a_fault(desk):
    jump_to(desk, PUSH_FOR_EVER)
    begin_s = desk.board.time_s
    desk.board.run_until_s(begin_s + 0.1 * TICK_S)
    assert desk.board.stack_bytes > 28_672
    assert not desk.drives
    desk.board.run_until_s(begin_s + WATCHDOG_S + 2 * TICK_S)
    starts_anew(desk)


@pytest.mark.parametrize(
    ("timer", "counts"), [(2, JUMP), (2, -JUMP), (3, JUMP), (3, -JUMP), (3, 32_000), (2, 2**31 - 1)]
)
def test_encoders_that_brown_out_and_come_back_elsewhere_end_the_flight(desk, timer, counts):
    desk.board.set_encoder(timer, counts)
    for _ in range(RAMP + 1):
        fly(desk)
    assert not desk.drives
    assert desk.counters["encoder_faults"] == 1
    assert desk.state == "LOST"


@pytest.mark.parametrize("psi_ref_rad", [9.0, -9.0])
def test_the_outputs_at_their_limits_are_full_drive_and_no_more(desk, psi_ref_rad):
    for _ in range(20):
        fly(desk, psi_ref_rad)
        pwm = desk.board.pwm()
        assert (pwm.main_ticks, pwm.period_ticks, pwm.enabled) == (FULL_DRIVE, FULL_DRIVE, True)
        assert pwm.tail_ticks <= FULL_DRIVE
    assert desk.board.gpio("B").drives(0) is (psi_ref_rad < 0)


def test_a_frozen_encoder_at_full_drive_ends_the_flight_after_a_second(desk):
    samples = 0
    while desk.drives:
        fly(desk, 9.0)
        samples += 1
    assert samples == PROTOCOL.constant("ENCODER_STILL_PERIODS") + RAMP
    assert desk.counters["encoder_faults"] == 1
