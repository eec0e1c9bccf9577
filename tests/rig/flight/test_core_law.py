"""A chip that is not emulated: its image's law on unicorn's core, and what its start-up leaves in the registers."""

from dataclasses import dataclass, field, replace

import pytest
import unicorn
from unicorn import arm_const as arm

from codegen.law import generate_law
from codegen.law_equations import state_words
from records.board import BOARDS, STM32G071, STM32G431, Board
from records.errors import BadInput, VerificationFailed
from records.loops import ADC_CODES, Analogue, Pins
from rig.emulator.board import EmulatedBoard
from rig.flight.core_law import CoreLaw
from rig.programming.image import FirmwareImage, build_firmware
from tests.codegen.test_any_loops import any_table
from tests.law_tables import ce150_table
from tests.soak import SOAK, sampled
from twinlaw.workflows.chain.arithmetics import ARITHMETICS
from verification.equality import compare
from verification.host_law import HostLaw

STEPS = 100_000 if SOAK else 1_000


def image_of(board: Board, arithmetic: str) -> FirmwareImage:
    return build_firmware(generate_law(ce150_table(), arithmetic), board=board)


CASES = [(chip, arithmetic) for chip in BOARDS for arithmetic in ARITHMETICS]


@pytest.mark.parametrize(("chip", "arithmetic"), sampled(CASES, keep=[CASES[2]]))
def test_the_law_on_the_core_gives_the_bits_of_twin_and_host(chip: str, arithmetic: str) -> None:
    """Not one bit of 100 000 steps, NaN and broken states among them; 1 000 outside of a soak."""
    table = ce150_table()
    texts, stimuli = generate_law(table, arithmetic), ARITHMETICS[arithmetic].stimuli(table, STEPS)
    law = CoreLaw(image_of(BOARDS[chip], arithmetic), arithmetic, state_words(table))
    for other in (HostLaw(texts, arithmetic), ARITHMETICS[arithmetic].twin(table)):
        equality = compare(other, law, stimuli).equality
        assert equality.steps >= STEPS
        assert (equality.mismatches, equality.first_mismatch) == (0, None)
    assert law.self_test() == 0


# Register of the STM32G431 by its address in RM0440, and what it holds once the main loop sleeps for the first time.
RCC, FLASH_ACR, GPIOA, GPIOB = 0x4002_1000, 0x4002_2000, 0x4800_0000, 0x4800_0400
TIM1, TIM2, TIM3, TIM6, USART2 = 0x4001_2C00, 0x4000_0000, 0x4000_0400, 0x4000_1000, 0x4000_4400
STARTED = {
    "CPACR: the floating-point unit is everybody's": (0xE000_ED88, 0xF << 20),
    "VTOR: the vectors stand in the flash": (0xE000_ED08, STM32G431.flash.start),
    "FLASH_ACR: caches, prefetch, four wait states": (FLASH_ACR, 0x704),
    "RCC_PLLCFGR: 16 MHz x 16 / 2": (RCC + 0x0C, 1 << 24 | 16 << 8 | 2),
    "RCC_CFGR: the PLL, undivided": (RCC + 0x08, 3),
    "GPIOA_MODER: eight pins are of a peripheral": (GPIOA, 0b10_10_10_10_00_00_10_10_10_10),
    "GPIOA_AFRL": (GPIOA + 0x20, 0x2200_7711),
    "GPIOA_AFRH": (GPIOA + 0x24, 0x66),
    "GPIOB_MODER: two pins are outputs": (GPIOB, 0b01_01),
    "TIM1_PSC: ticks of 64 MHz": (TIM1 + 0x28, 1),
    "TIM1_ARR: 20 kHz": (TIM1 + 0x2C, 3199),
    "TIM1_BDTR: power off": (TIM1 + 0x44, 1 << 10),
    "TIM2_ARR": (TIM2 + 0x2C, 0xFFFF_FFFF),
    "TIM3_ARR": (TIM3 + 0x2C, 0xFFFF),
    "TIM6_PSC: microseconds": (TIM6 + 0x28, 127),
    "TIM6_ARR: a sample period": (TIM6 + 0x2C, 9999),
    "USART2_BRR: 921 600 Bd within 0.1 %": (USART2 + 0x0C, 139),
    "NVIC_ISER1: interrupts 38 and 54": (0xE000_E104, 1 << 22),  # a write is an order, the last one is seen
    "NVIC_IPR9: the line is the most urgent": (0xE000_E424, 0),
    "NVIC_IPR13: the tick is less so": (0xE000_E434, 3 << 20),
}  # fmt: skip


