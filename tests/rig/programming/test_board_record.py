"""The record of a board against the chip's public description, and every text that repeats a number of it against the record."""

import re
from pathlib import Path

import modm_devices
import pytest
from modm_devices.parser import DeviceParser

from records.board import BOARDS, STM32G071, Board, Pin
from rig.emulator.native import FOLDER as EMULATOR
from rig.programming.image import FIRMWARE_DIR, board_folders, linker_script

ROOT = FIRMWARE_DIR.parent
# Which of the public descriptions is the chip's.
DESCRIPTIONS = {
    "STM32G071": ("stm32g0-71_81.xml", "stm32g071rbi6"),
    "STM32G431": ("stm32g4-31_41.xml", "stm32g431rbt6"),
}
# The public description names an interrupt by all that share it.
SHARED_INTERRUPTS = {"STM32G071": {"TIM6": "TIM6_DAC_LPTIM1"}, "STM32G431": {"TIM6": "TIM6_DAC"}}

every_board = pytest.mark.parametrize("board", BOARDS.values(), ids=list(BOARDS))


def described(board: Board) -> dict:
    """The public description of the chip, driver by driver."""
    file, name = DESCRIPTIONS[board.chip]
    devices = Path(modm_devices.__file__).parent / "resources" / "devices" / "stm32" / file
    chip = next(d for d in DeviceParser().parse(str(devices)).get_devices() if d.identifier.string == name)
    return {driver["name"]: driver for driver in chip.properties["driver"]}


def signals(board: Board) -> list[tuple[Pin, tuple[str, str, str]]]:
    """Each pin with an alternate function, and the peripheral's signal that it has to be."""
    found = [(motor.pwm, ("tim", motor.timer, f"ch{motor.channel}")) for motor in (board.main_motor, board.tail_motor)]
    for encoder in (board.elevation_encoder, board.azimuth_encoder):
        found += [(encoder.a, ("tim", encoder.timer, "ch1")), (encoder.b, ("tim", encoder.timer, "ch2"))]
    found += [
        (board.line.transmit, ("usart", board.line.usart, "tx")),
        (board.line.receive, ("usart", board.line.usart, "rx")),
    ]
    return [(pin, (driver, str(instance), name)) for pin, (driver, instance, name) in found]


def chip_text(board: Board, name: str) -> str:
    """A file of the chip's folder, or else of its family's."""
    _, family, chip = (folder / name for folder in board_folders(board))
    return (chip if chip.exists() else family).read_text(encoding="utf-8")


def defines(text: str) -> dict[str, int]:
    """Every `#define NAME 12u` of a text."""
    return {name: int(value) for name, value in re.findall(r"^#define (\w+) (\d+)u\b", text, re.MULTILINE)}


@every_board
def test_the_record_is_that_of_the_public_device_description(board: Board) -> None:
    drivers = described(board)
    flash, *rams = sorted(drivers["core"]["memory"], key=lambda memory: memory["name"] != "flash")
    positions = {vector["name"]: int(vector["position"]) for vector in drivers["core"]["vector"]}
    assert (board.flash.start, board.flash.size_bytes) == (
        int(flash["start"], 16),
        int(flash["size"]),
    )
    assert hex(board.ram.start) in {ram["start"] for ram in rams}
    assert board.largest_ram_bytes == sum(int(ram["size"]) for ram in rams)
    assert board.ram.size_bytes <= board.largest_ram_bytes
    assert board.flash.size_bytes % board.flash_page_bytes == 0
    assert board.interrupts == {
        name: positions[SHARED_INTERRUPTS[board.chip].get(name, name)] for name in board.interrupts
    }
    assert board.interrupt_count > max(positions.values())


@every_board
def test_each_pin_offers_its_signal_under_its_alternate_function(board: Board) -> None:
    pins = {(gpio["port"].upper(), int(gpio["pin"])): gpio["signal"] for gpio in described(board)["gpio"]["gpio"]}
    for pin, signal in signals(board):
        offered = {(s["driver"], s.get("instance"), s["name"]): s.get("af") for s in pins[pin.port, pin.number]}
        assert offered[signal] == str(pin.function), pin


