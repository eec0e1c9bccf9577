"""The real image on the emulated board: clocks, encoders, outputs, serial line at full speed, watchdog, faults."""

import pytest

from codegen.law import generate_law
from records.board import STM32G071
from records.protocol import PROTOCOL
from rig.emulator.answers import BoardConfig
from rig.emulator.board import EmulatedBoard
from rig.programming.image import FIRMWARE_DIR, build_firmware, linker_script
from tests.firmware.box import DIGEST, sample_words, stand_in_law, word
from tests.firmware.desk import MODES, STATES, Desk
from tests.law_tables import ce150_table
from tests.rig.emulator.probe import set_registers
from tests.soak import SOAK
from toolchain.host import CText
from toolchain.target import TARGET_FLAGS, build_image

BIT_S = 1.0 / 921_600
TICK_S = 0.01
WATCHDOG_S = 0.125
LOSS = PROTOCOL.constant("HOST_LOSS_PERIODS")
RAMP = PROTOCOL.constant("RAMP_PERIODS")
CAUSES = {choice.code: choice.name for choice in PROTOCOL.enumeration("reset_cause").choices}


@pytest.fixture(scope="module")
def float32() -> bytes:
    return build_firmware(generate_law(ce150_table())).elf


@pytest.fixture
def desk(stand_in) -> Desk:
    return Desk(stand_in)


def test_it_comes_up_at_64_MHz_with_every_output_off(desk):
    pwm = desk.board.pwm()
    assert desk.board.clock_hz == STM32G071.clock_hz
    assert (pwm.enabled, pwm.main_ticks, pwm.tail_ticks, pwm.period_ticks) == (False, 0, 0, 3200)
    assert [desk.board.gpio("B").drives(pin) for pin in (0, 1)] == [False, False]
    assert [desk.board.gpio("A").mode >> 2 * pin & 3 for pin in (0, 1, 2, 3, 6, 7, 8, 9)] == [2] * 8


def test_a_seal_takes_the_cycles_that_the_page_says(float32):
    # Truth: docs/faults.md, some 700 cycles, within a tenth.
    board = EmulatedBoard(float32)
    assert board.call("path_seal", board.scratch_address()).cycles_flash == pytest.approx(700, rel=0.1)


def test_it_starts_from_the_serial_boot_loader_as_from_a_reset(desk):
    # The loader leaves its own vectors, system memory at address 0 and a clock of 24 MHz from the PLL.
    desk.board.start_from_boot_loader(STM32G071.flash.start)
    assert desk.board.clock_hz == 24_000_000
    desk.start()
    assert desk.board.clock_hz == STM32G071.clock_hz
    desk.sequence = 0
    desk.ask("IDENTIFY")
    first = desk.ask("GET_COUNTERS").number("device_time_us")
    desk.run(1.0)
    assert desk.ask("GET_COUNTERS").number("device_time_us") - first == pytest.approx(1.003e6, abs=20)
    desk.arm("FLYING")
    desk.run(3 * TICK_S)
    assert desk.board.pwm().enabled


def test_it_tells_who_it_is(desk):
    identity = desk.ask("IDENTIFY")
    unique_id = b"".join(part.to_bytes(4, "little") for part in desk.board.config.unique_id)
    assert identity.octets("unique_id") == unique_id
    assert identity.octets("table_digest") == DIGEST
    assert CAUSES[identity.number("reset_cause")] == "POWER"


def test_its_clock_and_its_tick_keep_time(desk):
    first = desk.ask("GET_COUNTERS").number("device_time_us")
    start_s = desk.board.time_s
    desk.run(1.0)
    later = desk.ask("GET_COUNTERS").number("device_time_us")
    assert later - first == pytest.approx(
        (desk.board.time_s - start_s) * 1e6, abs=20
    )  # what the main loop needs to answer
    assert desk.peek("ticks") == later // 10_000


