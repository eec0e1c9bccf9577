"""Where the members of a variable lie in the image's memory, read from its debug information (DWARF 4)."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from records.errors import BadInput
from toolchain.elf import image_variables, open_elf

_KINDS = {2: "bool", 4: "float", 5: "int", 6: "int", 7: "uint", 8: "uint"}  # DW_ATE_..., 6 and 8 are characters
_THROUGH = ("DW_TAG_typedef", "DW_TAG_const_type", "DW_TAG_volatile_type")


@dataclass(frozen=True)
class Member:
    """A number in memory: its path (`law.elevation.v_V`), address, kind (bool, float, int or uint), bytes, how many of it."""

    path: str
    address: int
    kind: str
    size_bytes: int
    count: int = 1


def variable_members(elf: bytes, where: str, symbol: str) -> tuple[Member, ...]:
    """All numbers in the static variable with this linker symbol, in the order of their addresses.

    Raises BadInput for an image without the symbol, or without debug information of it.
    """
    symbols = image_variables(elf, where)
    if symbol not in symbols:
        raise _unknown(where, f"no symbol {symbol}")
    address = symbols[symbol].address
    for unit in open_elf(elf, where).get_dwarf_info().iter_CUs():
        for entry in unit.iter_DIEs():
            if entry.tag == "DW_TAG_variable" and _static_address(entry) == address:
                return tuple(_members(entry.get_DIE_from_attribute("DW_AT_type"), "", address))
    raise _unknown(where, f"no debug information of {symbol}")


def _static_address(entry: Any) -> int | None:
    """The address of a variable of fixed place: the expression DW_OP_addr (3) and four bytes."""
    location = entry.attributes.get("DW_AT_location")
    if location is None or location.form != "DW_FORM_exprloc" or len(location.value) != 5 or location.value[0] != 3:
        return None
    return int.from_bytes(bytes(location.value[1:]), "little")


def _members(kind: Any, path: str, address: int) -> Iterator[Member]:
    while kind.tag in _THROUGH:
        kind = kind.get_DIE_from_attribute("DW_AT_type")
    if kind.tag == "DW_TAG_structure_type":
        for member in kind.iter_children():
            name = member.attributes["DW_AT_name"].value.decode()
            offset = member.attributes["DW_AT_data_member_location"].value
            of = member.get_DIE_from_attribute("DW_AT_type")
            yield from _members(of, f"{path}.{name}" if path else name, address + offset)
    elif kind.tag == "DW_TAG_array_type":
        (extent,) = (child for child in kind.iter_children() if child.tag == "DW_TAG_subrange_type")
        count = _count(extent)
        for member in _members(kind.get_DIE_from_attribute("DW_AT_type"), path, address):
            yield Member(member.path, member.address, member.kind, member.size_bytes, count)
    elif kind.tag == "DW_TAG_base_type":
        size = kind.attributes["DW_AT_byte_size"].value
        yield Member(path, address, _KINDS[kind.attributes["DW_AT_encoding"].value], size)


def _count(extent: Any) -> int:
    if "DW_AT_count" in extent.attributes:
        return int(extent.attributes["DW_AT_count"].value)
    return int(extent.attributes["DW_AT_upper_bound"].value) + 1


def _unknown(where: str, got: str) -> BadInput:
    return BadInput("firmware image", where, got, "an image with debug information", "build it with `twinlaw build`")
