"""Sums, differences and products of floats in the target's routines, bit for bit as the host's FPU."""

from collections.abc import Iterable, Iterator
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from elftools.elf.elffile import ELFFile
from numpy.typing import NDArray
from unicorn import UC_ARCH_ARM, UC_HOOK_BLOCK, UC_MODE_MCLASS, UC_MODE_THUMB, Uc
from unicorn.arm_const import UC_ARM_REG_LR, UC_ARM_REG_R0, UC_ARM_REG_SP

from tests.soak import SOAK
from toolchain.host import CText
from toolchain.target import build_image

BOARD = Path(__file__).resolve().parents[2] / "firmware" / "board"
COUNT = 1024
PARTS = 200 if SOAK else 5  # of COUNT pairs, for each of nine kinds of operands
Bits = NDArray[np.uint32]

TARGET_DRIVER = CText(
    "driver.c",
    f"""
    #include <stdint.h>
    float a[{COUNT}], b[{COUNT}];
    float results[{3 * COUNT}];
    void Reset_Handler(uint32_t count);
    void Reset_Handler(uint32_t count)
    {{
        for (uint32_t i = 0u; i < count; i++) {{
            results[3u * i] = a[i] + b[i];
            results[3u * i + 1u] = a[i] - b[i];
            results[3u * i + 2u] = a[i] * b[i];
        }}
    }}
    """,
)
LINKER_SCRIPT = """
ENTRY(Reset_Handler)
SECTIONS {
    . = 0x08000000; .text : { KEEP(*(.text*)) *(.rodata*) }
    . = 0x20000000; .bss : { *(.bss*) *(COMMON) }
    /DISCARD/ : { *(.ARM.exidx*) *(.ARM.extab*) }
}
"""
NASTY = np.array(
    [
        *(0x00000000, 0x80000000, 0x00000001, 0x80000001, 0x007FFFFF, 0x00800000, 0x80800000, 0x00800001, 0x01000000),
        *(0x7F7FFFFF, 0xFF7FFFFF, 0x7F000000, 0x7F800000, 0xFF800000, 0x7FC00000, 0x7F800001, 0xFFC12345, 0x3F800000),
        *(0xBF800000, 0x3F7FFFFF, 0x3F800001, 0x34000000, 0x33800000, 0x33800001, 0x33000000, 0x4B800000, 0x00FFFFFF),
    ],
    dtype=np.uint32,
)


def test_the_target_routines_give_the_bits_of_the_fpu_on_many_operands(tmp_path: Path) -> None:
    target = _Target(tmp_path)
    for a, b in _operands(PARTS * COUNT, seed=2):
        for start in range(0, len(a), COUNT):
            part = slice(start, start + COUNT)
            _assert_as_fpu(a[part], b[part], target.computed(a[part], b[part]))


