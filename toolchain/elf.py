"""What an ELF image holds: its bytes for the flash, its sizes, its symbols."""

import io
import re
from collections.abc import Iterator
from dataclasses import dataclass

from elftools.common.exceptions import ELFError
from elftools.elf.elffile import ELFFile
from elftools.elf.sections import SymbolTableSection

from records.board import BOARDS, Board
from records.errors import BadInput

_CHIP = re.compile(rb"\0_chip_(\w+)\0")  # a name in the table of symbols


@dataclass(frozen=True)
class Symbol:
    """A named place in the image; `size_bytes` is 0 for a mark of the linker script."""

    address: int
    size_bytes: int


@dataclass(frozen=True)
class ImageSizes:
    """Bytes of the image by section, and what they cost in flash and RAM; the stack's reserve is not in `ram_bytes`."""

    text_bytes: int
    rodata_bytes: int
    data_bytes: int
    bss_bytes: int

    @property
    def flash_bytes(self) -> int:
        """Code, constants and the start values of variables."""
        return self.text_bytes + self.rodata_bytes + self.data_bytes

    @property
    def ram_bytes(self) -> int:
        """Variables."""
        return self.data_bytes + self.bss_bytes


def open_elf(elf: bytes, where: str) -> ELFFile:
    """The parsed image; raises BadInput when these bytes are no ARM ELF file."""
    try:
        parsed = ELFFile(io.BytesIO(elf))
        machine = str(parsed["e_machine"])
    except ELFError as error:
        raise _foreign(where, str(error) or "no ELF file") from error
    if machine != "EM_ARM":
        raise _foreign(where, f"an ELF file for {machine}")
    return parsed


def image_board(elf: bytes) -> Board | None:
    """The board whose linker script made the image; None where it names none."""
    named = _CHIP.search(elf)
    return BOARDS.get(named[1].decode()) if named else None


def flash_content(elf: bytes, where: str) -> bytes:
    """The bytes to program from the start of the flash on, gaps filled with 0xff as erased flash reads.

    Raises BadInput for what is no image of the board, and for one without content.
    """
    segments = [
        (int(segment["p_paddr"]), bytes(segment.data()))
        for segment in open_elf(elf, where).iter_segments("PT_LOAD")
        if segment["p_filesz"] > 0
    ]
    if not segments:
        raise _foreign(where, "an image without content")
    start = min(address for address, _ in segments)
    content = bytearray(b"\xff" * (max(address + len(data) for address, data in segments) - start))
    for address, data in segments:
        content[address - start : address - start + len(data)] = data
    return bytes(content)


def image_sizes(elf: bytes, where: str) -> ImageSizes:
    """Sizes of the loaded sections; raises BadInput as `open_elf` does."""
    size = {section.name: int(section["sh_size"]) for section in open_elf(elf, where).iter_sections()}
    return ImageSizes(
        text_bytes=size.get(".text", 0),
        rodata_bytes=size.get(".rodata", 0),
        data_bytes=size.get(".data", 0),
        bss_bytes=size.get(".bss", 0) + size.get(".noinit", 0),
    )


def image_symbols(elf: bytes, where: str) -> dict[str, Symbol]:
    """All named symbols; a function's address is given without the Thumb bit. Raises BadInput where there are none."""
    return {name: symbol for name, kind, symbol in _symbols(elf, where) if kind not in ("STT_FILE", "STT_SECTION")}


def image_variables(elf: bytes, where: str) -> dict[str, Symbol]:
    """Those of `image_symbols` that are variables: a static one may be called as a function of another file is."""
    return {name: symbol for name, kind, symbol in _symbols(elf, where) if kind == "STT_OBJECT"}


def _symbols(elf: bytes, where: str) -> Iterator[tuple[str, str, Symbol]]:
    table = open_elf(elf, where).get_section_by_name(".symtab")
    if not isinstance(table, SymbolTableSection):
        raise _foreign(where, "an ELF file without symbols")
    for symbol in table.iter_symbols():
        kind = symbol["st_info"]["type"]
        if symbol.name:
            yield symbol.name, kind, Symbol(_address(symbol["st_value"], kind), int(symbol["st_size"]))


def _address(value: int, kind: str) -> int:
    return value & ~1 if kind == "STT_FUNC" else value


def _foreign(where: str, got: str) -> BadInput:
    return BadInput(
        what="firmware image",
        where=where,
        got=got,
        expected="an ELF file for ARM",
        remedy="build it with `twinlaw build`",
    )
