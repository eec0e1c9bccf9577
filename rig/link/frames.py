"""Frames of the declared protocol on the host: encode, and a receiver that survives any bytes."""

import struct
import zlib
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from records.wire import CRC_SIZE, HEADER_SIZE, Message, Protocol
from rig.link.cobs import cobs_decode, cobs_encode

Value = int | bytes
DELIMITER = b"\0"


@dataclass(frozen=True)
class Frame:
    """One accepted frame: its message, the sender's number of it, and its fields by name."""

    message: Message
    sequence: int
    values: Mapping[str, Value]

    def number(self, name: str) -> int:
        """An integer field."""
        value = self.values[name]
        assert isinstance(value, int)
        return value

    def octets(self, name: str) -> bytes:
        """A field of several bytes."""
        value = self.values[name]
        assert isinstance(value, bytes)
        return value


@dataclass(frozen=True)
class Received:
    """What came off the line, by fate: each delimited piece that is not empty is in exactly one count, named as in COUNTERS."""

    bytes: int = 0
    frames: int = 0
    cobs_errors: int = 0
    too_long: int = 0
    too_short: int = 0
    crc_errors: int = 0
    wrong_version: int = 0
    unknown_type: int = 0
    wrong_length: int = 0

    @property
    def noise(self) -> int:
        """Pieces that are no frame."""
        return self.cobs_errors + self.too_long + self.too_short + self.crc_errors

    @property
    def foreign(self) -> int:
        """Sound frames of another protocol version, type or length."""
        return self.wrong_version + self.unknown_type + self.wrong_length


@dataclass
class FrameReceiver:
    """Bytes to frames; a damaged frame costs at most itself, the next delimiter is a new start.

    `types` are the codes of the messages that are taken, None takes all of the protocol.
    """

    protocol: Protocol
    pending: bytearray = field(default_factory=bytearray)
    received: Received = Received()
    types: frozenset[int] | None = None
    _longest: int = field(init=False)

    def __post_init__(self) -> None:
        self._longest = max(line_length(message) for message in self.protocol.messages)

    def feed(self, data: bytes) -> list[Frame]:
        """Take bytes off the line; returns the frames that they completed."""
        *ended, rest = (bytes(self.pending) + data).split(DELIMITER)
        self.pending = bytearray(
            rest[-self._longest - 1 :]
        )  # one more than the longest frame is enough to know it for too long
        fates = [self._judge(piece) for piece in ended if piece]
        counts = Counter("frames" if isinstance(fate, Frame) else fate for fate in fates) + Counter(bytes=len(data))
        self.received = replace(
            self.received, **{name: getattr(self.received, name) + count for name, count in counts.items()}
        )
        return [fate for fate in fates if isinstance(fate, Frame)]

    def _judge(self, piece: bytes) -> Frame | str:
        """The frame in an encoded piece, or the name of what is wrong with it; in the order of firmware/control/link.c."""
        if len(piece) > self._longest:
            return "too_long"
        content = cobs_decode(piece)
        if content is None:
            return "cobs_errors"
        if len(content) < HEADER_SIZE + CRC_SIZE:
            return "too_short"
        (crc,) = struct.unpack("<I", content[-CRC_SIZE:])
        content = content[:-CRC_SIZE]
        if zlib.crc32(content) != crc:
            return "crc_errors"
        return foreign(self.protocol, content, self.types) or _unpacked(self.protocol, content)


def encode_frame(protocol: Protocol, name: str, sequence: int, values: Mapping[str, Value]) -> bytes:
    """The bytes on the line of message `name`, delimiter included; all fields must be given, and no others."""
    message = protocol.message(name)
    payload = message.layout.pack(*(values[part.name] for part in message.fields))
    content = struct.pack("<BBH", protocol.version, message.code, sequence & 0xFFFF) + payload
    return cobs_encode(content + struct.pack("<I", zlib.crc32(content))) + DELIMITER


def line_length(message: Message) -> int:
    """Bytes of a message on the line, COBS code byte and delimiter included."""
    return HEADER_SIZE + message.size + CRC_SIZE + 2


def foreign(protocol: Protocol, content: bytes, types: frozenset[int] | None = None) -> str | None:
    """The name of what is foreign about checked `content` (header and payload), None for a frame of the protocol."""
    version, code, _ = struct.unpack_from("<BBH", content)
    message = protocol.by_code.get(code)
    if version != protocol.version:
        return "wrong_version"
    if message is None or (types is not None and code not in types):
        return "unknown_type"
    return None if len(content) == HEADER_SIZE + message.size else "wrong_length"


def _unpacked(protocol: Protocol, content: bytes) -> Frame:
    _, code, sequence = struct.unpack_from("<BBH", content)
    message = protocol.by_code[code]
    values = message.layout.unpack_from(content, HEADER_SIZE)
    names = [part.name for part in message.fields]
    return Frame(message, sequence, dict(zip(names, values, strict=True)))
