"""The declared serial protocol as C text: `protocol.h` and `protocol.c`."""

from functools import cache
from pathlib import Path

import jinja2

from records.loops import has_pins
from records.wire import CRC_SIZE, HEADER_SIZE, Field, Message, Protocol
from toolchain.templates import text_templates

_TEMPLATES = Path(__file__).resolve().parent / "templates"


def protocol_source(protocol: Protocol) -> dict[str, str]:
    """Return {"protocol.h": ..., "protocol.c": ...}: a pure function, the same text for the same declaration."""
    facts = {
        "protocol": protocol,
        "schema_bytes": ", ".join(f"0x{byte:02x}" for byte in protocol.schema_hash),
        "header_size": HEADER_SIZE,
        "crc_size": CRC_SIZE,
        "largest_payload": max(message.size for message in protocol.messages),
        "to_board": [message for message in protocol.messages if message.to_board],
        "pack_lines": _pack_lines,
        "unpack_lines": _unpack_lines,
        "declaration": _declaration,
    }
    return {name: _environment().get_template(f"{name}.j2").render(facts) for name in ("protocol.h", "protocol.c")}


@cache
def _environment() -> jinja2.Environment:
    environment = text_templates(_TEMPLATES)
    environment.filters["c_name"] = _c_name
    environment.filters["has_pins"] = has_pins
    return environment


def _c_name(name: str) -> str:
    return f"protocol_{name.lower()}"


def _declaration(field: Field) -> str:
    array = f"[{field.count}]" if field.count > 1 else ""
    note = ", raw word of the law's arithmetic" if field.is_number else ""
    return f"{field.wire_type.c_name} {field.name}{array}; /* {field.unit}: {field.meaning}{note} */"


def _pack_lines(message: Message) -> list[str]:
    return [_line(field, offset, "put") for field, offset in _offsets(message)]


def _unpack_lines(message: Message) -> list[str]:
    return [_line(field, offset, "get") for field, offset in _offsets(message)]


def _offsets(message: Message) -> list[tuple[Field, int]]:
    placed, offset = [], 0
    for field in message.fields:
        placed.append((field, offset))
        offset += field.size
    return placed


def _line(field: Field, offset: int, verb: str) -> str:
    if field.count > 1:
        to, source = f"payload + {offset}", f"self->{field.name}"
        pair = f"{to}, {source}" if verb == "put" else f"{source}, {to}"
        return f"copy_bytes({pair}, {field.count}u);"
    cast = field.wire_type.c_name
    width = 8 * field.wire_type.size
    if verb == "put":
        return f"put_u{width}(payload + {offset}, (uint{width}_t)self->{field.name});"
    return f"self->{field.name} = ({cast})get_u{width}(payload + {offset});"
