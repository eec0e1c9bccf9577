"""The firmware's receiver on good, damaged and hostile bytes: every delimited frame is accepted or counted once."""

import struct
import zlib

import pytest
from cobs import cobs
from hypothesis import example, given, settings
from hypothesis import strategies as st

from records.protocol import PROTOCOL
from rig.link.frames import encode_frame
from tests.firmware.box import REFUSALS, Box, sample_words, word
from tests.soak import SOAK

EXAMPLES = 300 if SOAK else 60


def raw_frame(content: bytes) -> bytes:
    """A frame with a good CRC around any content."""
    return cobs.encode(content + struct.pack("<I", zlib.crc32(content))) + b"\0"


def one_bit_off(line: bytes) -> bytes:
    """The frame with one bit of its last content byte changed and still no zero inside."""
    return line[:-2] + bytes([line[-2] ^ (1 if line[-2] != 1 else 2)]) + line[-1:]


def bad_cobs(line: bytes) -> bytes:
    return b"\xf0" + line[1:]


BAD_FRAMES = {
    "cobs_errors": bad_cobs(raw_frame(struct.pack("<BBH", 1, 1, 0))),
    "too_long": b"\x01" * 300 + b"\0",
    "too_short": cobs.encode(b"\x01\x01\x01") + b"\0",
    "crc_errors": one_bit_off(raw_frame(struct.pack("<BBH", 1, 1, 0))),
    "wrong_version": raw_frame(struct.pack("<BBH", 2, 1, 0)),
    "unknown_type": raw_frame(struct.pack("<BBH", 1, 0x7F, 0)),
    "wrong_length": raw_frame(struct.pack("<BBH", 1, 1, 0) + b"x"),
}


@pytest.mark.parametrize("counter", BAD_FRAMES)
def test_each_kind_of_bad_frame_has_its_own_counter_and_no_answer(counter):
    box = Box()
    assert box.feed(BAD_FRAMES[counter]) == []
    counted = box.counters
    assert {name: counted[name] for name in REFUSALS} == {name: int(name == counter) for name in REFUSALS}
    assert counted["frames_accepted"] == 1


@pytest.mark.parametrize("length", range(4))
def test_a_sound_crc_does_not_make_a_frame_of_less_than_a_header(length):
    box = Box()
    assert box.feed(raw_frame(bytes([PROTOCOL.version, 1, 0])[:length])) == []
    assert box.counters["too_short"] == 1


def test_the_number_of_the_last_frame_on_another_message_is_stale():
    box = Box()
    box.arm("LOOP")
    box.sequence -= 1
    assert box.send("SAMPLE", **sample_words(0.1, 0.0)) == []
    assert box.view.steps == 0
    assert box.counters["stale"] == 1


def test_empty_frames_are_no_errors():
    box = Box()
    box.feed(b"\0\0\0")
    assert box.counters["frames_accepted"] == 1
    assert sum(box.counters[name] for name in REFUSALS) == 0


def test_the_board_does_not_take_its_own_messages():
    box = Box()
    for message in PROTOCOL.messages:
        if not message.to_board:
            assert box.feed(raw_frame(struct.pack("<BBH", 1, message.code, 0) + bytes(message.size))) == []
    assert box.counters["unknown_type"] == sum(not message.to_board for message in PROTOCOL.messages)


@given(st.binary(max_size=400))
@example(b"\x01" * 400)
@settings(max_examples=EXAMPLES, deadline=None)
def test_after_any_bytes_the_receiver_is_back_within_one_frame(garbage):
    box = Box()
    box.feed(garbage)
    first, second = box.send("IDENTIFY"), box.send("IDENTIFY")
    assert len(second) == 1
    assert second[0].message.name == "IDENTITY"
    assert len(first) == 1 or garbage[-1:] != b"\0"


