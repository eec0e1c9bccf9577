"""A serial line that lies, between the client and a board: the port that the client knows, with faults in virtual time.

Bytes, frames and the two ends are disturbed here; noise, stuck levels and wrong speeds bit by bit on the emulated line itself.
"""

from collections import Counter
from collections.abc import Sequence
from random import Random
from typing import Any

from records.protocol import PROTOCOL
from tests.rig.link.disturbance import disturb, stick
from tests.rig.link.hostile_line_faults import (
    DELIMITER,
    BaudMismatch,
    BoardReset,
    Direction,
    Fault,
    FrameFault,
    HostFifo,
    HostPause,
    Noise,
    Passing,
    StuckLine,
)

SHORTEST_S = 1e-9
BAUD_RATE = PROTOCOL.constant("BAUD_RATE")


class Channel:
    """One direction of a line: frames in, what arrives of them out. The same seed and frames give the same bytes."""

    def __init__(self, direction: Direction, faults: Sequence[Fault], seed: int) -> None:
        self._faults = [f for f in faults if isinstance(f, FrameFault) and f.direction is direction]
        self._source = Random(f"{direction.value} {seed}")
        self._passing = Passing()
        self.done: Counter[str] = Counter()
        self.frames = 0

    def carry(self, data: bytes, t_s: float = 0.0) -> bytes:
        """What arrives of `data`, which is sent at `t_s`: each delimiter ends a frame, and so does the end of the data."""
        *ended, rest = data.split(DELIMITER)
        frames = [piece + DELIMITER for piece in ended] + ([rest] if rest else [])
        self.frames += sum(frame != DELIMITER for frame in frames)
        return b"".join(self._arriving(frame, t_s) for frame in frames)

    def heal(self) -> None:
        """No fault acts any more; a frame that was kept back is lost."""
        self._faults = []

    def _arriving(self, frame: bytes, t_s: float) -> bytes:
        for fault in self._faults:
            if frame and fault.active(t_s):
                before, frame = frame, fault.arriving(frame, self._passing, self._source)
                self.done[type(fault).__name__] += frame != before
        return frame


