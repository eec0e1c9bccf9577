"""A serial port belongs to one host, its modem lines to whoever asks for them, and a slow adapter is told."""

import fcntl
import os
import pty
import struct
import termios
from collections.abc import Iterator
from pathlib import Path

import pytest

from records.errors import BadInput
from rig.link.adapter import latency_note
from rig.link.port import ModemLines, claimed, open_port

DTR, RTS = (struct.pack("I", mask) for mask in (termios.TIOCM_DTR, termios.TIOCM_RTS))


@pytest.fixture
def device() -> Iterator[str]:
    ours, theirs = pty.openpty()
    yield os.ttyname(theirs)
    os.close(ours)
    os.close(theirs)


def test_a_port_in_use_is_refused_and_free_again_when_it_is_closed(device: str) -> None:
    first = open_port(device, timeout_s=0.1)
    for attempt in (lambda: open_port(device, timeout_s=0.1), lambda: claimed(device).__enter__()):
        with pytest.raises(BadInput, match="a port in use by another program"):
            attempt()
    first.close()
    with claimed(device), pytest.raises(BadInput, match="in use"):
        open_port(device, timeout_s=0.1)
    open_port(device, timeout_s=0.1).close()


def test_a_file_that_is_no_serial_line_is_called_that(tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    path.touch()
    for url in (str(path), os.devnull):
        with pytest.raises(BadInput, match=": got a file or device that is no serial line, expected"):
            open_port(url, timeout_s=0.1)


@pytest.mark.parametrize(
    ("lines", "calls"),
    [
        (ModemLines(), []),
        (ModemLines(dtr=True), [(termios.TIOCMBIS, DTR)]),
        (ModemLines(rts=False), [(termios.TIOCMBIC, RTS)]),
        (ModemLines(dtr=False, rts=True), [(termios.TIOCMBIC, DTR), (termios.TIOCMBIS, RTS)]),
    ],
)
def test_a_modem_line_is_moved_where_it_was_asked_for_and_nowhere_else(
    device: str, lines: ModemLines, calls: list[tuple[int, bytes]], monkeypatch: pytest.MonkeyPatch
) -> None:
    seen: list[tuple[int, bytes]] = []
    kernel = fcntl.ioctl

    def seeing(handle: int, request: int, argument: bytes = b"", *rest: object) -> object:
        if request in (termios.TIOCMBIS, termios.TIOCMBIC):
            seen.append((request, argument))  # a pseudo-terminal has none
            return 0
        return kernel(handle, request, argument, *rest)

    monkeypatch.setattr(fcntl, "ioctl", seeing)
    open_port(device, timeout_s=0.1, lines=lines).close()
    assert seen == calls


def test_an_adapter_that_waits_is_told_with_the_command_that_shortens_it(tmp_path: Path) -> None:
    timer = tmp_path / "ttyUSB7" / "device" / "latency_timer"
    assert "16 ms as delivered" in str(latency_note("/dev/ttyUSB7", 0.017, tmp_path))
    timer.parent.mkdir(parents=True)
    timer.write_text("16\n")
    assert latency_note("/dev/ttyUSB7", 0.0099, tmp_path) is None
    told = str(latency_note("/dev/ttyUSB7", 0.017, tmp_path))
    assert "a round trip takes 17 ms: the adapter's latency timer is 16 ms" in told
    assert f"echo 1 | sudo tee {timer}" in told


def test_an_adapter_without_the_line_s_speed_is_told_with_the_speed_that_it_took(
    device: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Truth: a driver that has 115200 baud at most takes that for 921600, without a word."""
    kernel = termios.tcsetattr

    def slow(handle: int, when: int, settings: list[object]) -> None:
        at_most = [termios.B115200 if entry == termios.B921600 else entry for entry in settings]
        kernel(handle, when, at_most)

    monkeypatch.setattr(termios, "tcsetattr", slow)
    with pytest.raises(BadInput, match="runs at 115200 baud") as caught:
        open_port(device, timeout_s=0.1)
    assert caught.value.expected == "921600 baud"
    monkeypatch.undo()
    open_port(device, timeout_s=0.1).close()  # nobody holds it
