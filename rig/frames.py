"""Frames of the declared protocol on the host: encode, and a receiver that survives any bytes."""

import struct
import zlib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

from records.wire import CRC_SIZE, HEADER_SIZE, Field, Message, Protocol
from rig.cobs import cobs_decode, cobs_encode

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
    """What came off the line, by fate; `noise` counts delimited pieces that are no frame."""

    bytes: int = 0
    frames: int = 0
    noise: int = 0
    foreign: int = 0  # sound frames of another protocol version, type or length


@dataclass
class FrameReceiver:
    """Bytes to frames; a damaged frame costs at most itself, the next delimiter is a new start."""

    protocol: Protocol
    pending: bytearray = field(default_factory=bytearray)
    received: Received = Received()

    def feed(self, data: bytes) -> list[Frame]:
        """Take bytes off the line; returns the frames that they completed."""
        *ended, rest = (bytes(self.pending) + data).split(DELIMITER)
        self.pending = bytearray(rest[-_LONGEST_ON_LINE:])
        frames, noise, foreign = [], 0, 0
        for piece in filter(None, ended):
            content = _checked(piece)
            frame = None if content is None else parse_content(self.protocol, content)
            if frame is not None:
                frames.append(frame)
            elif content is None:
                noise += 1
            else:
                foreign += 1
        was = self.received
        self.received = Received(
            was.bytes + len(data), was.frames + len(frames), was.noise + noise, was.foreign + foreign
        )
        return frames


_LONGEST_ON_LINE = 1024  # more without a delimiter is noise: its head need not be kept


def encode_frame(protocol: Protocol, name: str, sequence: int, values: Mapping[str, Value]) -> bytes:
    """The bytes on the line of message `name`, delimiter included; all fields must be given, and no others."""
    message = protocol.message(name)
    payload = struct.pack(_format(message.fields), *(values[part.name] for part in message.fields))
    content = struct.pack("<BBH", protocol.version, message.code, sequence & 0xFFFF) + payload
    return cobs_encode(content + struct.pack("<I", zlib.crc32(content))) + DELIMITER


def line_length(message: Message) -> int:
    """Bytes of a message on the line, COBS code byte and delimiter included."""
    return HEADER_SIZE + message.size + CRC_SIZE + 2


def parse_content(protocol: Protocol, content: bytes) -> Frame | None:
    """The frame in decoded and checked `content`; None for another protocol version, an unknown type or a wrong length."""
    version, code, sequence = struct.unpack_from("<BBH", content)
    message = next((message for message in protocol.messages if message.code == code), None)
    if version != protocol.version or message is None or len(content) != HEADER_SIZE + message.size:
        return None
    values = struct.unpack_from(_format(message.fields), content, HEADER_SIZE)
    names = [part.name for part in message.fields]
    return Frame(message, sequence, dict(zip(names, values, strict=True)))


def _checked(piece: bytes) -> bytes | None:
    """Header and payload of an encoded piece, or None where COBS, length or CRC are wrong."""
    content = cobs_decode(piece)
    if content is None or len(content) < HEADER_SIZE + CRC_SIZE:
        return None
    (crc,) = struct.unpack("<I", content[-CRC_SIZE:])
    return content[:-CRC_SIZE] if zlib.crc32(content[:-CRC_SIZE]) == crc else None


def _format(fields: Iterable[Field]) -> str:
    codes = (part.wire_type.struct_code if part.count == 1 else f"{part.count}s" for part in fields)
    return "<" + "".join(codes)