@dataclass
class Chip:
    """The core with plain memory for registers: no peripheral works, and the clock's ready bits follow its orders."""

    image: FirmwareImage
    uc: unicorn.Uc = field(init=False)

    def __post_init__(self) -> None:
        self.uc = unicorn.Uc(unicorn.UC_ARCH_ARM, unicorn.UC_MODE_THUMB | unicorn.UC_MODE_MCLASS)
        self.uc.ctl_set_cpu_model(arm.UC_CPU_ARM_CORTEX_M4)
        for start in (0x0800_0000, 0x1FFD_0000, 0x2000_0000, 0x4000_0000, 0x4800_0000, 0xE000_0000):
            self.uc.mem_map(start, 0x3_0000)
        self.uc.mem_write(STM32G431.flash.start, self.image.binary)
        self.uc.reg_write(arm.UC_ARM_REG_FPEXC, 1 << 30)
        self.uc.hook_add(unicorn.UC_HOOK_MEM_READ, self._settle, begin=RCC, end=RCC + 0x0B)

    def _settle(self, *_: object) -> None:
        control, source = self.word(RCC), self.word(RCC + 8)
        self.write(RCC, control & ~(1 << 25) | (control & 1 << 8) << 2 | (control & 1 << 24) << 1)
        self.write(RCC + 8, source & ~0xC | (source & 3) << 2)

    def run_to(self, function: str) -> None:
        stack, reset = (self.word(STM32G431.flash.start + offset) for offset in (0, 4))
        self.uc.reg_write(arm.UC_ARM_REG_SP, stack)
        self.uc.emu_start(reset, self.image.symbols[function].address, count=10_000_000)
        assert self.uc.reg_read(arm.UC_ARM_REG_PC) == self.image.symbols[function].address

    def word(self, address: int) -> int:
        return int.from_bytes(self.uc.mem_read(address, 4), "little")

    def write(self, address: int, word: int) -> None:
        self.uc.mem_write(address, word.to_bytes(4, "little"))


def test_the_start_of_the_STM32G431_sets_its_registers_and_reaches_the_main_loop() -> None:
    chip = Chip(image_of(STM32G431, "float32"))
    chip.run_to("board_sleep")
    found = {what: hex(chip.word(address)) for what, (address, _) in STARTED.items()}
    assert found == {what: hex(word) for what, (_, word) in STARTED.items()}


# The second converter of the STM32G431 and the registers common to both, RM0440 21.7 and 21.8, with the loop's sensor on PA4, its input 17.
ADC2, ADC_COMMON = 0x5000_0100, 0x5000_0300
CONVERTER_STARTED = {
    "GPIOA_MODER: PA4 is analogue, the line and the PWM are of a peripheral": (GPIOA, 0b10_00_00_00_11_10_10_00_00),
    "GPIOA_PUPDR: a resistor on PA3 alone": (GPIOA + 0x0C, 1 << 6),
    "RCC_AHB2ENR: both ports and the converter": (RCC + 0x4C, 1 << 13 | 3),
    "CCR: a quarter of 128 MHz": (ADC_COMMON + 0x08, 3 << 16),
    "SMPR1: 92.5 clocks for inputs 0 to 9": (ADC2 + 0x14, int("101" * 10, 2)),
    "SMPR2: and for 10 to 18": (ADC2 + 0x18, int("101" * 9, 2)),
    "SQR1: one conversion, of input 17": (ADC2 + 0x30, 17 << 6),
}
ADEN, ADSTART, ADVREGEN, ADCAL = 1, 1 << 2, 1 << 28, 1 << 31


