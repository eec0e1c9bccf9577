"""What an ELF file says of an ARMv6-M program: its read-only bytes, its functions, and where literal pools lie between the code."""

import io
from bisect import bisect_right
from dataclasses import dataclass
from functools import lru_cache

from elftools.common.exceptions import ELFError
from elftools.elf.elffile import ELFFile
from elftools.elf.sections import SymbolTableSection

from records.errors import BadInput, VerificationFailed
from verification.static_bound.thumb import Instruction, decode

ALLOCATED_READ_ONLY = (0x2, 0x3)  # sh_flags: SHF_ALLOC set, SHF_WRITE (1) clear


@dataclass(frozen=True)
class ElfFunction:
    """A function symbol: its name for people and its first address."""

    name: str
    start: int


@dataclass(frozen=True)
class ElfImage:
    """The parts of an ELF file that do not change while it runs."""

    blocks: tuple[tuple[int, bytes], ...]
    functions: dict[int, ElfFunction]
    names: dict[str, int]
    mapping: tuple[tuple[int, bool], ...]  # address, and whether instructions (not data) follow

    def read(self, address: int, size: int) -> int | None:
        """Little-endian number of `size` bytes in read-only memory, None elsewhere."""
        for base, content in self.blocks:
            if base <= address and address + size <= base + len(content):
                return int.from_bytes(content[address - base : address - base + size], "little")
        return None

    def instruction(self, address: int) -> Instruction:
        """The instruction at `address`; raises VerificationFailed where there is no code."""
        place = bisect_right(self.mapping, (address, True)) - 1
        first = self.read(address, 2)
        if first is None or (place >= 0 and not self.mapping[place][1]):
            raise VerificationFailed(f"0x{address:08x}: execution would run into data")
        return decode(first, self.read(address + 2, 2) or 0, address)

    def function_named(self, name: str) -> ElfFunction:
        """The function with this symbol; raises BadInput where the file has none."""
        if name not in self.names:
            known = ", ".join(sorted(self.names)[:8]) or "no function at all"
            raise BadInput(
                "function to analyse",
                "ELF symbol table",
                name,
                f"one of its functions ({known}, ...)",
                "name an existing function",
            )
        return self.functions[self.names[name]]

    def function_at(self, address: int, caller: int) -> ElfFunction:
        """The function that begins at `address`; raises VerificationFailed where none does."""
        if address not in self.functions:
            raise VerificationFailed(f"0x{caller:08x} leads to 0x{address:08x}, where no function symbol stands")
        return self.functions[address]


@lru_cache(maxsize=2)  # of an image many functions are asked about
def load_elf(elf: bytes) -> ElfImage:
    """Read an ARM ELF image with a symbol table; raises BadInput for anything else."""
    try:
        file = ELFFile(io.BytesIO(elf))
    except ELFError as problem:
        raise _not_usable(str(problem)) from problem
    if file["e_machine"] != "EM_ARM" or not file.little_endian:
        raise _not_usable(f"a file for {file['e_machine']}")
    table = file.get_section_by_name(".symtab")
    if not isinstance(table, SymbolTableSection):
        raise _not_usable("a file without symbols")
    blocks = tuple(
        (section["sh_addr"], section.data())
        for section in file.iter_sections("SHT_PROGBITS")
        if section["sh_flags"] & ALLOCATED_READ_ONLY[1] == ALLOCATED_READ_ONLY[0]
    )
    symbols = [(s.name, s["st_value"], s["st_info"]["type"]) for s in table.iter_symbols()]
    marks = (
        (name[:2] == "$t", value) for name, value, kind in symbols if kind == "STT_NOTYPE" and name[:2] in ("$t", "$d")
    )
    entries = [(value & ~1, plain_name(name), name) for name, value, kind in symbols if kind == "STT_FUNC"]
    starts: dict[int, list[str]] = {}
    for start, plain, _ in entries:
        starts.setdefault(start, []).append(plain)
    functions = {start: ElfFunction(min(names, key=_preference), start) for start, names in starts.items()}
    return ElfImage(
        blocks, functions, {name: start for start, _, name in entries}, tuple(sorted((a, code) for code, a in marks))
    )


def _preference(name: str) -> tuple[bool, int, str]:
    """Of several names at one address the run-time ABI's is taken, then the shortest."""
    return not name.startswith("__aeabi_"), len(name), name


def plain_name(symbol: str) -> str:
    """A symbol without the module path that zig gives its run-time routines."""
    return symbol.rsplit(".", 1)[-1] if symbol.startswith("compiler_rt.") else symbol


def _not_usable(got: str) -> BadInput:
    return BadInput(
        "firmware image",
        "static bound",
        got,
        "an ARM little-endian ELF file with symbols",
        "build the image with `twinlaw build`",
    )
