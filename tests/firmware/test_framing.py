"""COBS and CRC of the firmware, and COBS of the host, against the packages of the field and against each other."""

import zlib

import pytest
from cobs import cobs
from crccheck.crc import Crc32
from hypothesis import given, settings
from hypothesis import strategies as st

from rig.link.cobs import cobs_decode, cobs_encode
from tests.firmware.box import compiled
from tests.soak import SOAK

EXAMPLES = 300 if SOAK else 60
BLOCK_BORDERS = [0, 1, 2, 253, 254, 255, 256, 507, 508, 509, 510, 762, 1016]
PAYLOADS = [bytes([fill]) * length for fill in (0, 1, 255) for length in BLOCK_BORDERS]
PAYLOADS += [b"\x01" * length + b"\x00" for length in BLOCK_BORDERS] + [
    b"\x00" + b"\x01" * length for length in BLOCK_BORDERS
]
PAYLOADS += [b"\x01" * length + b"\x00" + b"\x02" * 254 for length in BLOCK_BORDERS]
data_with_zeros = st.binary(max_size=600) | st.lists(st.sampled_from([0, 0, 1, 255]), max_size=600).map(bytes)


def c_encode(data: bytes) -> bytes:
    ffi, lib = compiled()
    out = ffi.new("uint8_t[]", len(data) + len(data) // 254 + 1)
    return bytes(ffi.buffer(out, lib.cobs_encode(data, len(data), out)))


def c_decode(data: bytes) -> bytes | None:
    ffi, lib = compiled()
    left_over = b"\x02\x01" * 200  # as from an earlier, longer frame: what is read past the end looks sound
    inout = ffi.new("uint8_t[]", data + left_over)  # decoded in place, as the link does
    length = lib.cobs_decode(inout, len(data), inout)
    return None if length == 2 ** (8 * ffi.sizeof("size_t")) - 1 else bytes(ffi.buffer(inout, length))


@pytest.mark.parametrize("data", PAYLOADS, ids=lambda data: f"{len(data)}x{data[:1].hex()}{data[-1:].hex()}")
def test_both_encoders_give_the_reference_bytes_at_the_borders_of_blocks(data):
    expected = cobs.encode(data)
    assert c_encode(data) == expected
    assert cobs_encode(data) == expected
    assert c_decode(expected) == data
    assert cobs_decode(expected) == data


@given(data_with_zeros)
@settings(max_examples=EXAMPLES, deadline=None)
def test_encoding_is_the_reference_encoding_and_decodes_to_the_data(data):
    encoded = cobs.encode(data)
    assert c_encode(data) == encoded
    assert cobs_encode(data) == encoded
    assert 0 not in encoded
    assert c_decode(encoded) == cobs_decode(encoded) == data


@given(data_with_zeros)
@settings(max_examples=EXAMPLES, deadline=None)
def test_both_decoders_refuse_what_the_reference_refuses(garbage):
    try:
        expected = cobs.decode(garbage) if garbage else None
    except cobs.DecodeError:
        expected = None
    assert c_decode(garbage) == expected
    assert cobs_decode(garbage) == expected


def test_a_zero_inside_an_encoded_block_is_refused():
    assert c_decode(b"\x03\x41\x00") is None
    assert cobs_decode(b"\x03\x41\x00") is None


@given(st.binary(max_size=300))
@settings(max_examples=EXAMPLES, deadline=None)
def test_crc_is_that_of_zlib(data):
    assert compiled()[1].crc32_of(data, len(data)) == zlib.crc32(data) == Crc32.calc(data)


def test_crc_of_the_check_string_is_the_catalogued_value():
    assert compiled()[1].crc32_of(b"123456789", 9) == 0xCBF43926


@pytest.mark.parametrize("data", [b"\x41\x42", b"\x41\x00\x42", b"\x01" * 254, b"\x01" * 300])
def test_a_block_that_lacks_its_last_byte_is_refused(data):
    short = cobs.encode(data)[:-1]
    assert c_decode(short) is None
    assert cobs_decode(short) is None
