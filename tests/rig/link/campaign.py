"""Frames by the thousand over a line in changing weather, and an account of every one of them.

`.venv/bin/python -m tests.rig.link.campaign 1000000` prints the account that docs/faults.md shows.
"""

import struct
import sys
from collections.abc import Iterable
from dataclasses import dataclass
from random import Random
from typing import Any

from records.protocol import PROTOCOL
from rig.link.frames import Frame, FrameReceiver, encode_frame
from tests.docs.reading.tables import keep
from tests.firmware.box import DIGEST, REFUSALS, word
from tests.rig.link.hostile_line import Channel
from tests.rig.link.hostile_line_faults import (
    Babble,
    Direction,
    DoubleBytes,
    DoubleFrames,
    DropBytes,
    DropFrames,
    FrameFault,
    SpoilBytes,
    SwapFrames,
    TruncateFrames,
)
from tests.rig.link.line_box import LineBox

SAMPLE = PROTOCOL.message("SAMPLE").code
BATCH = 500
KINDS = (DropFrames, DoubleFrames, SwapFrames, TruncateFrames, DropBytes, DoubleBytes, SpoilBytes, Babble)
WRONG_SPEEDS = (0.7, 0.94, 0.97, 1.03, 1.06, 1.5)


def usual_faults(direction: Direction, rate: float) -> list[FrameFault]:
    """Every kind of frame fault, each with this rate."""
    return [kind(direction=direction, rate=rate) for kind in KINDS]


@dataclass
class Account:
    """What those know who see both ends; the counters of board and host must agree with it."""

    sent: int = 0
    accepted: int = 0  # different frames that the board took, by their numbers
    repeated: int = 0
    false_at_board: int = 0  # taken, but never sent like that
    false_at_host: int = 0
    answers: int = 0  # sent by the board
    deaf: int = 0  # clear frames after a batch that were not answered at once


@dataclass
class Ear:
    """Counts the delimited pieces, empty ones aside, in all that one end heard: independent of any receiver."""

    pieces: int = 0
    rest: bytes = b""

    def hear(self, heard: bytes) -> None:
        """More bytes."""
        *ended, self.rest = (self.rest + heard).split(b"\0")
        self.pieces += sum(piece != b"" for piece in ended)