@given(st.binary(max_size=400))
@settings(max_examples=EXAMPLES, deadline=None)
def test_every_delimited_piece_is_accepted_or_counted_exactly_once(garbage):
    box = Box()
    box.feed(garbage + b"\0")
    counted = box.counters
    pieces = sum(piece != b"" for piece in garbage.split(b"\0"))
    assert counted["frames_accepted"] - 1 + sum(counted[name] for name in REFUSALS) == pieces


@given(st.data())
@settings(max_examples=EXAMPLES, deadline=None)
def test_no_damaged_sample_moves_the_law(data):
    box = Box()
    box.arm("LOOP")
    line = box.line("SAMPLE", **sample_words(0.3, 0.1))
    at = data.draw(st.integers(0, len(line) - 2))
    bit = data.draw(st.integers(0, 7))
    damaged = bytearray(line)
    damaged[at] ^= 1 << bit
    box.feed(bytes(damaged) + b"\0")
    assert box.view.steps == 0
    assert sum(box.counters[name] for name in REFUSALS) >= 1


def test_gaps_in_the_sequence_are_counted_frame_by_frame():
    box = Box()
    box.send("IDENTIFY")
    for _ in range(5):
        box.line("GET_COUNTERS")
    assert box.counters["frames_lost"] == 5


def test_the_sequence_wraps_without_a_loss():
    box = Box()
    box.sequence = 0xFFFE
    box.send("IDENTIFY")
    for _ in range(3):
        assert box.counters["frames_lost"] == 0


def test_a_frame_from_the_past_is_refused_and_counted():
    box = Box()
    box.arm("LOOP")
    old = box.line("SAMPLE", **sample_words(0.1, 0.0))
    box.sample()
    assert box.feed(old) == []
    assert box.view.steps == 1
    assert box.counters["stale"] == 1


def test_disarm_is_obeyed_whatever_its_number():
    box = Box()
    old = encode_frame(PROTOCOL, "DISARM", 0x8005, {})
    box.send("IDENTIFY")
    box.arm("FLYING")
    box.feed(old)
    assert box.state == "DISARMED"
    assert box.counters["frames_lost"] == 0


def test_a_new_session_may_start_with_any_number():
    box = Box()
    box.arm("LOOP")
    box.sequence = 40_000
    assert box.ask("IDENTIFY").message.name == "IDENTITY"
    assert box.sample().message.name == "ANSWER"
    assert box.counters["frames_lost"] == 0


def test_a_repeated_sample_is_answered_from_memory():
    box = Box()
    box.arm("LOOP")
    line = box.line("SAMPLE", **sample_words(0.3, 0.1))
    (first,) = box.feed(line)
    (again,) = box.feed(line)
    assert box.view.steps == 1
    assert again.values == first.values
    assert again.sequence == first.sequence + 1
    assert box.counters["repeated"] == 1


def test_the_board_numbers_its_frames_and_echoes_the_last_accepted():
    box = Box()
    frames = [box.ask("GET_COUNTERS") for _ in range(4)]
    assert [frame.sequence for frame in frames] == [0, 1, 2, 3]
    assert [frame.number("echo_sequence") for frame in frames] == [0, 1, 2, 3]
    box.feed(BAD_FRAMES["crc_errors"])
    box.sequence += 10
    assert box.ask("GET_COUNTERS").number("echo_sequence") == 14


def test_cutting_a_frame_after_every_byte_never_acts_and_costs_one_frame():
    line = encode_frame(PROTOCOL, "SAMPLE", 1, sample_words(0.3, 0.1))
    for cut in range(len(line)):
        box = Box()
        box.arm("LOOP")
        box.feed(line[:cut])
        box.sequence = 2
        assert box.view.steps == 0
        box.feed(b"\0")
        assert box.view.steps == (1 if cut == len(line) - 1 else 0)
        assert box.sample().message.name == "ANSWER"


def test_numbers_cross_the_line_as_raw_words():
    box = Box()
    box.arm("LOOP")
    answer = box.sample(psi_ref_rad=0.25, psi_rad=0.125)
    assert answer.number("u_M_V") == word(1.25)
