"""The emulated serial boot loader against AN3155: what each command answers, what it refuses, and any bytes at all."""

from functools import reduce
from operator import xor

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from records.board import STM32G071
from rig.emulator.boot_loader import ACK, NACK, SYNCHRONISE, BootLoader, Command, LoaderFaults

FLASH, RAM = STM32G071.flash, STM32G071.ram
PAGE_BYTES = STM32G071.flash_page_bytes
YES, NO = bytes([ACK]), bytes([NACK])
USED = bytes(range(1, 256)) * (FLASH.size_bytes // 255 + 1)  # no byte of it reads as erased or as zero
LONGEST_BLOCK = 258  # WRITE of 256 bytes with count and checksum


def summed(block: bytes) -> bytes:
    return block + bytes([reduce(xor, block)])


def command(code: int) -> bytes:
    return bytes([code, code ^ 0xFF])


def at(address: int) -> bytes:
    return summed(address.to_bytes(4, "big"))


def data(content: bytes) -> bytes:
    return summed(bytes([len(content) - 1]) + content)


def pages(*numbers: int) -> bytes:
    return summed(b"".join(number.to_bytes(2, "big") for number in (len(numbers) - 1, *numbers)))


def synchronised(faults: LoaderFaults | None = None, flash: bytes = b"") -> BootLoader:
    loader = BootLoader(faults, flash)
    assert loader.take(bytes([SYNCHRONISE])) == YES
    return loader


def write(loader: BootLoader, address: int, content: bytes) -> bytes:
    return loader.take(command(Command.WRITE)) + loader.take(at(address)) + loader.take(data(content))


def read(loader: BootLoader, address: int, count: int) -> bytes:
    asked = bytes([count - 1, (count - 1) ^ 0xFF])
    answer = loader.take(command(Command.READ)) + loader.take(at(address)) + loader.take(asked)
    assert answer[:3] == 3 * YES
    return answer[3:]


def test_it_hears_nothing_before_the_byte_that_tells_the_speed():
    loader = BootLoader()
    assert loader.take(command(Command.GET_ID) + b"\x00\xff\x55") == b""
    assert loader.take(bytes([SYNCHRONISE])) == YES


def test_it_tells_its_commands_its_version_and_its_chip():
    loader = synchronised()
    assert loader.take(command(Command.GET)) == YES + bytes([7, 0x31, 0x00, 0x01, 0x02, 0x11, 0x21, 0x31, 0x44]) + YES
    assert loader.take(command(Command.GET_VERSION)) == YES + bytes([0x31, 0, 0]) + YES
    assert loader.take(command(Command.GET_ID)) == YES + bytes([1, 0x04, 0x60]) + YES


@pytest.mark.parametrize("code", [0x7F, 0x43, 0x63, 0x73, 0x82, 0x92, 0xFF])
def test_a_command_that_it_has_not_is_refused(code):
    loader = synchronised()
    assert loader.take(command(code)) == NO
    assert loader.take(command(Command.GET_VERSION))[:1] == YES


def test_a_second_synchronisation_is_half_a_command_and_the_third_byte_ends_it():
    # What a host sees that meets a loader which an earlier host has already spoken to.
    loader = synchronised()
    assert loader.take(bytes([SYNCHRONISE])) == b""
    assert loader.take(bytes([SYNCHRONISE])) == NO
    assert loader.take(command(Command.GET_ID))[:1] == YES


def test_what_was_erased_and_written_is_read_back():
    loader = synchronised(flash=USED[: FLASH.size_bytes])
    assert loader.take(command(Command.ERASE)) + loader.take(pages(0, 63)) == 2 * YES
    assert loader.flash[:PAGE_BYTES] == loader.flash[-PAGE_BYTES:] == b"\xff" * PAGE_BYTES
    assert loader.flash[PAGE_BYTES:-PAGE_BYTES] == USED[PAGE_BYTES : FLASH.size_bytes - PAGE_BYTES]
    assert write(loader, FLASH.start + 8, b"twinlaw!" * 32) == 3 * YES
    assert read(loader, FLASH.start, 16) == b"\xff" * 8 + b"twinlaw!"
    assert read(loader, FLASH.start + 8, 256) == b"twinlaw!" * 32


def test_the_whole_flash_can_be_erased_at_once_and_a_second_bank_is_not_there():
    loader = synchronised(flash=USED[: FLASH.size_bytes])
    assert loader.take(command(Command.ERASE)) + loader.take(b"\xff\xfe\x01") == YES + NO
    assert loader.flash == USED[: FLASH.size_bytes]
    assert loader.take(command(Command.ERASE)) + loader.take(b"\xff\xff\x00") == YES + YES
    assert loader.flash == b"\xff" * FLASH.size_bytes


def test_a_page_that_the_chip_has_not_is_refused_with_the_whole_list():
    loader = synchronised(flash=USED[: FLASH.size_bytes])
    assert loader.take(command(Command.ERASE)) + loader.take(pages(1, 64)) == YES + NO
    assert loader.take(command(Command.ERASE)) + loader.take(b"\x00\x40") == YES + NO  # 65 pages
    assert loader.flash == USED[: FLASH.size_bytes]


def test_flash_that_is_not_erased_keeps_what_it_holds_and_only_reading_back_tells():
    loader = synchronised(flash=b"\xff" * 8 + b"occupied")
    assert write(loader, FLASH.start, b"newcomer" * 2) == 3 * YES
    assert read(loader, FLASH.start, 16) == b"newcomeroccupied"


def test_ram_is_written_and_read_but_not_where_the_loader_lives():
    loader = synchronised()
    assert write(loader, RAM.end - 4, b"RAM!") == 3 * YES
    assert read(loader, RAM.end - 4, 4) == b"RAM!"
    for address in (RAM.start, 0, FLASH.start - 1, FLASH.end, 0x1FFF7800, 0xFFFFFFFF):
        assert loader.take(command(Command.WRITE)) + loader.take(at(address)) == YES + NO


def test_a_block_that_leaves_the_memory_is_refused_whole():
    loader = synchronised()
    assert write(loader, FLASH.end - 4, b"too long") == 2 * YES + NO
    assert loader.take(command(Command.READ)) + loader.take(at(FLASH.end - 1)) == 2 * YES
    assert loader.take(b"\x01\xfe") == NO
    assert loader.flash == b"\xff" * FLASH.size_bytes


def test_it_leaves_for_a_program_and_hears_no_more():
    loader = synchronised()
    assert loader.take(command(Command.GO)) + loader.take(at(0x1000)) == YES + NO
    assert loader.go_address is None
    assert loader.take(command(Command.GO)) + loader.take(at(FLASH.start) + command(Command.GET)) == 2 * YES
    assert loader.go_address == FLASH.start
    assert loader.take(bytes([SYNCHRONISE])) == b""


@pytest.mark.parametrize(
    ("code", "blocks"),
    [
        (Command.READ, [at(FLASH.start), bytes([3, 3 ^ 0xFF])]),
        (Command.WRITE, [at(FLASH.start), data(b"twinlaw!")]),
        (Command.GO, [at(FLASH.start)]),
        (Command.ERASE, [pages(1, 2)]),
    ],
)
def test_every_bit_that_flips_in_a_checked_block_is_refused_and_nothing_is_done(code, blocks):
    # The count of a block is left out: a wrong count is a block of another length, which only its own checksum could tell.
    for index, block in enumerate(blocks):
        counted = {Command.WRITE: 1, Command.ERASE: 2}.get(code, 0) if index == len(blocks) - 1 else 0
        for bit in range(8 * counted, 8 * len(block)):
            loader = synchronised(flash=USED[: FLASH.size_bytes])
            flipped = bytearray(block)
            flipped[bit // 8] ^= 1 << bit % 8
            heard = [loader.take(part) for part in (command(code), *blocks[:index], bytes(flipped))]
            assert heard == [YES] * (index + 1) + [NO], f"bit {bit} of block {index}"
            assert loader.go_address is None
            assert loader.flash == USED[: FLASH.size_bytes]


@settings(max_examples=100, deadline=None)
@given(st.binary(max_size=600), st.integers(0, 600))
def test_any_bytes_at_all_leave_a_loader_that_can_be_spoken_to_again(noise, cut):
    loader = synchronised()
    loader.take(noise[:cut])
    loader.take(noise[cut:])
    if loader.go_address is None:
        # Zeros end whatever the noise has begun: 00 00 is no command, and 0 no address.
        assert any(loader.take(b"\x00")[-1:] == NO for _ in range(LONGEST_BLOCK + 2))
        assert loader.take(command(Command.GET_VERSION)) == YES + bytes([0x31, 0, 0]) + YES
    assert len(loader.flash) == FLASH.size_bytes
    assert len(loader.sram) == RAM.size_bytes


@settings(max_examples=100, deadline=None)
@given(st.lists(st.tuples(st.integers(0, 1023), st.binary(min_size=1, max_size=64)), max_size=20), st.data())
def test_whatever_is_written_after_a_whole_erase_reads_back_as_the_first_write_to_each_double_word(writes, more):
    loader = synchronised(flash=USED[: FLASH.size_bytes])
    loader.take(command(Command.ERASE) + b"\xff\xff\x00")
    expected = bytearray(b"\xff" * 2048)
    for start, content in writes:
        assert write(loader, FLASH.start + start, content) == 3 * YES
        wanted = bytearray(expected)
        wanted[start : start + len(content)] = content
        for word in range(0, 2048, 8):
            if expected[word : word + 8] == b"\xff" * 8:
                expected[word : word + 8] = wanted[word : word + 8]
    first = more.draw(st.integers(0, 1791))
    assert read(loader, FLASH.start + first, 256) == bytes(expected[first : first + 256])


def test_a_loader_that_falls_silent_takes_so_many_bytes_and_answers_no_more():
    loader = BootLoader(LoaderFaults(silent_after=3))
    assert loader.take(b"\x7f" + command(Command.GET_ID)) == YES + YES + bytes([1, 0x04, 0x60]) + YES
    assert loader.take(command(Command.GET_ID)) == b""


def test_a_command_and_an_address_can_be_made_to_be_refused():
    assert synchronised(LoaderFaults(refused=frozenset({Command.WRITE}))).take(command(Command.WRITE)) == NO
    loader = synchronised(LoaderFaults(refused_address=FLASH.start + 8))
    assert write(loader, FLASH.start, b"twinlaw!") == 3 * YES
    assert write(loader, FLASH.start + 4, b"twinlaw!") == 2 * YES + NO
    assert read(loader, FLASH.start, 16) == b"twinlaw!" + b"\xff" * 8


def test_a_worn_byte_takes_no_bits():
    loader = synchronised(LoaderFaults(worn_address=FLASH.start + 3))
    assert write(loader, FLASH.start, b"twinlaw!") == 3 * YES
    assert read(loader, FLASH.start, 8) == b"twi\xfflaw!"
