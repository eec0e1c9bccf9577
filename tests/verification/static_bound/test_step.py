"""Sets of words contain what the processor computes: short programs against unicorn, arithmetic of sets against plain integers."""

import random
from collections.abc import Callable

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from unicorn import UC_ARCH_ARM, UC_MODE_MCLASS, UC_MODE_THUMB, Uc
from unicorn.arm_const import UC_ARM_REG_APSR, UC_ARM_REG_R0, UC_CPU_ARM_CORTEX_M0

from records.errors import VerificationFailed
from tests.soak import SOAK
from verification.static_bound import words
from verification.static_bound.elf_image import ElfImage
from verification.static_bound.state import UNKNOWN_FLAGS, State, assume_all
from verification.static_bound.step import step
from verification.static_bound.thumb import CONDITIONS, Instruction, decode
from verification.static_bound.words import MASK, Word

CODE = 0x08000000
PROGRAMS, LENGTH, SEED = 3000 if SOAK else 300, 4, 30
EXAMPLES = 300 if SOAK else 30
NOTHING = ElfImage((), {}, {}, ())


def contains(word: Word, value: int) -> bool:
    return (value - word.start) & MASK <= word.span and value & word.known == word.bits


def some_word(rng: random.Random) -> int:
    """Numbers near the borders of signs, fields and shifts, among any others."""
    near = rng.choice(
        (0, 1, 8, 32, 0xFF, 0x7FFFFF, 0x800000, 0x7F800000, 0x7FFFFFFF, 0x80000000, MASK, rng.getrandbits(32))
    )
    return (near + rng.randint(-3, 3)) & MASK


def set_around(value: int, rng: random.Random) -> Word:
    """A set that holds `value`: itself, an arc, known bits, or all words."""
    low, high = rng.getrandbits(rng.randint(1, 32)), rng.getrandbits(rng.randint(1, 32))
    known = rng.getrandbits(32) | rng.getrandbits(32)
    return rng.choice(
        (
            words.constant(value),
            words.interval(value - low, value + high),
            words.bit_pattern(known, value & known),
            words.TOP,
        )
    )


def data_processing(rng: random.Random) -> int:
    """An instruction on r0..r3 that reads no memory and does not branch."""
    registers = rng.getrandbits(2) | rng.getrandbits(2) << 3
    return rng.choice(
        (
            rng.getrandbits(1) << 12 | rng.getrandbits(5) << 6 | registers,  # LSLS, ASRS by a constant
            0x0800 | rng.getrandbits(5) << 6 | registers,  # LSRS by a constant
            0x1800 | rng.getrandbits(2) << 9 | rng.getrandbits(2) << 6 | registers,
            0x2000 | rng.getrandbits(2) << 11 | rng.getrandbits(2) << 8 | rng.getrandbits(8),
            0x4000 | rng.getrandbits(4) << 6 | registers,
            0x4200 | registers,
            0x4280 | registers,
            0x4600 | registers,
            0x4400 | registers,
            0xB200 | rng.getrandbits(2) << 6 | registers,
        )
    )


def holds(condition: str, apsr: int) -> bool:
    n, z, c, v = (bool(apsr >> bit & 1) for bit in (31, 30, 29, 28))
    first = {"eq": z, "hs": c, "mi": n, "vs": v, "hi": c and not z, "ge": n == v, "gt": n == v and not z}
    opposite = {"ne": "eq", "lo": "hs", "pl": "mi", "vc": "vs", "ls": "hi", "lt": "ge", "le": "gt"}
    return first[condition] if condition in first else not first[opposite[condition]]


class Core:
    """The independent processor."""

    def __init__(self) -> None:
        self.uc = Uc(UC_ARCH_ARM, UC_MODE_THUMB | UC_MODE_MCLASS)
        self.uc.ctl_set_cpu_model(UC_CPU_ARM_CORTEX_M0)
        self.uc.mem_map(CODE, 0x1000)

    def run(self, program: list[int], registers: list[int], apsr: int) -> tuple[list[int], int]:
        """Registers r0..r7 and flags behind the program."""
        self.uc.mem_write(CODE, b"".join(code.to_bytes(2, "little") for code in program))
        self.uc.ctl_flush_tb()
        for number, value in enumerate(registers):
            self.uc.reg_write(UC_ARM_REG_R0 + number, value)
        self.uc.reg_write(UC_ARM_REG_APSR, apsr)
        self.uc.emu_start(CODE | 1, CODE + 2 * len(program))
        return [self.uc.reg_read(UC_ARM_REG_R0 + number) for number in range(8)], self.uc.reg_read(UC_ARM_REG_APSR)