class HostileLine:
    """The port behind it, seen through `faults`. Same calls as pyserial's, plus the virtual time of the board behind it.

    `port` is an open emulated port (any with `time_s`, `wait`, `read`, `write` while no fault is physical or resets the board).
    `done` counts by the fault's name what has struck; the port is only told of times, never of the wall clock.
    """

    def __init__(self, port: Any, faults: Sequence[Fault], seed: int = 1) -> None:
        self.port = port
        self.timeout: float | None = port.timeout
        self.done: Counter[str] = Counter()
        self._seed = seed
        self._source = Random(f"ends {seed}")
        self._to_board = Channel(Direction.TO_BOARD, faults, seed)
        self._to_host = Channel(Direction.TO_HOST, faults, seed)
        self._physical = [f for f in faults if isinstance(f, Noise | StuckLine | BaudMismatch)]
        self._at_host = [f for f in faults if isinstance(f, HostPause | HostFifo | BoardReset)]
        self._acting: list[Fault] = []
        self._partial = b""
        self._arrived = b""

    @property
    def time_s(self) -> float:
        """Virtual time of the board."""
        return float(self.port.time_s)

    @property
    def frames_sent(self) -> int:
        """Frames that the host has written, whatever became of them."""
        return self._to_board.frames

    @property
    def in_waiting(self) -> int:
        """Bytes that a read would give at once."""
        self._receive(self.port.in_waiting, 0.0)
        return len(self._arrived)

    def write(self, data: bytes) -> int:
        """Send; the time that the bytes take on the line passes, and more where the host stands still."""
        for fault in self._at_host:
            if isinstance(fault, HostPause) and self._strikes(fault, fault.rate):
                self.wait(fault.duration_s)
        self._settle()
        self._lose_overruns()
        arriving = self._to_board.carry(bytes(data), self.time_s)
        for fault in self._at_host:
            if isinstance(fault, BoardReset) and self._strikes(fault, fault.rate):
                at = self._source.randrange(len(arriving) + 1)
                self.port.write(arriving[:at])
                self.port.board.reset()
                arriving = arriving[at:]
        self.port.write(arriving)
        return len(data)

    def read(self, size: int = 1) -> bytes:
        """Up to `size` bytes; fewer when the time-out passes on the board's clock."""
        self._lose_overruns()
        end_s = self.time_s + (self.timeout if self.timeout is not None else 3600.0)
        while len(self._arrived) < size and self.time_s < end_s:
            self._settle()
            self._receive(size - len(self._arrived), self._span_s(end_s))
        if len(self._arrived) < size:
            self._pass_partial()
        data, self._arrived = self._arrived[:size], self._arrived[size:]
        return data

    def wait(self, duration_s: float) -> None:
        """Let virtual time pass."""
        end_s = self.time_s + duration_s
        while self.time_s < end_s:
            self._settle()
            self.port.wait(self._span_s(end_s))

    def flush(self) -> None:
        """Every write has passed the line when it returns."""
        self.port.flush()

    def reset_input_buffer(self) -> None:
        """Drop what has been received and not read."""
        self.port.reset_input_buffer()
        self._partial = self._arrived = b""

    def reset_output_buffer(self) -> None:
        """Nothing waits for the line."""
        self.port.reset_output_buffer()

    def close(self) -> None:
        """Close the port behind it."""
        self.port.close()

    def heal(self) -> None:
        """From now on the line is as it should be."""
        self._physical, self._at_host = [], []
        self._to_board.heal()
        self._to_host.heal()
        self._settle()

    def struck(self) -> Counter[str]:
        """How often each fault has struck, by its name."""
        return self.done + self._to_board.done + self._to_host.done

    def _strikes(self, fault: Fault, rate: float) -> bool:
        struck = fault.active(self.time_s) and self._source.random() < rate
        self.done[type(fault).__name__] += struck
        return struck

    def _receive(self, size: int, timeout_s: float) -> None:
        """Read from the port and let every frame that has ended pass on to the host."""
        self.port.timeout = timeout_s
        self._take(self.port.read(size))

    def _take(self, raw: bytes) -> None:
        *ended, self._partial = (self._partial + raw).split(DELIMITER)
        if ended:
            self._arrived += self._to_host.carry(DELIMITER.join(ended) + DELIMITER, self.time_s)

    def _pass_partial(self) -> None:
        self._arrived += self._to_host.carry(self._partial, self.time_s)
        self._partial = b""

    def _lose_overruns(self) -> None:
        """What came while nobody read and the host's receiver was full."""
        for fault in self._at_host:
            if isinstance(fault, HostFifo) and fault.active(self.time_s):
                lost = self.port.board.uart_waiting() - fault.depth
                if lost > 0:
                    self._take(self.port.board.uart_read()[: fault.depth])
                    self.done["HostFifo"] += lost

    def _span_s(self, end_s: float) -> float:
        """From now to `end_s`, or to the next begin or end of a physical fault; never so short that no time would pass."""
        now_s = self.time_s
        edges = [edge for fault in self._physical for edge in (fault.from_s, fault.until_s) if edge > now_s]
        return max(min([end_s, *edges]) - now_s, SHORTEST_S)

    def _settle(self) -> None:
        """Tell the emulated line which physical faults act now."""
        acting: list[Fault] = [fault for fault in self._physical if fault.active(self.time_s)]
        if acting == self._acting:
            return
        self._acting = acting
        for to_host in (False, True):
            disturb(self.port.board, to_host=to_host, bursts_per_bit=0.0, burst_bits=1, seed=self._seed)
        self.port.baudrate = BAUD_RATE
        for fault in acting:
            self._apply(fault)

    def _apply(self, fault: Fault) -> None:
        board = self.port.board
        self.done[type(fault).__name__] += 1
        if isinstance(fault, BaudMismatch):
            self.port.baudrate = round(BAUD_RATE * fault.ratio)
        if isinstance(fault, Noise):
            to_host, rate = fault.direction is Direction.TO_HOST, fault.bursts_per_bit
            disturb(board, to_host=to_host, bursts_per_bit=rate, burst_bits=fault.burst_bits, seed=self._seed)
        if isinstance(fault, StuckLine):
            stick(board, to_host=fault.direction is Direction.TO_HOST, low=fault.low)
