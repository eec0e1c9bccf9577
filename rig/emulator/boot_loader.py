"""The serial boot loader that ST puts into the chip's system memory, by its protocol (AN3155), and what can go wrong with it.

The first byte must be 0x7F, from which the loader takes the line's speed. A command is its code and the code's complement; blocks
end in the XOR of their bytes. The loader answers ACK, or NACK and waits for the next command. A host that falls silent within a
command leaves it waiting. Emulated: GET, GET VERSION, GET ID, READ, GO, WRITE, EXTENDED ERASE, of the STM32G071 (AN2606, RM0444 3).
"""

from collections.abc import Generator
from dataclasses import dataclass
from enum import IntEnum
from functools import reduce
from operator import xor

from records.board import STM32G071, Board

SYNCHRONISE = 0x7F
ACK, NACK = 0x79, 0x1F
VERSION = 0x31
ERASED = b"\xff"
WHOLE_FLASH = 0xFFFF
BANKS = 0xFFF0  # from here on the number of pages is a code, of which this chip of one bank knows only the whole

Talk = Generator[None, int, None]
Block = Generator[None, int, bytes | None]


class Command(IntEnum):
    """Codes of AN3155, section 3."""

    GET = 0x00
    GET_VERSION = 0x01
    GET_ID = 0x02
    READ = 0x11
    GO = 0x21
    WRITE = 0x31
    ERASE = 0x44


@dataclass(frozen=True)
class LoaderFaults:
    """What a loader can be made to do wrong: which other chip it says it is, commands that it refuses, when it falls silent, worn flash.

    `silent_after` bytes taken, it answers no more. Writes at `refused_address` and above are answered NACK. The bits of the byte
    at `worn_address` cannot be programmed.
    """

    chip_id: int | None = None
    refused: frozenset[Command] = frozenset()
    silent_after: int | None = None
    refused_address: int | None = None
    worn_address: int | None = None


