"""The firmware image: generated law and protocol, control path and board layer, compiled and linked."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from codegen.pins_source import pins_source
from codegen.protocol_source import protocol_source
from records.board import STM32G071, Board
from records.errors import BadInput
from records.files import write_atomic
from records.loops import LOOPS, Loop, has_pins
from records.protocol import protocol_of
from toolchain.calls import callers_of
from toolchain.elf import ImageSizes, Symbol, flash_content, image_board, image_sizes, image_symbols
from toolchain.host import CText, Source
from toolchain.target import build_image

FIRMWARE_DIR = Path(__file__).resolve().parents[2] / "firmware"
# Routines of the ARM run-time ABI and of compiler-rt for floats, doubles and divisions.
SOFT_ARITHMETIC = re.compile(
    r"__aeabi_(?:[fd](?!iv0)\w+|c[fd]\w+|[iul]+2[fd]|[a-z]*div[a-z]*)|__u?(?:div|mod|divmod)[sdt]i[34]"
    r"|__(?:add|sub|mul|div|neg|eq|ne|lt|le|gt|ge|un)[sd]f[23]|__(?:fix|float)\w+|__(?:extend|trunc)\w+"
)


@dataclass(frozen=True)
class FirmwareImage:
    """An image with what is known of it: `elf` for the emulated board and a debugger, `binary` for the flash of `board`."""

    elf: bytes
    binary: bytes
    sizes: ImageSizes
    symbols: Mapping[str, Symbol]
    board: Board


def build_firmware(
    generated: Mapping[str, str],
    out_dir: Path | None = None,
    *,
    board: Board = STM32G071,
    loops: tuple[Loop, ...] = LOOPS,
) -> FirmwareImage:
    """Build the firmware of `board` around the `generated` law of `loops` (file name -> text: law.h, law.c and what they include).

    With `out_dir` it leaves firmware.elf and firmware.bin there. The same texts give the same bytes. Raises BadInput with file
    and line when the compiler refuses, or when flash, RAM or the stack's reserve are exceeded.
    """
    texts = {**generated, **protocol_source(protocol_of(loops)), **pins_source(loops, board)}
    sources: list[Source] = [
        *control_sources(),
        *board_sources(board, loops),
        *(CText(name, text) for name, text in sorted(texts.items())),
    ]
    folders = [FIRMWARE_DIR / "control", *board_folders(board)]
    elf = build_image("firmware", sources, linker_script(board), include_dirs=folders, core=board.core).read_bytes()
    image = describe_image(elf, "firmware.elf")
    if "#define LAW_ARITHMETIC_CODE 1 " in texts.get("law.h", ""):
        refuse_soft_arithmetic(image)
    if out_dir is not None:
        write_atomic(out_dir / "firmware.elf", image.elf)
        write_atomic(out_dir / "firmware.bin", image.binary)
    return image


def refuse_soft_arithmetic(image: FirmwareImage) -> None:
    """Raise BadInput, naming routine and caller, when an image of integers alone carries float arithmetic or a division in software."""
    for name, symbol in sorted(image.symbols.items()):
        if SOFT_ARITHMETIC.fullmatch(name):
            callers = callers_of(image.elf, symbol.address) or ("a pointer",)
            raise BadInput(
                what="fixed-point image",
                where=f"called by {', '.join(callers)}",
                got=f"{name} linked in",
                expected="integer arithmetic without float or division in software",
                remedy="mend the caller: shifts, products and comparisons of integers are what this core has",
            )


def describe_image(elf: bytes, where: str) -> FirmwareImage:
    """The record of an ELF image; raises BadInput when it is none."""
    content, sizes, symbols = flash_content(elf, where), image_sizes(elf, where), image_symbols(elf, where)
    return FirmwareImage(elf, content, sizes, symbols, image_board(elf) or STM32G071)


def control_sources() -> list[Path]:
    """The control path, free of hardware, in a fixed order."""
    return sorted((FIRMWARE_DIR / "control").glob("*.c"))


def board_sources(board: Board, loops: tuple[Loop, ...] = LOOPS) -> list[Path]:
    """`main` and the layer of the chip below it, in a fixed order; where `loops` have no pins nothing hangs on the chip but the line."""
    files = {path.name: path for folder in board_folders(board) for path in folder.glob("*.c")}
    if not any(loop.analogue for loop in loops):
        del files["analogue.c"]
    if not has_pins(loops):
        files |= {path.name: path for path in (FIRMWARE_DIR / "board" / "no_pins").glob("*.c")}
    return [files[name] for name in sorted(files)]


def board_folders(board: Board) -> list[Path]:
    """Where the C is that any board has, that of the chip's family, and that of this chip."""
    return [FIRMWARE_DIR / "board" / folder for folder in ("", board.family, board.folder)]


def linker_script(board: Board) -> CText:
    """The chip's memories as the linker knows them, whose image it is for those who read the ELF, and what goes where."""
    memories = {"FLASH (rx)": board.flash, "RAM (rwx)": board.ram}
    stretches = [f"{name} : ORIGIN = {of.start:#x}, LENGTH = {of.size_bytes}" for name, of in memories.items()]
    own = ["MEMORY {", *stretches, "}", f"_chip_{board.chip} = 1;", f"_stack_size = {board.stack_reserve_bytes};"]
    _, family, _ = board_folders(board)
    return CText("link.ld", "\n".join([*own, (family / "sections.ld").read_text(encoding="utf-8")]))
