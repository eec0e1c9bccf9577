"""The declaration of the protocol is consistent, and its hash changes with whatever the other end could notice."""

from dataclasses import replace

import pytest

from records.protocol import PROTOCOL
from records.wire import CRC_SIZE, HEADER_SIZE, U8, Field, Protocol


def test_codes_and_names_are_unique():
    for names in (
        [message.name for message in PROTOCOL.messages],
        [message.code for message in PROTOCOL.messages],
        *([choice.code for choice in enumeration.choices] for enumeration in PROTOCOL.enumerations),
        *([field.name for field in message.fields] for message in PROTOCOL.messages),
    ):
        assert len(set(names)) == len(names)


def test_the_top_bit_of_the_code_tells_the_direction():
    assert all(message.to_board == (message.code < 0x80) for message in PROTOCOL.messages)


def test_every_frame_fits_one_block():
    """Truth: a COBS block holds 254 bytes; a frame of one block has one byte of overhead, whatever its payload."""
    assert max(HEADER_SIZE + message.size + CRC_SIZE for message in PROTOCOL.messages) <= 254


def test_every_frame_of_the_board_begins_with_echo_time_and_state():
    for message in PROTOCOL.messages:
        if not message.to_board:
            assert [field.name for field in message.fields[:3]] == ["echo_sequence", "device_time_us", "state"]


def test_every_quantity_bears_its_unit_as_a_suffix():
    suffix = {"rad": "_rad", "V": "_V", "us": "_us", "PWM ticks": "_ticks", "encoder counts": "_counts"}
    for message in PROTOCOL.messages:
        for field in message.fields:
            assert field.name.endswith(suffix.get(field.unit, ""))


def test_a_code_without_a_sentence_is_named_as_it_is():
    assert PROTOCOL.enumeration("reason").sentence(200) == "unknown code 200"


def first_message(protocol: Protocol, **changes) -> Protocol:
    first, *others = protocol.messages
    return replace(protocol, messages=(replace(first, **changes), *others))


@pytest.mark.parametrize(
    "changed",
    [
        replace(PROTOCOL, version=PROTOCOL.version + 1),
        replace(PROTOCOL, constants=(replace(PROTOCOL.constants[0], value=11), *PROTOCOL.constants[1:])),
        replace(PROTOCOL, enumerations=PROTOCOL.enumerations[1:]),
        first_message(PROTOCOL, code=0x44),
        first_message(PROTOCOL, name="WHO"),
        first_message(PROTOCOL, fields=(Field("more", U8, "1", "one more field"),)),
    ],
    ids=["version", "constant", "enumeration", "code", "name", "field"],
)
def test_the_hash_changes_with_what_the_other_end_could_notice(changed):
    assert changed.schema_hash != PROTOCOL.schema_hash


def test_the_hash_does_not_change_with_prose():
    assert first_message(PROTOCOL, meaning="Said otherwise.").schema_hash == PROTOCOL.schema_hash
