"""Who calls a function of an ARMv6-M image, read from its machine code."""

import struct
from itertools import pairwise

from elftools.elf.sections import SymbolTableSection

from toolchain.elf import open_elf


def callers_of(elf: bytes, address: int) -> tuple[str, ...]:
    """Names of the functions with a BL to `address`, sorted; calls through pointers are not seen. Raises BadInput for a foreign file."""
    return tuple(sorted(name for name, start, code in _functions(elf) if address in _called(start, code)))


def _functions(elf: bytes) -> list[tuple[str, int, bytes]]:
    parsed = open_elf(elf, "image")
    table, text = parsed.get_section_by_name(".symtab"), parsed.get_section_by_name(".text")
    if not isinstance(table, SymbolTableSection) or text is None:
        return []
    base, content = int(text["sh_addr"]), bytes(text.data())
    found = []
    for symbol in table.iter_symbols():
        start, size = int(symbol["st_value"]) & ~1, int(symbol["st_size"])
        if symbol["st_info"]["type"] == "STT_FUNC" and base <= start < base + len(content):
            found.append((symbol.name, start, content[start - base : start - base + size]))
    return found


def _called(start: int, code: bytes) -> set[int]:
    """Targets of every BL (encoding T1, DDI0419 A6.7.13); words of a literal pool that look like one are harmless."""
    halves = struct.unpack(f"<{len(code) // 2}H", code[: len(code) // 2 * 2])
    return {
        (start + 2 * index + 4 + _offset(first, second)) & 0xFFFFFFFF
        for index, (first, second) in enumerate(pairwise(halves))
        if first & 0xF800 == 0xF000 and second & 0xD000 == 0xD000
    }


def _offset(first: int, second: int) -> int:
    sign = first >> 10 & 1
    i1, i2 = (~((second >> place & 1) ^ sign) & 1 for place in (13, 11))
    offset = i1 << 23 | i2 << 22 | (first & 0x3FF) << 12 | (second & 0x7FF) << 1
    return offset - (sign << 24)
