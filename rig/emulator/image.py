"""An ELF image as the emulated board and its messages need it: flash content, symbols, source lines."""

import bisect
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property, lru_cache
from pathlib import Path

from elftools.common.exceptions import ELFError
from elftools.elf.elffile import ELFFile
from elftools.elf.sections import SymbolTableSection

from records.board import STM32G071, Board
from records.errors import BadInput
from toolchain.elf import image_board, open_elf

SMALLEST_BYTES = 8  # initial stack pointer and reset vector


@dataclass(frozen=True)
class Symbol:
    """A name of the image: where it stands, how long it is, whether it is code."""

    name: str
    address: int
    size: int
    is_function: bool


@dataclass(frozen=True)
class SourceLine:
    """One row of the line table: this line begins at `address`."""

    address: int
    file: str
    line: int


class Image:
    """A linked ARM ELF file for `chip`; `elf` is its bytes, `where` names it in messages.

    Raises BadInput when it is not an ARM ELF, is truncated, or has no content in flash.
    """

    def __init__(self, elf: bytes, where: str, chip: Board = STM32G071) -> None:
        self.where, self.chip = where, chip
        self._elf: ELFFile | None = open_elf(elf, where)
        _demand_chip(image_board(elf), where, chip)
        try:
            self.flash = _flash_content(self._elf, where, chip)
            self._table = self._elf.get_section_by_name(".symtab")
        except ELFError as error:
            raise _not_an_image(where, f"a damaged file ({error})", chip) from error

    @classmethod
    def from_flash(cls, content: bytes, where: str, chip: Board = STM32G071) -> "Image":
        """What a programmer has left in the flash: content without names, lines or sections."""
        image = cls.__new__(cls)
        image.where, image.chip, image._elf, image._table = where, chip, None, None
        image.flash = content.ljust(chip.flash.size_bytes, b"\xff")
        return image

    @classmethod
    def from_file(cls, path: Path, chip: Board = STM32G071) -> "Image":
        """Read the image at `path`; raises BadInput when there is none."""
        try:
            return _image(path.read_bytes(), str(path), chip)
        except OSError as error:
            raise _not_an_image(str(path), error.strerror or str(error), chip) from error

    @cached_property
    def symbols(self) -> dict[str, Symbol]:
        """Named functions, objects and linker symbols."""
        if not isinstance(self._table, SymbolTableSection):
            return {}
        return {symbol.name: symbol for symbol in _named(self._table)}

    @cached_property
    def functions(self) -> list[Symbol]:
        """Functions in order of address."""
        return sorted((s for s in self.symbols.values() if s.is_function), key=lambda s: s.address)

    @cached_property
    def lines(self) -> list[SourceLine]:
        """The line table of all compilation units in order of address; empty without debug information."""
        return sorted(self._line_rows(), key=lambda row: row.address)

    @cached_property
    def ram_end(self) -> int:
        """First address behind everything the image places in RAM."""
        ends: list[int] = [
            s["sh_addr"] + s["sh_size"]
            for s in (self._elf.iter_sections() if self._elf else ())
            if s["sh_flags"] & 2 and s["sh_addr"] >= self.chip.ram.start
        ]
        return max([self.chip.ram.start, *ends])

    def function_at(self, address: int) -> Symbol | None:
        """The function that holds `address`."""
        at = bisect.bisect_right(self.functions, address, key=lambda f: f.address) - 1
        found = self.functions[at] if at >= 0 else None
        return found if found and address < found.address + max(found.size, 2) else None

    def line_at(self, address: int) -> SourceLine | None:
        """The source line of the instruction at `address`."""
        at = bisect.bisect_right(self.lines, address, key=lambda row: row.address) - 1
        found = self.lines[at] if at >= 0 else None
        return found if found and found.line else None

    def place(self, address: int) -> str:
        """`0x08000123 in main at main.c:42`, as far as the image knows."""
        function, row = self.function_at(address), self.line_at(address)
        inside = f" in {function.name}" if function else ""
        return f"0x{address:08x}{inside}" + (f" at {row.file}:{row.line}" if row and function else "")

    def _line_rows(self) -> Iterator[SourceLine]:
        if self._elf is None or not self._elf.has_dwarf_info():
            return
        dwarf = self._elf.get_dwarf_info()
        for unit in dwarf.iter_CUs():
            program = dwarf.line_program_for_CU(unit)
            if program is None:
                continue
            first = 0 if program["version"] >= 5 else 1
            files = [entry.name.decode() for entry in program["file_entry"]]
            for entry in program.get_entries():
                state = entry.state
                if state is None:
                    continue
                number = state.file - first
                name = files[number] if 0 <= number < len(files) else "?"
                yield SourceLine(state.address, name, 0 if state.end_sequence else state.line)


@lru_cache(maxsize=16)
def _image(elf: bytes, where: str, chip: Board) -> Image:
    """Read once: many boards are given the same file, and its names take longer to read than the board to start."""
    return Image(elf, where, chip)


def as_image(source: "bytes | Path | Image", chip: Board) -> Image:
    """The image in these bytes, in this file, or itself; raises BadInput for what is no image."""
    if isinstance(source, Image):
        return source
    return Image(source, "image in memory", chip) if isinstance(source, bytes) else Image.from_file(source, chip)


def _demand_chip(named: Board | None, where: str, chip: Board) -> None:
    """Raise BadInput for an image of another chip, whose core and registers are not those that are emulated."""
    if named not in (None, chip):
        got, expected = f"an image for the {named.chip}", f"one for the {chip.chip}, the chip that is emulated"
        remedy = (
            f"build it without --chip; `twinlaw verify --chip {named.chip.lower()}` runs the other's law on its core"
        )
        raise BadInput("firmware image", where, got, expected, remedy)


def _flash_content(elf: ELFFile, where: str, chip: Board) -> bytes:
    content = bytearray(b"\xff" * chip.flash.size_bytes)
    loaded = 0
    for segment in elf.iter_segments("PT_LOAD"):
        start, data = segment["p_paddr"] - chip.flash.start, segment.data()
        if len(data) != segment["p_filesz"]:
            raise _not_an_image(where, "a truncated file", chip)
        if not data or not 0 <= start <= chip.flash.size_bytes - len(data):
            continue
        content[start : start + len(data)] = data
        loaded += len(data)
    if loaded < SMALLEST_BYTES:
        raise _not_an_image(where, "no content in flash", chip)
    return bytes(content)


def _named(table: SymbolTableSection) -> Iterator[Symbol]:
    for entry in table.iter_symbols():
        kind = entry["st_info"]["type"]
        if (
            entry.name
            and entry["st_shndx"] != "SHN_UNDEF"
            and kind in ("STT_FUNC", "STT_OBJECT", "STT_NOTYPE")
            and entry.name[0] != "$"
        ):
            is_function = kind == "STT_FUNC"
            yield Symbol(
                entry.name, entry["st_value"] & ~1 if is_function else entry["st_value"], entry["st_size"], is_function
            )


def _not_an_image(where: str, got: str, chip: Board) -> BadInput:
    expected = f"a 32-bit ARM ELF linked for flash at 0x{chip.flash.start:08x}"
    return BadInput("firmware image", where, got, expected, "build it with `twinlaw build`")
