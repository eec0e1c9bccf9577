"""ASAP2 text (.a2l, ASAM MCD-2 MC 1.7.1) of an image: its signals and tables for measurement and calibration tools.

Signals and the limits of the law have addresses. The coefficients are compiled into the code, where no tool could change them: they
are told as system constants, by the names of the C. The EPK is the digest of the controller table, so that a tool refuses the
description of another table.
"""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from codegen.fixed.formats import law_formats
from codegen.traceability.names import constants
from records.board import Board, Core
from records.table import ControllerTable
from toolchain.dwarf import Member

_FLOAT = ("FLOAT32_IEEE", -3.40282347e38, 3.40282347e38)
_UNITS: Mapping[str, str] = {"V": "V", "rad": "rad", "us": "us", "counts": "1", "ticks": "1", "cycles": "1"}
_FIXED_SIGNALS = re.compile(r"^(law|input|output)\.|^\w+_limits\.")


@dataclass(frozen=True)
class ImageMap:
    """Whose image it is, and where it keeps what is described: the path's state, the limits of all axes, and the digest."""

    board: Board
    signals: Sequence[Member]
    limits: Sequence[Member]
    digest_address: int


@dataclass(frozen=True)
class Conversion:
    """A method from the number in memory to the physical one: times `factor`, in `unit`."""

    name: str
    unit: str
    factor: float


def a2l_text(table: ControllerTable, arithmetic: str, image: ImageMap) -> str:
    """The description as text: the same table and image give the same bytes; raises BadInput for a table that no words can hold."""
    members = [(member, _conversion(table, arithmetic, member)) for member in (*image.signals, *image.limits)]
    methods = sorted({conversion for _, conversion in members}, key=lambda conversion: conversion.name)
    lines = [
        "ASAP2_VERSION 1 71",
        f'/begin PROJECT twinlaw "control law of {table.plant}, {arithmetic}"',
        f'/begin MODULE firmware "{image.board.chip}"',
        *_module_parameters(table, arithmetic, image.board.core),
        *(line for method in methods for line in _method(method)),
        *_layouts(image.limits),
        *(line for member in image.signals for line in _measurement(member, _conversion(table, arithmetic, member))),
        *_digest(image.digest_address),
        *(line for member in image.limits for line in _characteristic(member, _conversion(table, arithmetic, member))),
        "/end MODULE",
        "/end PROJECT",
    ]
    return "\n".join(lines) + "\n"


def under(name: str, members: Sequence[Member]) -> tuple[Member, ...]:
    """The members with the variable's name before their path."""
    return tuple(replace(member, path=f"{name}.{member.path}") for member in members)


def _module_parameters(table: ControllerTable, arithmetic: str, core: Core) -> Iterator[str]:
    yield '/begin MOD_PAR "controller table and the coefficients that are part of the code"'
    yield f'EPK "{table.digest}"'
    yield f'CPU_TYPE "{core.title}"'
    yield f'SYSTEM_CONSTANT "LAW_ARITHMETIC" "{arithmetic}"'
    for constant in constants(table, arithmetic):
        yield f'SYSTEM_CONSTANT "{constant.name}" "{constant.literal.number}"'
    yield "/end MOD_PAR"
    yield f'/begin MOD_COMMON "{core.architecture}"'
    yield "BYTE_ORDER MSB_LAST"
    yield "ALIGNMENT_WORD 2"
    yield "ALIGNMENT_LONG 4"
    yield "ALIGNMENT_FLOAT32_IEEE 4"
    yield "/end MOD_COMMON"


def _method(method: Conversion) -> Iterator[str]:
    yield f'/begin COMPU_METHOD {method.name} "number in memory times {method.factor:.17g}" LINEAR "%.9" "{method.unit}"'
    yield f"COEFFS_LINEAR {method.factor:.17g} 0"
    yield "/end COMPU_METHOD"