class BootLoader:
    """A chip in its boot loader: `take` bytes from the host, get the loader's answer. `go_address` is where it was sent, if it was."""

    def __init__(self, faults: LoaderFaults | None = None, flash: bytes = b"", chip: Board = STM32G071) -> None:
        self.faults, self.chip = faults or LoaderFaults(), chip
        self.flash = bytearray(flash.ljust(chip.flash.size_bytes, ERASED))
        self.sram = bytearray(chip.ram.size_bytes)
        self.go_address: int | None = None
        self._taken = 0
        self._answer = bytearray()
        self._talk = self._listen()
        next(self._talk)

    def take(self, data: bytes) -> bytes:
        """What the loader answers to these bytes; nothing once it has left for a program."""
        for byte in data:
            if self.go_address is not None or self._taken == self.faults.silent_after:
                break
            self._taken += 1
            self._talk.send(byte)
        answer = bytes(self._answer)
        self._answer.clear()
        return answer

    # --- the protocol ---

    def _listen(self) -> Talk:
        while (yield) != SYNCHRONISE:
            pass
        self._say(ACK)
        while True:
            code = yield
            complement = yield
            command = _command(code, complement)
            if command is None or command in self.faults.refused:
                self._say(NACK)
                continue
            self._say(ACK)
            yield from self._obey(command)

    def _obey(self, command: Command) -> Talk:
        match command:
            case Command.GET:
                self._say(len(Command), VERSION, *Command, ACK)
            case Command.GET_VERSION:
                self._say(VERSION, 0, 0, ACK)
            case Command.GET_ID:
                chip_id = self.chip.boot_loader_id if self.faults.chip_id is None else self.faults.chip_id
                self._say(1, *chip_id.to_bytes(2, "big"), ACK)
            case Command.READ:
                yield from self._read()
            case Command.GO:
                yield from self._go()
            case Command.WRITE:
                yield from self._write()
            case Command.ERASE:
                yield from self._erase()

    def _read(self) -> Talk:
        address = yield from self._address()
        if address is None:
            return
        count = yield
        complement = yield
        content = self._memory(address, count + 1)
        if count ^ complement != 0xFF or content is None:
            self._say(NACK)
            return
        self._say(ACK, *content)

    def _go(self) -> Talk:
        self.go_address = yield from self._address()

    def _write(self) -> Talk:
        address = yield from self._address()
        if address is None:
            return
        count = yield
        data = yield from self._block(count + 1, begun_with=bytes([count]))
        refused = self.faults.refused_address is not None and address + count >= self.faults.refused_address
        memory = None if data is None else self._memory(address, len(data))
        if data is None or memory is None or refused:
            self._say(NACK)
            return
        self._program(address, data)
        self._say(ACK)

    def _erase(self) -> Talk:
        high = yield
        low = yield
        number = high << 8 | low
        if self._pages <= number < BANKS:
            self._say(NACK)
            return
        listed = yield from self._block(0 if number >= BANKS else 2 * (number + 1), begun_with=bytes([high, low]))
        pages = None if listed is None else self._named(number, listed)
        if pages is None:
            self._say(NACK)
            return
        for page in pages:
            size = self.chip.flash_page_bytes
            self.flash[page * size : (page + 1) * size] = ERASED * size
        self._say(ACK)

    def _address(self) -> Generator[None, int, int | None]:
        """Four bytes and their XOR; answered ACK, or NACK and None where no memory begins there."""
        octets = yield from self._block(4)
        address = None if octets is None else int.from_bytes(octets, "big")
        if address is None or self._memory(address, 1) is None:
            self._say(NACK)
            return None
        self._say(ACK)
        return address

    def _block(self, count: int, begun_with: bytes = b"") -> Block:
        """`count` bytes, and the XOR over them and those before; None where it does not hold."""
        data = bytearray()
        for _ in range(count):
            data.append((yield))
        checksum = yield
        return bytes(data) if checksum == reduce(xor, begun_with + bytes(data)) else None

    def _say(self, *octets: int) -> None:
        self._answer += bytes(octets)

    @property
    def _pages(self) -> int:
        return self.chip.flash.size_bytes // self.chip.flash_page_bytes

    def _named(self, number: int, listed: bytes) -> range | list[int] | None:
        """The pages that EXTENDED ERASE names; None for one that the chip has not."""
        if number == WHOLE_FLASH:
            return range(self._pages)
        pages = [int.from_bytes(listed[at : at + 2], "big") for at in range(0, len(listed), 2)]
        return pages if number < BANKS and all(page < self._pages for page in pages) else None

    # --- the memories ---

    def _memory(self, address: int, count: int) -> bytes | None:
        """The bytes there; None outside flash and that part of the RAM which the loader does not use itself."""
        flash, ram = self.chip.flash, self.chip.ram
        if flash.start <= address <= flash.end - count:
            return bytes(self.flash[address - flash.start : address - flash.start + count])
        if ram.start + self.chip.boot_loader_ram_bytes <= address <= ram.end - count:
            return bytes(self.sram[address - ram.start : address - ram.start + count])
        return None

    def _program(self, address: int, data: bytes) -> None:
        """AN3155 promises no verification: what cannot be programmed stays, and it is for the host to read it back."""
        if address >= self.chip.ram.start:
            start = address - self.chip.ram.start
            self.sram[start : start + len(data)] = data
            return
        start, step = address - self.chip.flash.start, self.chip.flash_write_bytes
        first, last = start - start % step, -(-(start + len(data)) // step) * step
        wanted = bytearray(self.flash[first:last])
        wanted[start - first : start - first + len(data)] = data
        for at in range(first, last, step):
            if self.flash[at : at + step] == ERASED * step:
                self.flash[at : at + step] = wanted[at - first : at - first + step]
        worn = self.faults.worn_address
        if worn is not None:
            self.flash[worn - self.chip.flash.start] = 0xFF


def _command(code: int, complement: int) -> Command | None:
    return Command(code) if code ^ complement == 0xFF and code in {known.value for known in Command} else None
