"""The board as a serial port: pyserial in virtual time, a pseudo-terminal in wall time, one client code for both."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
import serial

from rig.emulator.pty_port import PtyBoard
from rig.emulator.serial_port import EmulatedSerial, register_emulated_ports
from tests.rig.emulator.programs import build
from tests.rig.emulator.test_uart import ECHO, HOST_BYTE_S, START

BAUD = 921_600


@pytest.fixture(scope="module")
def echo() -> Path:
    return build("echo", START + ECHO)


@pytest.fixture
def port(echo: Path) -> Iterator[Any]:
    register_emulated_ports()
    with serial.serial_for_url(f"emulated://{echo}", baudrate=BAUD, timeout=0.1) as opened:
        opened.wait(1e-3)
        yield opened


@contextmanager
def pty(echo: Path) -> Iterator[Any]:
    with PtyBoard(echo) as board, serial.Serial(board.path, baudrate=BAUD, timeout=0.1) as opened:
        yield opened


def client(opened: Any) -> bytes:
    """What any client does: write, read to the end."""
    opened.write(b"twin law")
    return bytes(opened.read(8))


def test_the_same_client_works_in_virtual_time_and_over_a_pseudo_terminal(port: Any, echo: Path) -> None:
    assert client(port) == b"uxjo!mbx"
    with pty(echo) as opened:
        while opened.read(1) != b"\x02":  # the board may still be starting its clock
            opened.write(b"\x01")
        opened.reset_input_buffer()
        opened.read(100)
        opened.timeout = 5
        assert client(opened) == b"uxjo!mbx"


def test_a_write_lasts_as_long_as_its_bytes_and_a_read_as_long_as_its_timeout(port: Any) -> None:
    before = port.time_s
    port.write(bytes(50))
    assert port.time_s - before == pytest.approx(50 * HOST_BYTE_S, abs=2 * HOST_BYTE_S)
    assert port.read(50) == bytes([1] * 50)
    before = port.time_s
    port.timeout = 2.5
    assert port.read(1) == b""
    assert port.time_s - before == pytest.approx(2.5, abs=1e-6)


def test_a_read_returns_when_its_bytes_are_there(port: Any) -> None:
    port.timeout = 10
    before = port.time_s
    port.write(b"a")
    assert port.read(1) == b"b"
    assert port.time_s - before < 4 * HOST_BYTE_S
    port.timeout = None
    port.write(b"a")
    assert port.read(1) == b"b"


def test_polling_loops_end_because_looking_costs_time(port: Any) -> None:
    port.write(b"abc")
    looks = 0
    while port.in_waiting < 3:
        looks += 1
        assert looks < 10
    port.timeout = 0
    assert port.read(10) == b"bcd"
    assert port.read(10) == b""


def test_the_input_buffer_can_be_dropped(port: Any) -> None:
    port.write(b"abc")
    port.timeout = 0.01
    port.wait(1e-3)
    port.reset_input_buffer()
    assert port.read(3) == b""


def test_another_baud_rate_garbles(port: Any) -> None:
    port.baudrate = 115_200
    assert client(port) != b"uxjo!mbx"
    port.baudrate = BAUD
    port.wait(1e-3)
    port.reset_input_buffer()
    assert client(port) == b"uxjo!mbx"


def test_a_pseudo_terminal_opened_at_another_speed_garbles(echo: Path) -> None:
    with PtyBoard(echo) as board, serial.Serial(board.path, baudrate=115_200, timeout=0.1) as opened:
        opened.write(b"twin law")
        assert opened.read(8) != b"uxjo!mbx"


def test_a_board_that_talks_to_nobody_neither_hangs_nor_stops() -> None:
    chatter = build(
        "chatter", START + "void Reset_Handler(void) { usart_start(1 | 8); for (;;) TDR = 0x55; } VECTORS(0);"
    )
    with PtyBoard(chatter) as board, serial.Serial(board.path, baudrate=BAUD, timeout=5) as opened:
        assert opened.read(20_000) == b"U" * 20_000
    assert board.stop is None


def test_a_missing_image_and_a_foreign_file_are_refused_in_one_line(tmp_path: Path) -> None:
    register_emulated_ports()
    foreign = tmp_path / "foreign.elf"
    foreign.write_bytes(b"not an image")
    for path in (tmp_path / "none.elf", foreign):
        with pytest.raises(serial.SerialException, match=r"firmware image") as caught:
            serial.serial_for_url(f"emulated://{path}")
        assert "\n" not in str(caught.value)


def test_only_eight_data_bits_without_parity_are_offered(echo: Path) -> None:
    register_emulated_ports()
    with pytest.raises(ValueError, match="8 data bits"):
        serial.serial_for_url(f"emulated://{echo}", parity=serial.PARITY_EVEN)


def test_a_closed_port_and_a_stopped_board_raise(port: Any) -> None:
    stopping = build("stopping", "void Reset_Handler(void) { STOP(); } VECTORS(0);")
    stopped = serial.serial_for_url(f"emulated://{stopping}", timeout=1)
    assert isinstance(stopped, EmulatedSerial)
    with pytest.raises(serial.SerialException, match=r"BKPT 0; pc 0x.* in Reset_Handler"):
        stopped.read(1)
    port.close()
    with pytest.raises(serial.PortNotOpenError):
        port.read(1)
    port.open()
    port.wait(1e-3)
    assert client(port) == b"uxjo!mbx"
