"""Files for other tools: the ASAP2 description of an image."""

from codegen.traceability.a2l import ImageMap, a2l_text, under
from records.table import ControllerTable
from toolchain.dwarf import variable_members
from toolchain.elf import image_symbols

_WHERE = "firmware.elf"
_LIMITS = ("elevation_limits", "azimuth_limits")


def image_a2l(table: ControllerTable, arithmetic: str, elf: bytes) -> str:
    """The .a2l text of an image built from `table`; raises BadInput for one without debug information."""
    symbols = image_symbols(elf, _WHERE)
    limits = [
        member
        for name in _LIMITS
        if name in symbols  # a law whose limits are part of the code has no place for them
        for member in under(name, variable_members(elf, _WHERE, name))
    ]
    signals = variable_members(elf, _WHERE, "main.path")
    return a2l_text(table, arithmetic, ImageMap(signals, limits, symbols["LAW_TABLE_DIGEST"].address))
