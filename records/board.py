"""The boards that the firmware runs on: every number of a chip, and which pin does what, once.

Whoever computes takes them from here. The C and the linker script state some of them as text, as one who reads them expects; a test
holds each of those, and those of the pages, against the record.
"""

from collections.abc import Mapping
from dataclasses import dataclass

from records.loops import Pins


@dataclass(frozen=True)
class Core:
    """A processor core: its title and architecture, and what the compiler and unicorn call it.

    Functions take floats in the registers of its floating-point unit, where it has one.
    """

    title: str
    architecture: str
    name: str
    unicorn: str
    has_float_unit: bool = False

    @property
    def abi(self) -> str:
        """The calling convention, as the compiler's target names it."""
        return "eabihf" if self.has_float_unit else "eabi"


@dataclass(frozen=True)
class Memory:
    """A stretch of the chip's address space."""

    start: int
    size_bytes: int

    @property
    def end(self) -> int:
        """First address behind it."""
        return self.start + self.size_bytes


@dataclass(frozen=True)
class Pin:
    """A pin by port and number; `function` is the number of its alternate function, None for a plain output."""

    port: str
    number: int
    function: int | None = None

    def __str__(self) -> str:
        return f"P{self.port}{self.number}"


@dataclass(frozen=True)
class Encoder:
    """A quadrature encoder on both inputs of a timer that counts modulo 2^bits."""

    timer: int
    bits: int
    a: Pin
    b: Pin


@dataclass(frozen=True)
class Motor:
    """A motor's driver: PWM from a timer's channel, and a direction that is high for negative inputs."""

    timer: int
    channel: int
    pwm: Pin
    direction: Pin


@dataclass(frozen=True)
class ConverterChannel:
    """An input of the converter, by the pin on which it is."""

    pin: Pin
    number: int


@dataclass(frozen=True)
class Converter:
    """The analogue-digital converter of this number, and the inputs of it that a board offers."""

    number: int
    channels: tuple[ConverterChannel, ...]


@dataclass(frozen=True)
class SerialLine:
    """The line to the host, and the number of its interrupt."""

    usart: int
    interrupt: int
    transmit: Pin
    receive: Pin


@dataclass(frozen=True)
class Tick:
    """The timer that gives the control tick, and the number of its interrupt."""

    timer: int
    interrupt: int


@dataclass(frozen=True)
class Board:
    """One chip and its wiring; its C is in `firmware/board/FOLDER/`, that of all chips alike in `firmware/board/FAMILY/`.

    `is_emulated` says whether `rig/emulator` is this chip; of any other only the core can be run. The flash is erased by pages and written
    by `flash_write_bytes`, where it is erased. An option bit, or a memory behind it, gives the RAM `largest_ram_bytes`; the link leaves
    `stack_reserve_bytes` of it to the stack. The chip's serial boot loader answers `boot_loader_id` to GET ID and keeps the first
    `boot_loader_ram_bytes` for itself. OpenOCD finds the board by `openocd_config`.
    """

    chip: str
    family: str
    folder: str
    core: Core
    is_emulated: bool
    flash: Memory
    flash_page_bytes: int
    flash_write_bytes: int
    flash_wait_states: int
    ram: Memory
    largest_ram_bytes: int
    stack_reserve_bytes: int
    oscillator_hz: int
    clock_hz: int
    interrupt_count: int
    elevation_encoder: Encoder
    azimuth_encoder: Encoder
    main_motor: Motor
    tail_motor: Motor
    converter: Converter
    line: SerialLine
    tick: Tick
    boot_loader_id: int
    boot_loader_ram_bytes: int
    openocd_config: str

    @property
    def encoders(self) -> tuple[Encoder, ...]:
        """Its encoders."""
        return self.elevation_encoder, self.azimuth_encoder

    @property
    def motors(self) -> tuple[Motor, ...]:
        """Its motors' drivers."""
        return self.main_motor, self.tail_motor

    def channel_of(self, pins: Pins) -> ConverterChannel | None:
        """The converter's input on these pins, where there is one."""
        name = None if pins.analogue is None else pins.analogue.pin
        return next((one for one in self.converter.channels if str(one.pin) == name), None)

    def encoder_of(self, pins: Pins) -> Encoder | None:
        """The encoder on these pins, where there is one."""
        return next((one for one in self.encoders if (str(one.a), str(one.b)) == pins.encoder), None)

    def motor_of(self, pins: Pins) -> Motor | None:
        """The driver on these pins, with or without its direction, where there is one."""
        return next(
            (one for one in self.motors if str(one.pwm) == pins.pwm and pins.direction in (None, str(one.direction))),
            None,
        )

    @property
    def interrupts(self) -> dict[str, int]:
        """Numbers of the interrupts in use, by peripheral."""
        return {f"TIM{self.tick.timer}": self.tick.interrupt, f"USART{self.line.usart}": self.line.interrupt}