def _layouts(limits: Sequence[Member]) -> Iterator[str]:
    for kind in sorted({_data_type(member)[0] for member in limits}):
        yield f"/begin RECORD_LAYOUT one_{kind} FNC_VALUES 1 {kind} COLUMN_DIR DIRECT /end RECORD_LAYOUT"


def _measurement(member: Member, conversion: Conversion) -> Iterator[str]:
    kind, low, high = _data_type(member)
    limits = f"{low * conversion.factor:.17g} {high * conversion.factor:.17g}"
    yield f'/begin MEASUREMENT {member.path} "" {kind} {conversion.name} 0 0 {limits}'
    yield f"ECU_ADDRESS 0x{member.address:08X}"
    if member.count > 1:
        yield _matrix(member.count)
    yield "/end MEASUREMENT"


def _matrix(count: int) -> str:
    """All three dimensions, which ASAP2 1.6 demands and 1.7 allows: tools of both read it."""
    return f"MATRIX_DIM {count} 1 1"


def _digest(address: int) -> Iterator[str]:
    yield '/begin MEASUREMENT LAW_TABLE_DIGEST "SHA-256 of the controller table" UBYTE NO_COMPU_METHOD 0 0 0 255'
    yield f"ECU_ADDRESS 0x{address:08X}"
    yield _matrix(32)
    yield "/end MEASUREMENT"


def _characteristic(member: Member, conversion: Conversion) -> Iterator[str]:
    kind, low, high = _data_type(member)
    limits = f"{low * conversion.factor:.17g} {high * conversion.factor:.17g}"
    place = f"VALUE 0x{member.address:08X} one_{kind} 0 {conversion.name} {limits}"
    yield f'/begin CHARACTERISTIC {member.path} "" {place}'
    yield "READ_ONLY"
    yield "/end CHARACTERISTIC"


def _data_type(member: Member) -> tuple[str, float, float]:
    """ASAP2's name of the type and its range."""
    if member.kind == "float":
        return _FLOAT
    size = {1: "BYTE", 2: "WORD", 4: "LONG"}[member.size_bytes]
    bits = 8 * member.size_bytes
    if member.kind == "int":
        return f"S{size}", -(2.0 ** (bits - 1)), 2.0 ** (bits - 1) - 1.0
    return f"U{size}", 0.0, 2.0**bits - 1.0


def _conversion(table: ControllerTable, arithmetic: str, member: Member) -> Conversion:
    """By the unit in the name; the words of the fixed-point law have their places as well."""
    kind, unit = _kind(table, member.path)
    if arithmetic != "fixed" or kind not in ("V", "rad") or not _FIXED_SIGNALS.match(member.path):
        return Conversion(f"in_{unit}" if unit != "1" else "plain", unit, 1.0)
    places = _places(table, member.path, kind)
    return Conversion(f"in_{unit}_{places}_places", unit, 2.0**-places)


def _kind(table: ControllerTable, path: str) -> tuple[str, str]:
    """What a member is inside, `rad` of what a loop measures and `V` of what it commands (records/loops.py), and its own unit."""
    name = path.rsplit(".", 1)[-1]
    for loop in table.loops:
        if name in (loop.output, loop.reference):
            return "rad", loop.output_unit or "1"
        if name == loop.input:
            return "V", loop.input_unit or "1"
    kind = _UNITS.get(path.rsplit("_", 1)[-1], "1")
    for loop in table.loops:
        if f".{loop.axis}." in path or path.startswith(f"{loop.axis}_limits."):
            return kind, {"rad": loop.output_unit or "1", "V": loop.input_unit or "1"}.get(kind, kind)
    return kind, kind


def _places(table: ControllerTable, path: str, kind: str) -> int:
    formats = law_formats(table)
    if kind == "V":
        return formats.voltage_places
    if path.endswith(("reference_1_rad", "reference_2_rad")):
        (index,) = (index for index, loop in enumerate(table.loops) if f".{loop.axis}." in path)
        return formats.axes[index].reference_places
    return formats.angle_places
