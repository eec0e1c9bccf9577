"""A chip that is not emulated: its image's law on unicorn's core, and what its start-up leaves in the registers."""

from dataclasses import dataclass, field

import pytest
import unicorn
from unicorn import arm_const as arm

from codegen.law import generate_law
from codegen.law_equations import state_words
from records.board import BOARDS, STM32G071, STM32G431, Board
from records.errors import BadInput, VerificationFailed
from rig.emulator.board import EmulatedBoard
from rig.flight.core_law import CoreLaw
from rig.programming.image import FirmwareImage, build_firmware
from tests.law_tables import ce150_table
from tests.soak import SOAK, sampled
from twinlaw.workflows.chain.arithmetics import ARITHMETICS
from verification.equality import compare
from verification.host_law import HostLaw

STEPS = 100_000 if SOAK else 2_000


def image_of(board: Board, arithmetic: str) -> FirmwareImage:
    return build_firmware(generate_law(ce150_table(), arithmetic), board=board)


CASES = [(chip, arithmetic) for chip in BOARDS for arithmetic in ARITHMETICS]


@pytest.mark.parametrize(("chip", "arithmetic"), sampled(CASES, keep=[CASES[2]]))
def test_the_law_on_the_core_gives_the_bits_of_twin_and_host(chip: str, arithmetic: str) -> None:
    """Not one bit of 100 000 steps, NaN and broken states among them; 2 000 outside of a soak."""
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