def test_the_operands_reach_every_instruction_of_the_routines(tmp_path: Path) -> None:
    target = _Target(tmp_path)
    reached = target.reached((a[:COUNT], b[:COUNT]) for a, b in _operands(COUNT // 2, seed=2))
    assert target.instructions("__aeabi_fadd", "__aeabi_fsub", "__aeabi_fmul") - reached == set()


def test_a_wrong_bit_is_noticed() -> None:
    a = np.array([0x3F800000], dtype=np.uint32)
    right = np.array([[0x40000000, 0x00000000, 0x3F800000]], dtype=np.uint32)
    _assert_as_fpu(a, a, right)
    with pytest.raises(AssertionError, match="3F800000"):
        _assert_as_fpu(a, a, right ^ np.array([[0, 0, 1]], dtype=np.uint32))


class _Target:
    """The routines in an image of their own, run by an independent simulator."""

    def __init__(self, folder: Path) -> None:
        script = folder / "test.ld"
        script.write_text(LINKER_SCRIPT, encoding="utf-8")
        sources = [BOARD / "float_routines.c", TARGET_DRIVER]
        image = ELFFile(BytesIO(build_image("soft-float", sources, script, include_dirs=[BOARD]).read_bytes()))
        symbols = list(image.get_section_by_name(".symtab").iter_symbols())
        self._addresses = {s.name: s["st_value"] for s in symbols}
        self._sizes = {s.name: s["st_size"] for s in symbols}
        self._machine = Uc(UC_ARCH_ARM, UC_MODE_THUMB | UC_MODE_MCLASS)
        self._machine.mem_map(0x08000000, 0x10000)
        self._machine.mem_map(0x20000000, 0x10000)
        for segment in image.iter_segments():
            if segment["p_type"] == "PT_LOAD" and segment["p_filesz"]:
                self._machine.mem_write(segment["p_vaddr"], segment.data())

    def reached(self, operands: Iterable[tuple[Bits, Bits]]) -> set[int]:
        """Addresses of all instructions that are executed for these operands."""
        found: set[int] = set()
        self._machine.hook_add(UC_HOOK_BLOCK, lambda _, start, size, *__: found.update(range(start, start + size, 2)))
        for a, b in operands:
            self.computed(a, b)
        return found

    def instructions(self, *functions: str) -> set[int]:
        """Addresses of all instructions of these functions."""
        starts = [self._addresses[name] & ~1 for name in functions]
        ends = [start + self._sizes[name] for start, name in zip(starts, functions, strict=True)]
        return {a for start, end in zip(starts, ends, strict=True) for a in range(start, end, 2)}

    def computed(self, a: Bits, b: Bits) -> Bits:
        self._machine.mem_write(self._addresses["a"], a.tobytes())
        self._machine.mem_write(self._addresses["b"], b.tobytes())
        for register, value in ((UC_ARM_REG_R0, len(a)), (UC_ARM_REG_SP, 0x20010000), (UC_ARM_REG_LR, 0x0800FFF1)):
            self._machine.reg_write(register, value)
        self._machine.emu_start(self._addresses["Reset_Handler"] | 1, 0x0800FFF0)
        results = bytes(self._machine.mem_read(self._addresses["results"], 12 * len(a)))
        return np.frombuffer(results, dtype=np.uint32).reshape(-1, 3)


def _operands(count: int, seed: int) -> Iterator[tuple[Bits, Bits]]:
    """All pairs of nasty numbers; any bits; near magnitudes; products near either end; few ones; near zero; subnormals with any."""
    rng = np.random.default_rng(seed)

    def bits(low: int, high: int) -> NDArray[np.int64]:
        return rng.integers(low, high, count)

    def fields(exponents: NDArray[np.int64], fractions: NDArray[np.int64]) -> Bits:
        return ((bits(0, 2) << 31) | (exponents << 23) | fractions).astype(np.uint32)

    yield tuple(grid.ravel() for grid in np.meshgrid(NASTY, NASTY))  # type: ignore[misc]
    yield bits(0, 2**32).astype(np.uint32), bits(0, 2**32).astype(np.uint32)
    exponents = bits(0, 256)
    near = np.clip(exponents + bits(-28, 29), 0, 255)
    yield fields(exponents, bits(0, 2**23)), fields(near, bits(0, 2**23))
    a = bits(0, 2**32 - 64)
    yield a.astype(np.uint32), ((a + bits(-64, 64)) ^ (bits(0, 2) << 31)).astype(np.uint32)
    for total in (127, 381):
        other = np.clip(total - exponents + bits(-28, 5), 0, 255)
        yield fields(exponents, bits(0, 2**23)), fields(other, bits(0, 2**23))
    sparse = [fields(np.clip(128 + bits(-20, 20), 0, 255), 1 << bits(0, 23)) for _ in range(2)]
    yield sparse[0], sparse[1]
    small = [fields(bits(0, 4), bits(0, 2**23) >> bits(0, 23)) for _ in range(2)]
    yield small[0], small[1]
    subnormal = fields(np.zeros(count, dtype=np.int64), bits(1, 2**23) >> bits(0, 23))
    yield subnormal, fields(exponents, bits(0, 2**23))
    yield fields(np.clip(bits(0, 30), 0, 255), bits(0, 2**23)), subnormal


def _assert_as_fpu(a: Bits, b: Bits, results: Bits) -> None:
    one, other = a.view(np.float32), b.view(np.float32)
    with np.errstate(all="ignore"):
        wanted = np.stack([one + other, one - other, one * other], axis=-1).view(np.uint32)
    both_nan = ((results & 0x7FFFFFFF) > 0x7F800000) & ((wanted & 0x7FFFFFFF) > 0x7F800000)
    wrong = np.argwhere((results != wanted) & ~both_nan)
    if len(wrong):
        row, column = wrong[0]
        words = (a[row], b[row], results[row, column], wanted[row, column])
        raise AssertionError(f"{'+-*'[column]}: " + " ".join(f"{int(word):08X}" for word in words))
