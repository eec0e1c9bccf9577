"""What can go wrong on a serial line, one small record for each: combinable, seeded, limited to a span of virtual time.

A record says what happens and how often; it holds no state. Frame faults take one frame off the line, delimiter included, and
give the bytes that arrive in its place.
"""

from dataclasses import dataclass
from enum import Enum
from math import inf
from random import Random

DELIMITER = b"\0"


class Direction(Enum):
    """Which way the bytes travel."""

    TO_BOARD = "to_board"
    TO_HOST = "to_host"


@dataclass
class Passing:
    """What one direction of a line remembers from frame to frame: bytes that have passed, a frame kept back, whether it is dead."""

    count: int = 0
    kept: bytes = b""
    dead: bool = False


@dataclass(frozen=True, kw_only=True)
class Fault:
    """Active from `from_s` until before `until_s`, in seconds of the line's virtual time."""

    from_s: float = 0.0
    until_s: float = inf

    def active(self, t_s: float) -> bool:
        """Whether it acts at `t_s`."""
        return self.from_s <= t_s < self.until_s


@dataclass(frozen=True, kw_only=True)
class FrameFault(Fault):
    """Befalls each frame of one direction with probability `rate`."""

    direction: Direction
    rate: float = 1.0

    def arriving(self, frame: bytes, passing: Passing, source: Random) -> bytes:
        """The bytes that arrive for `frame`."""
        return self.spoiled(frame, passing, source) if source.random() < self.rate else frame

    def spoiled(self, frame: bytes, passing: Passing, source: Random) -> bytes:
        """The bytes that arrive when the fault has struck."""
        raise NotImplementedError


@dataclass(frozen=True, kw_only=True)
class DropFrames(FrameFault):
    """The frame is lost."""

    def spoiled(self, frame: bytes, passing: Passing, source: Random) -> bytes:
        """Nothing."""
        return b""


@dataclass(frozen=True, kw_only=True)
class DoubleFrames(FrameFault):
    """The frame comes twice."""

    def spoiled(self, frame: bytes, passing: Passing, source: Random) -> bytes:
        """The frame and the frame."""
        return frame + frame


@dataclass(frozen=True, kw_only=True)
class SwapFrames(FrameFault):
    """The frame is overtaken by the next one."""

    def arriving(self, frame: bytes, passing: Passing, source: Random) -> bytes:
        """The frame and then the one that was kept back, or nothing while it is kept back itself."""
        late, passing.kept = passing.kept, b""
        if not late and source.random() < self.rate:
            passing.kept = frame
            return b""
        return frame + late


@dataclass(frozen=True, kw_only=True)
class TruncateFrames(FrameFault):
    """The frame ends early, with its delimiter or without."""

    def spoiled(self, frame: bytes, passing: Passing, source: Random) -> bytes:
        """A part of its beginning, one byte short at least."""
        return frame[: source.randrange(max(1, len(frame) - 1))] + source.choice([b"", DELIMITER])


@dataclass(frozen=True, kw_only=True)
class DropBytes(FrameFault):
    """One byte of the frame is lost."""

    def spoiled(self, frame: bytes, passing: Passing, source: Random) -> bytes:
        """The frame without it."""
        at = source.randrange(len(frame))
        return frame[:at] + frame[at + 1 :]


@dataclass(frozen=True, kw_only=True)
class DoubleBytes(FrameFault):
    """One byte of the frame comes twice."""

    def spoiled(self, frame: bytes, passing: Passing, source: Random) -> bytes:
        """The frame with it."""
        at = source.randrange(len(frame))
        return frame[: at + 1] + frame[at:]


@dataclass(frozen=True, kw_only=True)
class SpoilBytes(FrameFault):
    """`count` bytes of the frame, anywhere in it, become other ones."""

    count: int = 1

    def spoiled(self, frame: bytes, passing: Passing, source: Random) -> bytes:
        """The frame of the same length."""
        damaged = bytearray(frame)
        for _ in range(self.count):
            damaged[source.randrange(len(frame))] ^= source.randrange(1, 256)
        return bytes(damaged)


@dataclass(frozen=True, kw_only=True)
class Babble(FrameFault):
    """Up to `most` bytes that nobody sent come before the frame."""

    most: int = 300

    def spoiled(self, frame: bytes, passing: Passing, source: Random) -> bytes:
        """Random bytes and the frame."""
        return source.randbytes(source.randrange(1, self.most + 1)) + frame


@dataclass(frozen=True, kw_only=True)
class AtByte(FrameFault):
    """The n-th byte of the whole session, counted from 0: `drop`, `spoil`, `double` it, or `cut` the line behind it for good."""

    n: int
    how: str

    def arriving(self, frame: bytes, passing: Passing, source: Random) -> bytes:
        """The frame, in which the byte may lie."""
        at, passing.count = self.n - passing.count, passing.count + len(frame)
        if passing.dead:
            return b""
        if not 0 <= at < len(frame):
            return frame
        passing.dead = self.how == "cut"
        there = frame[at : at + 1]
        put = {"drop": b"", "spoil": bytes([there[0] ^ 0x10]), "double": there + there, "cut": there}[self.how]
        return frame[:at] + put + (b"" if passing.dead else frame[at + 1 :])


@dataclass(frozen=True, kw_only=True)
class Noise(Fault):
    """Each bit on the line, start and stop bits too, begins with probability `bursts_per_bit` a burst of `burst_bits` random bits."""

    direction: Direction
    bursts_per_bit: float
    burst_bits: int = 1


@dataclass(frozen=True, kw_only=True)
class StuckLine(Fault):
    """The line rests at one level."""

    direction: Direction
    low: bool


@dataclass(frozen=True, kw_only=True)
class BaudMismatch(Fault):
    """The host sends and samples at `ratio` times the board's rate."""

    ratio: float


@dataclass(frozen=True, kw_only=True)
class HostPause(Fault):
    """Before a write, with probability `rate`, the host stands still for `duration_s`."""

    duration_s: float
    rate: float = 1.0


@dataclass(frozen=True, kw_only=True)
class HostFifo(Fault):
    """The host's receiver holds `depth` bytes; what comes while it is full and nobody reads is lost."""

    depth: int


@dataclass(frozen=True, kw_only=True)
class BoardReset(Fault):
    """With probability `rate` the board's reset pin is pulled in the middle of a write."""

    rate: float = 1.0
