"""Host's receiver and board's receiver on the same arbitrary bytes: the same frames, and the same counters."""

import struct
import zlib
from dataclasses import dataclass, field
from functools import cache
from typing import Any

from cobs import cobs
from hypothesis import given, settings
from hypothesis import strategies as st

from codegen.protocol_source import protocol_source
from records.protocol import PROTOCOL
from rig.link.cobs import cobs_encode
from rig.link.frames import Frame, FrameReceiver, encode_frame
from rig.programming.image import FIRMWARE_DIR
from tests.firmware.box import HERE as BOX
from tests.soak import SOAK
from toolchain.host import CText, build_shared, load_shared

EXAMPLES = 20_000 if SOAK else 100
CONTROL = FIRMWARE_DIR / "control"
TO_BOARD = {message.code: message for message in PROTOCOL.messages if message.to_board}
FAULTS = ("cobs_errors", "too_long", "too_short", "crc_errors", "wrong_version", "unknown_type", "wrong_length")
NAMES = ("frames_accepted", *FAULTS, "stale", "repeated", "frames_lost")
LARGEST = max(message.size for message in PROTOCOL.messages)
_CDEF = f"""
typedef struct {{ uint8_t type, repeated; uint16_t sequence; uint8_t payload[{LARGEST}]; }} taken_frame;
size_t link_box_size(void);
size_t link_box_payload_room(void);
size_t link_box_feed(void *self, const uint8_t *data, size_t count, taken_frame *out);
void link_box_counters(const void *self, uint32_t out[11]);
"""
Taken = tuple[int, bool, int, bytes]


@cache
def compiled() -> tuple[Any, Any]:
    """The board's receiver as (ffi, lib)."""
    texts = [CText(name, text) for name, text in protocol_source(PROTOCOL).items()]
    sources = [*(CONTROL / name for name in ("cobs.c", "crc32.c", "link.c")), BOX / "link_box.c", *texts]
    return load_shared(_CDEF, build_shared("link_box", sources, include_dirs=[CONTROL]))


def by_the_board(pieces: list[bytes]) -> tuple[list[Taken], dict[str, int]]:
    """Frames and counters of the firmware's C."""
    ffi, lib = compiled()
    assert lib.link_box_payload_room() == LARGEST
    state = ffi.new("uint64_t[]", lib.link_box_size() // 8 + 1)
    frames: list[Taken] = []
    for piece in pieces:
        out = ffi.new("taken_frame[]", len(piece) + 1)
        for row in out[0 : lib.link_box_feed(state, piece, len(piece), out)]:
            payload = bytes(row.payload)[: TO_BOARD[row.type].size]
            frames.append((row.type, bool(row.repeated), row.sequence, payload))
    counts = ffi.new("uint32_t[11]")
    lib.link_box_counters(state, counts)
    return frames, dict(zip(NAMES, counts, strict=True))


@dataclass
class Session:
    """What the protocol says of sequence numbers, once more and in the plainest words."""

    last: tuple[int, int] | None = None  # number and type of the last frame taken
    counts: dict[str, int] = field(default_factory=lambda: dict.fromkeys(("stale", "repeated", "frames_lost"), 0))

    def judge(self, frame: Frame) -> Taken | None:
        """The frame, or None for one of the past."""
        code, number = frame.message.code, frame.sequence
        repeated = self.last == (number, code)
        if self.last is not None and not repeated and frame.message.name != "IDENTIFY":
            ahead = (number - self.last[0]) % 65_536
            if ahead == 0 or ahead >= 32_768:
                self.counts["stale"] += frame.message.name != "DISARM"
                return taken(frame, False) if frame.message.name == "DISARM" else None
            self.counts["frames_lost"] += ahead - 1
        self.counts["repeated"] += repeated
        self.last = (number, code)
        return taken(frame, repeated)


def taken(frame: Frame, repeated: bool) -> Taken:
    """As the firmware's receiver gives it."""
    content = cobs.decode(encode_frame(PROTOCOL, frame.message.name, 0, frame.values)[:-1])
    return frame.message.code, repeated, frame.sequence, bytes(content[4:-4])


def by_the_host(pieces: list[bytes]) -> tuple[list[Taken], dict[str, int]]:
    """Frames and counters of the host's Python, taking only what is meant for the board."""
    receiver, session = FrameReceiver(PROTOCOL, types=frozenset(TO_BOARD)), Session()
    judged = [session.judge(frame) for piece in pieces for frame in receiver.feed(piece)]
    frames = [frame for frame in judged if frame is not None]
    faults = {name: getattr(receiver.received, name) for name in FAULTS}
    return frames, {"frames_accepted": len(frames), **faults, **session.counts}


def sound(content: bytes) -> bytes:
    """A frame with a good CRC around any content."""
    return cobs_encode(content + struct.pack("<I", zlib.crc32(content))) + b"\0"


NUMBERS = st.one_of(st.integers(0, 12), st.integers(0, 65_535))
MESSAGES = st.builds(
    lambda message, number, payload: sound(struct.pack("<BBH", 1, message.code, number) + payload[: message.size]),
    st.sampled_from(list(TO_BOARD.values())),
    NUMBERS,
    st.binary(min_size=32, max_size=32),
)
FOREIGN = st.builds(
    lambda version, code, number, payload: sound(struct.pack("<BBH", version, code, number) + payload),
    st.sampled_from([0, 1, 1, 1, 2, 255]),
    st.one_of(st.integers(0, 255), st.sampled_from(sorted(TO_BOARD))),
    NUMBERS,
    st.binary(max_size=100),
)
SHORT = st.binary(max_size=6).map(sound)


@st.composite
def spoiled(draw: Any) -> bytes:
    """A frame with one byte changed, left out or doubled."""
    line = draw(MESSAGES)
    at = draw(st.integers(0, len(line) - 1))
    return line[:at] + draw(st.sampled_from([b"", line[at : at + 1] * 2, b"\0", b"\x01", b"\xff"])) + line[at + 1 :]


NOISE = st.one_of(
    st.binary(max_size=40), st.binary(min_size=90, max_size=110).map(lambda raw: raw.replace(b"\0", b"\1"))
)
TRAFFIC = st.lists(st.one_of(MESSAGES, MESSAGES, spoiled(), FOREIGN, SHORT, NOISE), max_size=12)


@given(TRAFFIC, st.integers(1, 40))
@settings(max_examples=EXAMPLES, deadline=None)
def test_both_receivers_take_the_same_frames_and_count_the_same_faults(traffic, cut):
    data = b"".join(traffic)
    pieces = [data[at : at + cut] for at in range(0, len(data), cut)]
    assert by_the_board(pieces) == by_the_host(pieces)


@given(st.binary(max_size=600), st.integers(1, 40))
@settings(max_examples=EXAMPLES // 5, deadline=None)
def test_and_so_they_do_on_bytes_that_mean_nothing(data, cut):
    pieces = [data[at : at + cut] for at in range(0, len(data), cut)]
    assert by_the_board(pieces) == by_the_host(pieces)
