"""From a controller's table to C, to the firmware image, and to the image's description for calibration tools."""

from collections.abc import Mapping
from pathlib import Path

from codegen.law import demand_drivable
from codegen.library import library
from codegen.prefix import prefixed
from codegen.protocol_source import protocol_source
from codegen.traceability.a2l import ImageMap, a2l_text, under
from controllers import loading
from records.board import STM32G071, Board
from records.files import write_together
from records.law_table import FlownTable
from records.protocol import protocol_of
from records.table import ControllerTable
from rig.programming.image import FirmwareImage, build_firmware
from toolchain.dwarf import variable_members
from toolchain.elf import image_board, image_variables
from twinlaw.cli.console import stage

_WHERE = "firmware.elf"


def generate_sources(table: FlownTable, arithmetic: str, folder: Path) -> Mapping[str, str]:
    """Generate law and protocol and write them to `folder`; returns the law's texts by file name."""
    with stage("generating C"):
        law = loading.generate(table, arithmetic)
        write_together({folder / name: text for name, text in {**law, **_protocol(table)}.items()})
    return law


def _protocol(table: FlownTable) -> Mapping[str, str]:
    """The line's texts, which carry what the table's loops say."""
    return protocol_source(protocol_of(table.loops))


def generate_elsewhere(table: FlownTable, arithmetic: str, folder: Path, prefix: str, kind: str | None) -> list[Path]:
    """Law and protocol for firmware of another hand, in `folder`: names behind `prefix` if any, as a library where `kind` is given.

    Returns the files. Raises BadInput for a prefix that cannot begin a name in C.
    """
    with stage("generating C"):
        texts = {**loading.generate(table, arithmetic), **_protocol(table)}
        files = prefixed(texts, prefix) if kind is None else library(kind, texts, prefix, table.loops)
        write_together({folder / name: text for name, text in files.items()})
    return [folder / name for name in sorted(files)]


def build_image(table: FlownTable, law: Mapping[str, str], folder: Path, board: Board = STM32G071) -> FirmwareImage:
    """Compile and link the firmware of `board` around the table's law; leaves firmware.elf and firmware.bin in `folder`.

    Raises BadInput for voltages that the drivers on its pins cannot give.
    """
    demand_drivable(table)
    with stage(f"building the firmware for the {board.chip}"):
        return build_firmware(law, folder, board=board, loops=table.loops)


def image_a2l(table: ControllerTable, arithmetic: str, elf: bytes) -> str:
    """The .a2l text of an image built from `table`; raises BadInput for one without debug information."""
    symbols = image_variables(elf, _WHERE)
    limits = [
        member
        for name in (f"{loop.axis}_limits" for loop in table.loops)
        if name in symbols  # a law whose limits are part of the code has no place for them
        for member in under(name, variable_members(elf, _WHERE, name))
    ]
    signals = variable_members(elf, _WHERE, "main.path")
    return a2l_text(
        table, arithmetic, ImageMap(image_board(elf) or STM32G071, signals, limits, symbols["LAW_TABLE_DIGEST"].address)
    )
