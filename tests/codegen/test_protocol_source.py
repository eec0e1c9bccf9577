"""The generated protocol.c and the host's codec put the same bytes on the line, for every message and extreme values."""

import struct
import zlib
from functools import cache

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from codegen.protocol_source import protocol_source
from records.protocol import PROTOCOL
from records.wire import Message, canonical_text
from rig.link.cobs import cobs_encode
from rig.link.frames import DELIMITER, Frame, FrameReceiver, encode_frame
from toolchain.host import CText, build_shared, load_shared

WITH_FIELDS = [message for message in PROTOCOL.messages if message.fields]
RANGES = {
    "B": (0, 2**8 - 1),
    "H": (0, 2**16 - 1),
    "I": (0, 2**32 - 1),
    "h": (-(2**15), 2**15 - 1),
    "i": (-(2**31), 2**31 - 1),
}


@cache
def compiled():
    cdef = "int32_t protocol_length_to_board(uint8_t type);\n"
    for message in WITH_FIELDS:
        name = f"protocol_{message.name.lower()}"
        fields = "".join(
            f"{field.wire_type.c_name} {field.name}{f'[{field.count}]' if field.count > 1 else ''};"
            for field in message.fields
        )
        cdef += f"typedef struct {{ {fields} }} {name};\n"
        cdef += f"void {name}_pack(const {name} *self, uint8_t *payload);\n"
        cdef += f"void {name}_unpack({name} *self, const uint8_t *payload);\n"
    texts = [CText(name, text) for name, text in protocol_source(PROTOCOL).items()]
    return load_shared(cdef, build_shared("protocol", texts))


def values_of(message: Message) -> st.SearchStrategy:
    def one(field):
        if field.count > 1:
            return st.binary(min_size=field.count, max_size=field.count)
        low, high = RANGES[field.wire_type.struct_code]
        return st.sampled_from([low, high]) | st.integers(low, high)

    return st.fixed_dictionaries({field.name: one(field) for field in message.fields})


def as_python(value):
    return value if isinstance(value, int) else bytes(value)


def received(content: bytes) -> list[Frame]:
    """What the host takes of header and payload that arrive whole."""
    checked = content + struct.pack("<I", zlib.crc32(content))
    return FrameReceiver(PROTOCOL).feed(cobs_encode(checked) + DELIMITER)


@pytest.mark.parametrize("message", WITH_FIELDS, ids=lambda message: message.name)
@given(data=st.data())
@settings(max_examples=30, deadline=None)
def test_c_and_python_agree_on_every_byte_of_every_message(message, data):
    ffi, lib = compiled()
    values = data.draw(values_of(message))
    name = f"protocol_{message.name.lower()}"
    self = ffi.new(f"{name} *", values)
    packed = ffi.new("uint8_t[]", message.size)
    getattr(lib, f"{name}_pack")(self, packed)
    header = struct.pack("<BBH", PROTOCOL.version, message.code, 77)
    (frame,) = received(header + bytes(packed))
    assert dict(frame.values) == values
    other = ffi.new(f"{name} *")
    getattr(lib, f"{name}_unpack")(other, bytes(packed))
    assert {field.name: as_python(getattr(other, field.name)) for field in message.fields} == values


def test_the_board_knows_the_length_of_what_it_takes_and_takes_nothing_else():
    _, lib = compiled()
    expected = {message.code: message.size for message in PROTOCOL.messages if message.to_board}
    assert {code: lib.protocol_length_to_board(code) for code in range(256)} == {
        c: expected.get(c, -1) for c in range(256)
    }


def test_the_same_declaration_gives_the_same_text_with_its_hash():
    texts = protocol_source(PROTOCOL)
    assert texts == protocol_source(PROTOCOL)
    assert ", ".join(f"0x{byte:02x}" for byte in PROTOCOL.schema_hash) in texts["protocol.h"]


def test_every_field_states_its_unit_in_the_header():
    header = protocol_source(PROTOCOL)["protocol.h"]
    for message in WITH_FIELDS:
        for field in message.fields:
            assert f"/* {field.unit}: {field.meaning}" in header


def test_a_foreign_version_a_foreign_type_or_another_length_is_no_frame():
    content = struct.pack("<BBH", PROTOCOL.version, PROTOCOL.message("IDENTIFY").code, 0)
    assert len(received(content)) == 1
    assert received(b"\x09" + content[1:]) == []
    assert received(content[:1] + b"\x7f" + content[2:]) == []
    assert received(content + b"\0") == []


def test_a_missing_field_is_no_message():
    with pytest.raises(KeyError):
        encode_frame(PROTOCOL, "REFERENCE", 0, {"psi_ref_rad": 0})


def test_the_canonical_text_holds_no_prose():
    assert all(message.meaning not in canonical_text(PROTOCOL) for message in PROTOCOL.messages)