@pytest.mark.parametrize("direction", [1, -1])
@pytest.mark.parametrize("wrap", [32_768, 65_536])
def test_flying_follows_the_encoders_over_the_wrap_of_the_16_bit_counter(desk, wrap, direction):
    for turned in range(0, wrap - 600, 20_000):
        desk.board.set_encoder(3, direction * turned)
        desk.run(TICK_S)
    desk.board.set_encoder(3, direction * (wrap - 600))
    desk.run(TICK_S)
    desk.arm("FLYING")
    seen = []
    for step in range(1, 8):
        desk.board.set_encoder(2, -direction * 250 * step)
        desk.board.set_encoder(3, direction * (wrap - 600 + 200 * step))
        desk.refer(0.0)
        seen += [f for f in desk.run(TICK_S) if f.message.name == "TELEMETRY"]
    counts = [(f.number("psi_counts"), f.number("phi_counts")) for f in seen]
    assert counts == [(-direction * 250 * k, direction * (wrap - 600 + 200 * k)) for k in range(1, 8)]


@pytest.mark.parametrize("psi_ref_rad", [0.5, -0.5])
def test_flying_drives_magnitude_and_direction(desk, psi_ref_rad):
    desk.arm("FLYING")
    desk.refer(psi_ref_rad)
    desk.run(TICK_S)
    pwm = desk.board.pwm()
    assert (pwm.enabled, pwm.main_ticks) == (True, 1600)
    assert desk.board.gpio("B").drives(0) is (psi_ref_rad < 0)
    desk.ask("DISARM")
    assert (desk.board.pwm().enabled, desk.board.pwm().main_ticks) == (False, 0)


def test_in_the_loop_the_power_stage_stays_off_and_the_duties_follow(desk):
    desk.arm("LOOP")
    answer = desk.ask("SAMPLE", **sample_words(0.5, 0.25))
    assert answer.number("u_M_V") == word(2.5)
    assert (answer.number("duty_main_ticks"), desk.board.pwm().main_ticks) == (800, 800)
    assert desk.board.pwm().enabled is False


