"""A line that drops, doubles, swaps, cuts, flips and babbles, all seeded: nothing false is accepted, every loss is counted."""

import random

import pytest

from records.errors import BadInput
from rig.client import BoardClient
from rig.controller import BoardController
from rig.numbers import Float32Numbers
from tests.firmware.box import DIGEST, Box, sample_words, word
from tests.rig.box_port import BoxPort

FRAMES = 6000
REFUSALS = (
    "cobs_errors",
    "too_long",
    "too_short",
    "crc_errors",
    "wrong_version",
    "unknown_type",
    "wrong_length",
    "stale",
)


def flipped(line: bytes, source: random.Random) -> bytes:
    damaged = bytearray(line)
    damaged[source.randrange(len(line))] ^= 1 << source.randrange(8)
    return bytes(damaged)


class HostileLine:
    """Takes frames in order and gives pieces of bytes; one frame may be kept back and come after the next."""

    def __init__(self, seed: int) -> None:
        self.source = random.Random(seed)
        self.kept = b""

    def carry(self, line: bytes) -> bytes:
        """What arrives for one frame sent."""
        late, self.kept = self.kept, b""
        fate = self.source.randrange(20)
        if fate == 0:
            line = b""
        elif fate == 1:
            line = line + line
        elif fate == 2:
            line = line[: self.source.randrange(len(line))]
        elif fate == 3:
            line = flipped(line, self.source)
        elif fate == 4:
            line = self.source.randbytes(self.source.randrange(300)) + line
        elif fate == 5:
            line, self.kept = b"", line
        return line + late


@pytest.mark.parametrize("seed", [1, 2])
def test_on_a_hostile_line_nothing_false_is_accepted_and_every_loss_is_counted(seed):
    box, line = Box(), HostileLine(seed)
    assert box.arm("LOOP") == "DONE"
    answered, pieces, pending = set(), 1, b""
    for _ in range(FRAMES):
        number = box.sequence
        arriving = line.carry(box.line("SAMPLE", **sample_words(number / 65536.0, 0.0)))
        *ended, pending = (pending + arriving).split(b"\0")
        pieces += sum(piece != b"" for piece in ended)
        for frame in box.feed(arriving):
            echo = frame.number("echo_sequence")
            assert frame.message.name == "ANSWER"
            assert frame.number("u_M_V") == word(10.0 * (echo / 65536.0)), "the law saw what was never sent"
            answered.add(echo)
    box.feed(b"\0")
    pieces += pending != b""
    counted = box.counters
    assert box.view.steps == len(answered)
    assert counted["frames_lost"] == FRAMES - len(answered)
    assert counted["frames_accepted"] - 1 + sum(counted[name] for name in REFUSALS) == pieces
    assert counted["repeated"] > 0
    assert all(counted[name] > 0 for name in ("crc_errors", "cobs_errors", "too_long", "too_short", "stale"))


def flight_over(port: BoxPort) -> list[float]:
    client = BoardClient.over(port, "box", table_digest=DIGEST.hex(), numbers=Float32Numbers())
    controller = BoardController(client)
    controller.reset(0.0, 0.0)
    return [controller.step(0.25, 0.0, 0.0, 0.0)[1] for _ in range(3)]


def flights_over(port: BoxPort, count: int) -> None:
    for _ in range(count):
        flight_over(port)


class NthByte:
    """Spoils the n-th byte that passes: drops it, flips a bit of it, or makes it a delimiter."""

    def __init__(self, n: int, how: str) -> None:
        self.left = n
        self.how = how

    def __call__(self, line: bytes) -> bytes:
        at, self.left = self.left, self.left - len(line)
        if not 0 <= at < len(line):
            return line
        put = {"drop": b"", "flip": bytes([line[at] ^ 0x10]), "zero": b"\0"}[self.how]
        return line[:at] + put + line[at + 1 :]


@pytest.mark.parametrize("direction", ["to_board", "to_host"])
@pytest.mark.parametrize("how", ["drop", "flip", "zero"])
def test_spoiling_the_nth_byte_for_every_n_never_spoils_a_flight(direction, how):
    expected = pytest.approx([0.001, 0.002, 0.003], rel=1e-5)
    for n in range(10_000):
        fault = NthByte(n, how)
        port = BoxPort(**{direction: fault})
        assert flight_over(port) == expected, n
        assert port.box.view.steps == 3
        if fault.left >= 0:
            break
    assert n > 100  # there were that many bytes to spoil


@pytest.mark.parametrize("direction", ["to_board", "to_host"])
def test_a_line_that_goes_silent_at_any_byte_is_an_error_in_one_line(direction):
    for n in range(0, 200, 7):
        left = n

        def fading(line: bytes) -> bytes:
            nonlocal left
            passed, left = line[: max(left, 0)], left - len(line)
            return passed

        port = BoxPort(**{direction: fading})
        with pytest.raises(BadInput) as caught:
            flights_over(port, 20)
        assert "\n" not in str(caught.value)