@dataclass
class ChipWithConverter(Chip):
    """The same with a converter that converts to `code` at once, and notes the orders that it got; where it is silent, it never ends."""

    code: int = 0
    silent: bool = False
    orders: list[int] = field(default_factory=list)

    def __post_init__(self) -> None:
        super().__post_init__()
        self.uc.mem_map(0x5000_0000, 0x1000)
        self.uc.hook_add(unicorn.UC_HOOK_MEM_WRITE, self._order, begin=ADC2 + 8, end=ADC2 + 11)
        self.uc.hook_add(unicorn.UC_HOOK_MEM_READ, self._answer, begin=ADC2, end=ADC2 + 11)

    def _order(self, _uc: object, _access: int, _address: int, _size: int, value: int, _data: object) -> None:
        self.orders.append(value & 0xFFFF_FFFF)

    def _answer(self, *_: object) -> None:
        last = self.orders[-1]
        self.write(ADC2 + 8, last & ~ADCAL)
        ends = last & ADSTART and not self.silent
        self.write(ADC2, (1 if last & ADEN else 0) | (4 if ends else 0))
        self.write(ADC2 + 0x40, self.code)

    def read(self, channel: int) -> int:
        """What analogue_read() gives."""
        back = self.image.symbols["board_sleep"].address
        self.uc.reg_write(arm.UC_ARM_REG_R0, channel)
        self.uc.reg_write(arm.UC_ARM_REG_LR, back | 1)
        self.uc.emu_start(self.image.symbols["analogue_read"].address | 1, back, count=100_000)
        return self.uc.reg_read(arm.UC_ARM_REG_R0)


def test_the_converter_of_the_STM32G431_starts_reads_and_is_waited_for_no_longer_than_its_bound() -> None:
    table = any_table((2,), None)
    pins = Pins(None, "PA8", "PB0", Analogue("PA4", -2.0, 2.0))
    table = replace(table, loops=(replace(table.loops[0], pins=pins),))
    chip = ChipWithConverter(build_firmware(generate_law(table), board=STM32G431, loops=table.loops), code=0xFFFF_F123)
    chip.run_to("board_sleep")
    assert chip.orders == [0, ADVREGEN, ADVREGEN | ADCAL, ADVREGEN | ADEN]
    assert chip.read(17) == 0x123
    assert chip.orders[-1] == ADVREGEN | ADSTART
    found = {what: hex(chip.word(address)) for what, (address, _) in CONVERTER_STARTED.items()}
    assert found == {what: hex(word) for what, (_, word) in CONVERTER_STARTED.items()}
    chip.silent = True
    assert chip.read(17) == ADC_CODES


def test_the_emulated_board_refuses_an_image_of_another_chip() -> None:
    with pytest.raises(BadInput, match=r"STM32G431.*verify --chip stm32g431"):
        EmulatedBoard(image_of(STM32G431, "float32").elf)
    EmulatedBoard(image_of(STM32G071, "float32").elf)


def test_a_fault_of_the_law_on_the_core_is_told_with_its_place() -> None:
    texts = generate_law(ce150_table())
    head, step, body = texts["law.c"].partition("void law_step(")
    broken = head + step + body.replace("{\n", "{\n    *(volatile int *)0xf0000000u = 1;\n", 1)
    image = build_firmware({**texts, "law.c": broken}, board=STM32G431)
    law = CoreLaw(image, "float32", state_words(ce150_table()))
    stimulus = ARITHMETICS["float32"].stimuli(ce150_table(), 1)[0]
    with pytest.raises(VerificationFailed, match="0x0800"):
        law.run(law.start(stimulus.angles), stimulus.inputs)