def _channels(**numbers: int) -> tuple[ConverterChannel, ...]:
    """Inputs of a converter by the names of their pins."""
    return tuple(ConverterChannel(Pin(name[1], int(name[2:])), number) for name, number in numbers.items())


# RM0444 by section: memories 2.2.2, flash pages 3.3.1, wait states 3.3.4, writing by 64 bits 3.3.8, clocks 5.2, vectors 12.3, device id
# 40.10.1 (that of the STM32G081 too). 32 KiB of the RAM are there whatever the parity option says. The loader's RAM: AN2606.
STM32G071 = Board(
    chip="STM32G071",
    family="stm32",
    folder="stm32g071",
    core=Core("Cortex-M0+", "ARMv6-M", "cortex_m0plus", "CORTEX_M0"),
    is_emulated=True,
    flash=Memory(0x08000000, 128 * 1024),
    flash_page_bytes=2048,
    flash_write_bytes=8,
    flash_wait_states=2,
    ram=Memory(0x20000000, 32 * 1024),
    largest_ram_bytes=36 * 1024,
    stack_reserve_bytes=4 * 1024,
    oscillator_hz=16_000_000,
    clock_hz=64_000_000,
    interrupt_count=32,
    elevation_encoder=Encoder(timer=2, bits=32, a=Pin("A", 0, 2), b=Pin("A", 1, 2)),
    azimuth_encoder=Encoder(timer=3, bits=16, a=Pin("A", 6, 1), b=Pin("A", 7, 1)),
    main_motor=Motor(timer=1, channel=1, pwm=Pin("A", 8, 2), direction=Pin("B", 0)),
    tail_motor=Motor(timer=1, channel=2, pwm=Pin("A", 9, 2), direction=Pin("B", 1)),
    converter=Converter(1, _channels(PA0=0, PA1=1, PA4=4, PA5=5, PA6=6, PA7=7)),
    line=SerialLine(usart=2, interrupt=28, transmit=Pin("A", 2, 1), receive=Pin("A", 3, 1)),
    tick=Tick(timer=6, interrupt=17),
    boot_loader_id=0x460,
    boot_loader_ram_bytes=0x2700,
    openocd_config="board/st_nucleo_g0.cfg",
)

# RM0440 by section: memories 2.2 and 2.4, flash pages 3.3.1, wait states 3.3.3, writing by 64 bits 3.3.7, clocks 7.2, vectors 14.3,
# device id 47.6.1. Behind SRAM1 and SRAM2 the RAM goes on with 10 KiB of core-coupled memory, left alone here. The loader's RAM: AN2606.
STM32G431 = Board(
    chip="STM32G431",
    family="stm32",
    folder="stm32g431",
    core=Core("Cortex-M4F", "ARMv7E-M", "cortex_m4+vfp4d16sp", "CORTEX_M4", has_float_unit=True),
    is_emulated=False,
    flash=Memory(0x08000000, 128 * 1024),
    flash_page_bytes=2048,
    flash_write_bytes=8,
    flash_wait_states=4,
    ram=Memory(0x20000000, 22 * 1024),
    largest_ram_bytes=32 * 1024,
    stack_reserve_bytes=4 * 1024,
    oscillator_hz=16_000_000,
    clock_hz=128_000_000,
    interrupt_count=102,
    elevation_encoder=Encoder(timer=2, bits=32, a=Pin("A", 0, 1), b=Pin("A", 1, 1)),
    azimuth_encoder=Encoder(timer=3, bits=16, a=Pin("A", 6, 2), b=Pin("A", 7, 2)),
    main_motor=Motor(timer=1, channel=1, pwm=Pin("A", 8, 6), direction=Pin("B", 0)),
    tail_motor=Motor(timer=1, channel=2, pwm=Pin("A", 9, 6), direction=Pin("B", 1)),
    converter=Converter(2, _channels(PA0=1, PA1=2, PA4=17, PA5=13, PA6=3, PA7=4)),
    line=SerialLine(usart=2, interrupt=38, transmit=Pin("A", 2, 7), receive=Pin("A", 3, 7)),
    tick=Tick(timer=6, interrupt=54),
    boot_loader_id=0x468,
    boot_loader_ram_bytes=0x4000,
    openocd_config="board/st_nucleo_g4.cfg",
)

# The first is what a verb takes where none is named.
BOARDS: Mapping[str, Board] = {board.chip: board for board in (STM32G071, STM32G431)}