def followed(program: list[Instruction], start: State) -> list[State]:
    states = [start]
    for instruction in program:
        states = [after for state in states for after in step(state, instruction, 0, NOTHING, frame_escapes=False)]
    return states


def lost(states: list[State], registers: list[int]) -> bool:
    """Whether no state holds these registers."""
    return not any(all(contains(state.at(n), value) for n, value in enumerate(registers)) for state in states)


def test_states_hold_what_the_processor_computes_and_what_its_branches_tell() -> None:
    rng, core, wrong, told = random.Random(SEED), Core(), [], 0
    for _ in range(PROGRAMS):
        program = [data_processing(rng) for _ in range(LENGTH)]
        registers, apsr = [some_word(rng) for _ in range(8)], rng.getrandbits(4) << 28
        after, flags = core.run(program, registers, apsr)
        known = {n: set_around(value, rng) for n, value in enumerate(registers)}
        decoded = [decode(code, 0, CODE + 2 * k) for k, code in enumerate(program)]
        states = followed(decoded, State({n: word for n, word in known.items() if word != words.TOP}, UNKNOWN_FLAGS))
        if lost(states, after):
            wrong.append((decoded, "result"))
        for condition in CONDITIONS:
            branch = [one for state in states for one in assume_all(state, condition)]
            if holds(condition, flags) and lost(branch, after):
                wrong.append((decoded, condition))
            told += not branch
    assert wrong == []
    assert told > PROGRAMS  # many branches are known to be impossible: the sets are not all words


WORDS = st.one_of(st.integers(0, MASK), st.sampled_from((0, 1, 0x7FFFFFFF, 0x80000000, MASK)))
BINARY: dict[str, tuple[Callable[[Word, Word], Word], Callable[[int, int], int]]] = {
    "add": (words.add, lambda a, b: a + b),
    "subtract": (words.subtract, lambda a, b: a - b),
    "and": (words.bit_and, lambda a, b: a & b),
    "or": (words.bit_or, lambda a, b: a | b),
    "xor": (words.bit_xor, lambda a, b: a ^ b),
    "multiply": (words.multiply, lambda a, b: a * b),
    "join, first": (words.join, lambda a, b: a),
    "join, second": (words.join, lambda a, b: b),
}


@pytest.mark.parametrize("name", BINARY)
@settings(max_examples=EXAMPLES, deadline=None)
@given(a=WORDS, b=WORDS, seed=st.integers(0, 2**32))
def test_an_operation_on_sets_holds_the_operation_on_members(name: str, a: int, b: int, seed: int) -> None:
    rng, (on_sets, on_numbers) = random.Random(seed), BINARY[name]
    assert contains(on_sets(set_around(a, rng), set_around(b, rng)), on_numbers(a, b) & MASK)


@settings(max_examples=2 * EXAMPLES, deadline=None)
@given(a=WORDS, low=WORDS, span=WORDS, seed=st.integers(0, 2**32))
def test_cutting_and_listing_a_set_loses_no_member(a: int, low: int, span: int, seed: int) -> None:
    word = set_around(a, random.Random(seed))
    inside = (a - low) & MASK <= span
    part = words.within(word, low, low + span)
    assert not inside or (part is not None and contains(part, a))
    members = word.members(64)
    assert members is None or a in members
    assert word.lowest <= a <= word.highest
    signed = a - (a >> 31 << 32)
    assert word.signed_range[0] <= signed <= word.signed_range[1]


def test_undefined_halfwords_are_refused() -> None:
    for code in (0xDE00, 0xB100, 0xBA80, 0x47F8, 0xE800):
        with pytest.raises(VerificationFailed, match="no ARMv6-M instruction"):
            decode(code, 0, CODE)
