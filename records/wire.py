"""What a serial protocol is made of: scalars, fields, messages, enumerations, and the hash that names a declaration."""

import hashlib
import struct
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

from records.loops import Loop


@dataclass(frozen=True)
class WireType:
    """A scalar on the line: its C type, its `struct` code and its size in bytes."""

    c_name: str
    struct_code: str
    size: int


U8 = WireType("uint8_t", "B", 1)
U16 = WireType("uint16_t", "H", 2)
U32 = WireType("uint32_t", "I", 4)
I16 = WireType("int16_t", "h", 2)
I32 = WireType("int32_t", "i", 4)


@dataclass(frozen=True)
class Field:
    """One field of a message; `is_number` marks a raw 32-bit word of the law's own arithmetic (float32 or fixed point)."""

    name: str
    wire_type: WireType
    unit: str
    meaning: str
    count: int = 1
    is_number: bool = False

    @property
    def size(self) -> int:
        """Bytes on the line."""
        return self.wire_type.size * self.count


@dataclass(frozen=True)
class Message:
    """One message: its type code, whether it travels to the board, and its fields in line order."""

    name: str
    code: int
    to_board: bool
    meaning: str
    fields: tuple[Field, ...] = ()

    @cached_property
    def size(self) -> int:
        """Payload bytes on the line."""
        return sum(field.size for field in self.fields)

    @cached_property
    def layout(self) -> struct.Struct:
        """The payload on the line: bytes from and to the fields' values in their order."""
        codes = (part.wire_type.struct_code if part.count == 1 else f"{part.count}s" for part in self.fields)
        return struct.Struct("<" + "".join(codes))


@dataclass(frozen=True)
class Choice:
    """One value of an enumeration with the sentence that a person reads."""

    name: str
    code: int
    sentence: str


@dataclass(frozen=True)
class Enumeration:
    """A closed set of codes."""

    name: str
    meaning: str
    choices: tuple[Choice, ...]

    def code(self, name: str) -> int:
        """Code of the choice called `name`; raises KeyError when there is none."""
        return {choice.name: choice.code for choice in self.choices}[name]

    def name_of(self, code: int) -> str:
        """Name of the choice with `code`, also for a code that a newer board may send."""
        return next((choice.name for choice in self.choices if choice.code == code), str(code))

    def sentence(self, code: int) -> str:
        """What a person reads for `code`, also for a code that a newer board may send."""
        return next((choice.sentence for choice in self.choices if choice.code == code), f"unknown code {code}")


@dataclass(frozen=True)
class Constant:
    """A number that both ends must agree on."""

    name: str
    value: int
    meaning: str


@dataclass(frozen=True)
class Protocol:
    """The whole declaration for a law of `loops`; `schema_hash` changes with every change that the other end could notice."""

    version: int
    constants: tuple[Constant, ...]
    enumerations: tuple[Enumeration, ...]
    messages: tuple[Message, ...]
    loops: tuple[Loop, ...]

    @cached_property
    def schema_hash(self) -> bytes:
        """First 8 bytes of the SHA-256 of the canonical declaration (names, codes, types, counts, units; no prose)."""
        return hashlib.sha256(canonical_text(self).encode()).digest()[:8]

    def message(self, name: str) -> Message:
        """The message called `name`; raises KeyError when there is none."""
        return self._by_name[name]

    @cached_property
    def by_code(self) -> Mapping[int, Message]:
        """Each message by its type code."""
        return {message.code: message for message in self.messages}

    @cached_property
    def _by_name(self) -> Mapping[str, Message]:
        return {message.name: message for message in self.messages}

    def enumeration(self, name: str) -> Enumeration:
        """The enumeration called `name`; raises KeyError when there is none."""
        return {enumeration.name: enumeration for enumeration in self.enumerations}[name]

    def constant(self, name: str) -> int:
        """Value of the constant called `name`; raises KeyError when there is none."""
        return {constant.name: constant.value for constant in self.constants}[name]


HEADER_SIZE = 4
CRC_SIZE = 4


def canonical_text(protocol: Protocol) -> str:
    """The declaration as text, one fact a line, for the schema hash."""
    lines = [f"protocol {protocol.version}"]
    lines += [f"constant {constant.name} {constant.value}" for constant in protocol.constants]
    for enumeration in protocol.enumerations:
        lines += [f"enum {enumeration.name} {choice.name} {choice.code}" for choice in enumeration.choices]
    for message in protocol.messages:
        lines.append(f"message {message.name} {message.code} {'to' if message.to_board else 'from'} board")
        lines += [
            f"field {field.name} {field.wire_type.c_name} {field.count} {field.unit} {field.is_number}"
            for field in message.fields
        ]
    return "\n".join(lines) + "\n"