def test_a_silent_host_means_a_linear_ramp_to_zero_and_power_off(desk):
    desk.arm("FLYING")
    desk.refer(0.5)
    desk.run(0.1 * TICK_S)
    duties, powers = [], []
    for _ in range(LOSS + RAMP + 1):
        desk.run(TICK_S)
        duties.append(desk.board.pwm().main_ticks)
        powers.append(desk.board.pwm().enabled)
    ramp = [1600 * left // RAMP for left in range(RAMP - 1, -1, -1)]
    held = LOSS - 1
    assert duties == [1600] * held + ramp + [0] * (len(duties) - held - RAMP)
    assert powers == [True] * (held + RAMP - 1) + [False] * (len(powers) - held - RAMP + 1)
    assert desk.state == "LOST"


def test_no_byte_is_lost_at_full_line_speed_while_the_float_law_flies(float32):
    desk = Desk(float32, bytes.fromhex(ce150_table().digest))
    desk.arm("FLYING")
    frames = 3000
    desk.board.uart_write(
        b"".join(desk.put("REFERENCE", psi_ref_rad=word(0.1), phi_ref_rad=word(0.0)) for _ in range(frames))
    )
    line_s = desk.board.uart_line_free_s() - desk.board.time_s
    assert line_s == pytest.approx(frames * 18 * 10 * BIT_S, rel=0.01)
    telemetry = [f for f in desk.run(line_s + 0.02) if f.message.name == "TELEMETRY"]
    counted = desk.counters
    assert counted["frames_accepted"] == frames + 2
    for name in ("uart_overruns", "rx_ring_overflows", "crc_errors", "cobs_errors", "frames_lost", "tick_overruns"):
        assert counted[name] == 0, name
    assert len(telemetry) == pytest.approx(line_s / TICK_S, abs=4)
    assert desk.receiver.received.noise == 0
    law_time_s = telemetry[-1].number("law_cycles") / desk.board.clock_hz
    assert law_time_s > 3 * 10 * BIT_S  # the law outlasts several bytes: only the receive interrupt can have saved them


def test_replies_that_find_no_room_are_dropped_whole_and_counted(desk):
    requests = 60
    desk.board.uart_write(b"".join(desk.put("IDENTIFY") for _ in range(requests)))
    frames = desk.run(0.1)
    dropped = desk.counters["tx_frames_dropped"]
    assert 0 < dropped < requests
    assert len(frames) + dropped == requests
    assert (desk.receiver.received.noise, desk.receiver.received.foreign) == (0, 0)


def test_samples_back_to_back_are_each_one_step(desk):
    desk.arm("LOOP")
    desk.board.uart_write(b"".join(desk.put("SAMPLE", **sample_words(0.001 * k, 0.0)) for k in range(200)))
    answers = [f for f in desk.run(0.1) if f.message.name == "ANSWER"]
    counted = desk.counters
    assert len(answers) + counted["tx_frames_dropped"] == 200
    assert answers[0].number("u_T_V") == word(0.001)
    assert desk.ask("SAMPLE", **sample_words(0.0, 0.0)).number("u_T_V") == word(0.201)


def test_stack_stays_far_from_its_limit(float32):
    desk = Desk(float32, bytes.fromhex(ce150_table().digest))
    desk.arm("FLYING")
    for _ in range(20):
        desk.refer(0.1)
        desk.run(TICK_S)
    assert desk.board.stack_bytes < 2048


def test_line_errors_of_a_wrong_speed_are_counted_and_cleared(desk):
    desk.board.set_host_baud(230_400)
    desk.board.uart_write(bytes(range(1, 200)) + b"\0")
    desk.run(0.02)
    desk.board.set_host_baud(921_600)
    desk.board.uart_write(b"\0")
    assert desk.ask("IDENTIFY").message.name == "IDENTITY"
    counted = desk.counters
    assert counted["uart_framing_errors"] + counted["uart_noise_errors"] > 0
    assert counted["uart_overruns"] == 0


def test_a_byte_that_comes_just_before_the_sleep_is_not_slept_over(stand_in):
    """The last byte of a request arrives at each moment around the check before WFI; the answer never waits for a tick."""
    learning = Desk(stand_in)
    learning.board.run_until_symbol("TIM6_Handler", learning.board.time_s + 2 * TICK_S)
    learning.board.run_until_symbol("board_sleep", learning.board.time_s + TICK_S)
    sleep_s = learning.board.time_s
    for cycles in range(-80, 100, 4 if SOAK else 12):
        desk = Desk(stand_in)
        line = desk.put("IDENTIFY")
        desk.board.uart_write(line[:-1])
        desk.board.uart_write(line[-1:], earliest_s=sleep_s + cycles / 64e6 - 9.5 * BIT_S)
        desk.run(sleep_s + 0.002 - desk.board.time_s)
        assert desk.receiver.received.frames == 1, cycles


def test_a_late_main_loop_counts_every_tick_that_it_missed(desk):
    desk.poke("ticks", desk.peek("ticks") + 3)
    desk.run(2 * TICK_S)
    assert desk.counters["tick_overruns"] == 3


def test_a_receive_ring_that_is_full_counts_every_byte_that_it_lost(desk):
    place = desk.board.registers()
    desk.hang()
    desk.board.uart_write(b"\x01" * 600)
    desk.run(600 * 10 * BIT_S + 0.0005)
    set_registers(desk.board, [*place[:16], place[16]])
    desk.run(TICK_S)  # until the ring is empty again
    desk.board.uart_write(b"\0")
    counted = desk.counters
    assert counted["rx_ring_overflows"] == 600 - 512
    assert counted["too_long"] == 1
    assert counted["tick_overruns"] == 0


def test_a_control_step_that_hangs_is_ended_by_the_watchdog_with_the_outputs_off(desk):
    desk.arm("FLYING")
    desk.refer(0.5)
    desk.run(TICK_S)
    assert desk.board.pwm().enabled
    desk.hang()
    hung_s = desk.board.time_s
    desk.run(0.4)
    first, second = desk.board.resets
    assert (first.cause, second.cause) == ("power", "watchdog")
    assert second.time_s - hung_s <= WATCHDOG_S
    assert desk.board.pwm().enabled is False
    identity = desk.ask("IDENTIFY")
    assert CAUSES[identity.number("reset_cause")] == "WATCHDOG"
    assert STATES[identity.number("state")] == "DISARMED"
    assert desk.counters["resets"] == 1
    desk.hang()
    desk.run(0.4)
    assert desk.counters["resets"] == 2


def test_a_start_that_hangs_is_tried_again_with_the_outputs_off():
    hanging = stand_in_law()
    hanging["law.c"] = hanging["law.c"].replace("law_state state;\n", "law_state state;\n    for (;;) {\n    }\n", 1)
    board = EmulatedBoard(build_firmware(hanging).elf)
    board.run_until_s(4.5)
    assert [reset.cause for reset in board.resets] == ["power", "watchdog", "watchdog"]
    assert board.resets[1].time_s == pytest.approx(2.0, rel=0.1)
    assert board.pwm().enabled is False


def test_a_healthy_board_is_never_reset_by_its_watchdog(desk):
    desk.run(5.0)
    assert [reset.cause for reset in desk.board.resets] == ["power"]


def test_a_fault_turns_the_rotors_off_at_once(stand_in):
    desk = Desk(stand_in, config=BoardConfig(stop_on_fault=False))
    desk.arm("FLYING")
    desk.refer(0.5)
    desk.run(TICK_S)
    desk.board.run_until_symbol("path_tick", desk.board.time_s + 2 * TICK_S)
    assert desk.board.pwm().enabled
    registers = desk.board.registers()
    set_registers(desk.board, [*registers[:15], 0x60000000, registers[16]])
    desk.board.run_for(200)
    assert desk.board.pwm().enabled is False
    desk.board.run_until_s(desk.board.time_s + 0.4)
    assert desk.board.resets[-1].cause == "watchdog"


def test_the_reset_button_is_told_from_power(desk):
    desk.board.reset()
    desk.start()
    desk.board.uart_read()
    assert CAUSES[desk.ask("IDENTIFY").number("reset_cause")] == "PIN"


def test_the_float_law_in_the_loop_says_how_long_it_took(float32):
    desk = Desk(float32, bytes.fromhex(ce150_table().digest))
    desk.arm("LOOP")
    cycles = [desk.ask("SAMPLE", **sample_words(0.1, 0.0)).number("law_cycles") for _ in range(5)]
    assert min(cycles) > 1000
    assert max(cycles) < 64_000_000 * TICK_S


START = CText(
    "start.c",
    """
    #include "law.h"
    extern uint32_t _stack_top;
    void Reset_Handler(void);
    void Reset_Handler(void) { for (;;) { (void)law_self_test(); } }
    __attribute__((section(".vectors"), used)) static void *const VECTORS[] = {&_stack_top, (void *)Reset_Handler};
    """,
)


@pytest.mark.parametrize("optimisation", ["-O0", "-Os"])
def test_the_law_passes_its_self_test_however_it_is_optimised(optimisation):
    """The law and what the compiler calls from it, without the rest of the firmware."""
    folder = FIRMWARE_DIR / "board"
    texts = [CText(name, text) for name, text in generate_law(ce150_table()).items()]
    sources = [START, folder / "float_routines.c", folder / "memory.c", *texts]
    flags = (optimisation, *(flag for flag in TARGET_FLAGS if not flag.startswith("-O")))
    board = EmulatedBoard(build_image("law", sources, linker_script(STM32G071), flags=flags))
    assert board.call("law_self_test").result == 0


def test_a_self_test_that_fails_on_the_board_forbids_arming():
    failing = stand_in_law()
    failing["law.c"] = failing["law.c"].replace("== 2.5f ? 0u : 1u", "== 2.5f ? 7u : 1u")
    desk = Desk(build_firmware(failing).elf)
    assert desk.ask("SELF_TEST").number("mismatches") == 7
    result = desk.ask("ARM", mode=MODES["LOOP"], digest_head=DIGEST[:8])
    assert result.number("reason") == PROTOCOL.enumeration("reason").code("SELF_TEST_FAILED")