@every_board
def test_each_analogue_pin_is_on_its_channel_of_the_converter(board: Board) -> None:
    pins = {(gpio["port"].upper(), int(gpio["pin"])): gpio["signal"] for gpio in described(board)["gpio"]["gpio"]}
    for channel in board.converter.channels:
        offered = {(s["driver"], s.get("instance"), s["name"]) for s in pins[channel.pin.port, channel.pin.number]}
        assert ("adc", str(board.converter.number), f"in{channel.number}") in offered, channel
    others = [pin for motor in board.motors for pin in (motor.pwm, motor.direction)]
    others += [board.line.transmit, board.line.receive]
    assert not {(pin.port, pin.number) for pin in others} & {
        (channel.pin.port, channel.pin.number) for channel in board.converter.channels
    }
    assert {channel.pin.port for channel in board.converter.channels} == {
        "A"
    }  # as firmware/board/stm32/analogue.c sets them


@every_board
def test_the_header_of_the_wiring_says_what_the_record_says(board: Board) -> None:
    elevation, azimuth, main, tail, line = (
        board.elevation_encoder, board.azimuth_encoder, board.main_motor, board.tail_motor, board.line,
    )  # fmt: skip
    text = chip_text(board, "wiring.h")
    assert defines(text) == {
        "BOARD_CLOCK_HZ": board.clock_hz,
        "ELEVATION_A_PIN": elevation.a.number,
        "ELEVATION_B_PIN": elevation.b.number,
        "ELEVATION_FUNCTION": elevation.a.function,
        "AZIMUTH_A_PIN": azimuth.a.number,
        "AZIMUTH_B_PIN": azimuth.b.number,
        "AZIMUTH_FUNCTION": azimuth.a.function,
        "MAIN_PWM_PIN": main.pwm.number,
        "TAIL_PWM_PIN": tail.pwm.number,
        "PWM_FUNCTION": main.pwm.function,
        "TRANSMIT_PIN": line.transmit.number,
        "RECEIVE_PIN": line.receive.number,
        "LINE_FUNCTION": line.transmit.function,
        "MAIN_DIRECTION_PIN": main.direction.number,
        "TAIL_DIRECTION_PIN": tail.direction.number,
    }
    told = {
        tuple(pins.split()): what
        for pins, what in re.findall(r" {2,}((?:P[AB]\d+ +)+)(\S.*?)(?= {2,}|$)", text, re.MULTILINE)
    }
    assert told == {
        (str(elevation.a), str(elevation.b)): f"elevation encoder (TIM{elevation.timer})",
        (str(azimuth.a), str(azimuth.b)): f"azimuth encoder (TIM{azimuth.timer})",
        (str(main.pwm), str(main.direction)): f"main motor PWM (TIM{main.timer} CH{main.channel}), direction",
        (str(tail.pwm), str(tail.direction)): f"tail motor PWM (TIM{tail.timer} CH{tail.channel}), direction",
        (str(line.transmit), str(line.receive)): f"serial line (USART{line.usart})",
    }


@every_board
def test_the_chips_sources_use_the_peripherals_of_the_record(board: Board) -> None:
    timers = {
        "encoders.c": {board.elevation_encoder.timer, board.azimuth_encoder.timer},
        "pwm.c": {board.main_motor.timer, board.tail_motor.timer},
        "tick.c": {board.tick.timer},
    }
    for name, numbers in timers.items():
        assert set(re.findall(r"\bTIM(\d+)(?:->|,)", chip_text(board, name))) == {str(number) for number in numbers}
    assert set(re.findall(r"\bUSART(\d+)->", chip_text(board, "usart.c"))) == {str(board.line.usart)}
    for encoder in (board.elevation_encoder, board.azimuth_encoder):
        assert f"encoder_timer_start(TIM{encoder.timer}, UINT{encoder.bits}_MAX)" in chip_text(board, "encoders.c")