class Campaign:
    """Batches of frames, each in its own weather; between batches one frame passes over the clear line, and must."""

    def __init__(self, seed: int) -> None:
        self.source = Random(seed)
        self.line = LineBox()
        self.account = Account()
        self.host = FrameReceiver(PROTOCOL)
        self.at_board, self.at_host = Ear(), Ear()
        self.heard_answers: set[int] = set()
        self._channels = {way: Channel(way, usual_faults(way, 0.02), seed) for way in Direction}
        self._sent: dict[int, tuple[int, int]] = {}  # number: (type, word of the reference)
        self._last = -1
        self._ask("IDENTIFY", {})
        self._ask("ARM", {"mode": PROTOCOL.enumeration("mode").code("LOOP"), "digest_head": DIGEST[:8]})

    def batch(self, frames: int) -> None:
        """So many frames through one weather, then one on the clear line."""
        self._weather()
        channel = self._channels[Direction.TO_BOARD]
        self._carry(b"".join(channel.carry(self._next()) for _ in range(frames)))
        self.line.weather()
        self._carry(b"\0")  # ends whatever is half in the board's receiver, as the client does
        self.at_host.hear(b"\0")
        self.host.feed(b"\0")
        self.account.deaf += self._ask("GET_COUNTERS", {}) is None

    def counters(self) -> dict[str, int]:
        """The board's, asked on the clear line."""
        frame = self._ask("GET_COUNTERS", {})
        assert frame is not None
        return {name: frame.number(name) for name in frame.values}

    def _next(self) -> bytes:
        if self.source.random() < 0.05:
            return self._frame("GET_COUNTERS", {})
        reference = word(self.account.sent * 7919 % 65_536 / 65_536)
        return self._frame("SAMPLE", {"psi_ref_rad": reference, "phi_ref_rad": 0, "psi_rad": 0, "phi_rad": 0})

    def _frame(self, name: str, values: dict[str, Any]) -> bytes:
        number = self.account.sent & 0xFFFF
        self._sent[number] = (PROTOCOL.message(name).code, values.get("psi_ref_rad", 0))
        self.account.sent += 1
        return encode_frame(PROTOCOL, name, number, values)

    def _weather(self) -> None:
        choice = self.source.randrange(10)
        if choice == 0:
            self.line.stick(low=self.source.random() < 0.5)
            return
        rate = 10.0 ** self.source.uniform(-5.0, -2.0) if choice < 6 else 0.0
        ratio = self.source.choice(WRONG_SPEEDS) if choice == 6 else 1.0
        self.line.weather(rate, self.source.choice([1, 1, 8, 64]), self.source.randrange(1, 2**32), ratio)

    def _ask(self, name: str, values: dict[str, Any]) -> Frame | None:
        number = self.account.sent & 0xFFFF
        frames = self._carry(self._frame(name, values), clear=True)
        return next((frame for frame in frames if frame.number("echo_sequence") == number), None)

    def _carry(self, sent: bytes, clear: bool = False) -> list[Frame]:
        board, host, accepted = self.line.carry(sent)
        self.at_board.hear(board)
        self._judge(accepted)
        arriving = host if clear else self._channels[Direction.TO_HOST].carry(host)
        self.at_host.hear(arriving)
        frames = self.host.feed(arriving)
        for frame in frames:
            self.account.false_at_host += not self._true(frame)
            self.heard_answers.add(self.account.answers - ((self.account.answers - frame.sequence) & 0xFFFF))
        return frames

    def _judge(self, accepted: Iterable[tuple[int, int, int]]) -> None:
        for code, number, reference in accepted:
            as_sent = self._sent.get(number) == (code, reference if code == SAMPLE else 0)
            self.account.false_at_board += not as_sent
            self.account.repeated += number == self._last
            self.account.accepted += number != self._last
            self.account.answers += 1
            self._last = number

    def _true(self, frame: Frame) -> bool:
        """Whether an answer says what the law must have said to the frame that it echoes."""
        code, reference = self._sent[frame.number("echo_sequence")]
        if frame.message.name != "ANSWER":
            return frame.message.name in ("IDENTITY", "RESULT", "COUNTERS") and code != SAMPLE
        (psi_ref_rad,) = struct.unpack("<f", reference.to_bytes(4, "little"))
        return code == SAMPLE and frame.number("u_M_V") == word(10.0 * psi_ref_rad)


def rows(campaign: Campaign, counted: dict[str, int]) -> list[tuple[str, int]]:
    """The account as the rows of docs/faults.md's table; `counted` are the board's counters at the end."""
    account, heard = campaign.account, campaign.host.received
    refused = [name for name in REFUSALS if counted[name]]
    return [
        ("frames sent", account.sent),
        ("taken by the board", account.accepted),
        ("counted as lost (`frames_lost`)", counted["frames_lost"]),
        ("taken although never sent like that", account.false_at_board),
        ("copies recognised (`repeated`)", counted["repeated"]),
        ("pieces that the board heard", campaign.at_board.pieces),
        ("of these accepted", counted["frames_accepted"]),
        *((f"of these `{name}`", counted[name]) for name in refused),
        ("answers sent", account.answers),
        ("pieces that the host heard", campaign.at_host.pieces),
        ("of these frames", heard.frames),
        ("of these noise (`cobs_errors`, `too_long`, `too_short`, `crc_errors`)", heard.noise),
        ("answers taken that are false", account.false_at_host),
        ("clear frames after a weather that were not answered at once", account.deaf),
    ]


def flown(frames: int) -> Campaign:
    """A campaign of at least so many frames."""
    campaign = Campaign(seed=5)
    while campaign.account.sent < frames:
        campaign.batch(BATCH)
    return campaign


if __name__ == "__main__":
    asked = flown(int(sys.argv[1]))
    keep(rows(asked, asked.counters()), sys.argv[2:])
