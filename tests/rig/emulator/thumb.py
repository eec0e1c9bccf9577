"""Random Thumb instructions of every ARMv6-M class, by bit pattern (DDI0419 A5)."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

# class: fixed bits, and the mask of the bits that are free
CLASSES: dict[str, tuple[int, int]] = {
    "lsl imm": (0x0000, 0x07FF), "lsr imm": (0x0800, 0x07FF), "asr imm": (0x1000, 0x07FF), "add reg": (0x1800, 0x01FF),
    "sub reg": (0x1A00, 0x01FF), "add imm3": (0x1C00, 0x01FF), "sub imm3": (0x1E00, 0x01FF), "mov imm": (0x2000, 0x07FF),
    "cmp imm": (0x2800, 0x07FF), "add imm8": (0x3000, 0x07FF), "sub imm8": (0x3800, 0x07FF), "data processing": (0x4000, 0x03FF),
    "ldr literal": (0x4800, 0x07FF), "load store reg": (0x5000, 0x0FFF), "str imm": (0x6000, 0x07FF), "ldr imm": (0x6800, 0x07FF),
    "strb imm": (0x7000, 0x07FF), "ldrb imm": (0x7800, 0x07FF), "strh imm": (0x8000, 0x07FF), "ldrh imm": (0x8800, 0x07FF),
    "str sp": (0x9000, 0x07FF), "ldr sp": (0x9800, 0x07FF), "adr": (0xA000, 0x07FF), "add rd sp": (0xA800, 0x07FF),
    "add sub sp": (0xB000, 0x00FF), "extend": (0xB200, 0x00FF), "push": (0xB400, 0x01FF), "pop": (0xBC00, 0x00FF),
    "rev": (0xBA00, 0x003F), "rev16": (0xBA40, 0x003F), "revsh": (0xBAC0, 0x003F), "nop": (0xBF00, 0x0000),
    "stm": (0xC000, 0x07FF), "ldm": (0xC800, 0x07FF), "b cond": (0xD000, 0x0FFF), "b": (0xE000, 0x07FF),
    "cps": (0xB662, 0x0010),
}  # fmt: skip
HIGH_CLASSES = {"add high": 0x4400, "cmp high": 0x4500, "mov high": 0x4600, "bx": 0x4700, "blx": 0x4780}
LONG_CLASSES = ("bl", "mrs", "msr", "barrier")
SYSTEM_REGISTERS = (0, 1, 2, 3, 5, 6, 7, 8, 9, 16)


@dataclass(frozen=True)
class Instruction:
    """One instruction: its class and its halfwords."""

    kind: str
    halfwords: tuple[int, ...]


def _allowed(kind: str, code: int) -> bool:
    """Leave out what the architecture calls unpredictable."""
    if kind in ("push", "pop", "stm", "ldm") and not code & (0x1FF if kind == "push" else 0xFF):
        return False
    base = code >> 8 & 7
    if kind == "stm" and code >> base & 1 and code & ((1 << base) - 1):
        return False
    return not (kind == "b cond" and code >> 8 & 15 >= 14)


def _draw(rng: np.random.Generator, kind: str, fixed: int, free: int) -> Instruction:
    while True:
        code = fixed | int(rng.integers(0x10000)) & free
        if _allowed(kind, code):
            return Instruction(kind, (code,))


def _draw_high(rng: np.random.Generator, kind: str, fixed: int) -> Instruction:
    rm, rd = int(rng.integers(15)), int(rng.integers(15))
    if kind in ("bx", "blx"):
        return Instruction(kind, (fixed | rm << 3,))
    if kind == "cmp high" and rm < 8 and rd < 8:
        rm = 8
    return Instruction(kind, (fixed | (rd & 8) << 4 | rm << 3 | rd & 7,))


def _draw_long(rng: np.random.Generator, kind: str) -> Instruction:
    number, register = int(rng.choice(SYSTEM_REGISTERS)), int(rng.integers(13))
    offset = int(rng.integers(-15000, 15000))  # halfwords: stays inside flash from its middle
    s = int(offset < 0)
    forms: dict[str, Callable[[], tuple[int, int]]] = {
        "bl": lambda: (0xF000 | s << 10 | offset >> 11 & 0x3FF, 0xF800 | offset & 0x7FF),
        "mrs": lambda: (0xF3EF, 0x8000 | register << 8 | number),
        "msr": lambda: (0xF380 | register, 0x8800 | number),
        "barrier": lambda: (0xF3BF, int(rng.choice([0x8F4F, 0x8F5F, 0x8F6F]))),
    }
    return Instruction(kind, forms[kind]())


def random_instruction(rng: np.random.Generator) -> Instruction:
    """One instruction, each class equally likely."""
    kinds = [*CLASSES, *HIGH_CLASSES, *LONG_CLASSES]
    kind = kinds[int(rng.integers(len(kinds)))]
    if kind in CLASSES:
        return _draw(rng, kind, *CLASSES[kind])
    if kind in HIGH_CLASSES:
        return _draw_high(rng, kind, HIGH_CLASSES[kind])
    return _draw_long(rng, kind)


CORNERS = (0, 1, 2, 31, 32, 33, 255, 0x7FFFFFFF, 0x80000000, 0x80000001, 0xFFFFFFFF, 0xFFFFFF00)


def random_registers(rng: np.random.Generator, count: int) -> list[list[int]]:
    """`count` rows of r0-r14: a mix of pointers into SRAM and flash, small offsets, corner values and anything; sp is aligned."""
    shape = (count, 15)
    near, anything = rng.integers(0, 0x6000, shape), rng.integers(0, 2**32, shape)
    corners = np.array(CORNERS, np.int64)[anything % len(CORNERS)]
    choices = [0x20001000 + (near & ~3), 0x20001000 + near, near & 0xFC, corners, anything, 0x08000001 + (near & ~1)]
    values = np.choose(rng.integers(0, len(choices), shape), choices)
    values[:, 13] = choices[0][:, 13]
    return [list(map(int, row)) for row in values.tolist()]