@every_board
def test_registers_and_clock_are_set_as_the_record_says(board: Board) -> None:
    numbers = defines(chip_text(board, "chip.h"))
    numbers.pop("PRIORITY_BITS")
    interrupts = {name.removeprefix("IRQ_"): number for name, number in numbers.items() if name.startswith("IRQ_")}
    assert interrupts == {**board.interrupts, "COUNT": board.interrupt_count}
    clock = chip_text(board, "clock.c")
    (multiplier,), (latency,) = (
        re.findall(r"PLLN\((\d+)\) \| RCC_PLLCFGR_PLLR_2", clock),
        set(re.findall(r"LATENCY_(\d)", clock)),
    )
    assert board.oscillator_hz * int(multiplier) // 2 == board.clock_hz
    assert int(latency) == board.flash_wait_states


@every_board
def test_the_linker_script_says_what_the_record_says(board: Board) -> None:
    text = linker_script(board).text
    stretches = re.findall(r"ORIGIN = (\w+), LENGTH = (\w+)", text)
    memories = (board.flash, board.ram)
    assert [(int(start, 0), int(size)) for start, size in stretches] == [(of.start, of.size_bytes) for of in memories]
    assert re.findall(r"_stack_size = (\w+);", text) == [str(board.stack_reserve_bytes)]
    assert re.findall(r"_chip_(\w+) = 1;", text) == [board.chip]


def test_the_emulated_chip_raises_the_interrupts_of_the_record() -> None:
    timers, usart = ((EMULATOR / "peripherals" / name).read_text(encoding="utf-8") for name in ("timer.c", "usart.c"))
    ((numbers, names),) = re.findall(r"TIMER_IRQ\[\] = \{(.*?)\}; /\* (.*?) \*/", timers)
    raised = {name.split()[0]: int(number) for name, number in zip(names.split(", "), numbers.split(", "), strict=True)}
    raised |= {f"USART{n}": int(number) for n, number in re.findall(r"#define USART(\d)_IRQ (\d+)u", usart)}
    assert {name: raised[name] for name in STM32G071.interrupts} == STM32G071.interrupts


def test_the_emulated_chip_says_what_its_boot_loader_says_it_is() -> None:
    text = (EMULATOR / "peripherals" / "rcc.c").read_text(encoding="utf-8")
    (identity,) = re.findall(r"#define DEVICE_ID (0x\w+)u", text)
    assert int(identity, 16) & 0xFFF == STM32G071.boot_loader_id


def _counter(timer: int) -> int:
    """The address of a timer's counter, by the firmware's own header."""
    text = (ROOT / "firmware" / "board" / "stm32" / "stm32.h").read_text(encoding="utf-8")
    (base,) = re.findall(rf"#define TIM{timer} \(\(timer_registers \*\)(0x\w+?)u\)", text)
    (offset,) = re.findall(r"offsetof\(timer_registers, CNT\) == (0x\w+)", text)
    return int(base, 16) + int(offset, 16)


def test_the_pages_say_what_the_record_says() -> None:
    board = STM32G071
    pairs = {
        "elevation encoder": (board.elevation_encoder.a, board.elevation_encoder.b),
        "azimuth encoder": (board.azimuth_encoder.a, board.azimuth_encoder.b),
        "main": (board.main_motor.pwm, board.main_motor.direction),
        "tail": (board.tail_motor.pwm, board.tail_motor.direction),
        "serial line": (board.line.transmit, board.line.receive),
    }
    wired = {start: ", ".join(map(str, pins)) for start, pins in pairs.items()}
    hardware, firmware = ((ROOT / "docs" / name).read_text(encoding="utf-8") for name in ("hardware.md", "firmware.md"))
    for start, pins in wired.items():
        assert re.search(rf"^\| {start}\b[^|]*\| {pins} \|", hardware, re.MULTILINE), start
        assert re.search(rf"^\| {pins} \| {start}\b", firmware, re.MULTILINE), start
    assert f"(device id 0x{board.boot_loader_id:x})" in hardware
    assert f"openocd -f {board.openocd_config}" in hardware
    timers = (board.elevation_encoder.timer, board.azimuth_encoder.timer)
    assert f"TIM{timers[0]}->CNT and TIM{timers[1]}->CNT" in hardware
    assert all(f"mdw 0x{_counter(timer):08x}" in hardware for timer in timers)
    assert f"| line | {921_600:,} Bd 8N1 | {board.clock_hz // 10**6} MHz / 69".replace(",", " ") in hardware
    assert f"stack reserve ({board.stack_reserve_bytes // 1024} KiB)" in firmware
