"""A board flown sample by sample beside a person: armed and disarmed between two samples, at the pace of whoever calls.

Here in host-in-the-loop mode, with a simulated rig: the power stage of the board stays off. rig/flight/live_flying.py flies on encoders.
"""

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

from records.logs.live import LiveRow
from rig.emulator.serial_port import EmulatedSerial
from rig.link.client import BoardClient
from rig.link.replies import Health
from sim.runs.stepped import SteppedPlant
from sim.wiring import Wiring

Angles = tuple[float, ...]


class LiveFlight(Protocol):
    """What can be watched and flown: every method raises BadInput when the board refuses or is lost, and is then no longer `armed`."""

    mode: str
    ticks: int
    armed: bool
    round_trip_s: float | None
    law_cycles: int | None

    @property
    def own_pace(self) -> bool:
        """Whether `sample` waits for the board by itself; else the caller keeps the sample period."""
        ...

    def arm(self) -> Angles:
        """Arm; returns the references to begin with, which are where the plant stands."""
        ...

    def disarm(self) -> None:
        """Power stage off at once."""
        ...

    def sample(self, reference: Angles) -> LiveRow | None:
        """`ticks` sample periods towards references, one a loop; None where the board tells nothing while it is disarmed."""
        ...

    def health(self) -> Health:
        """The board's state and counters, and the host's side of the line."""
        ...


@dataclass(frozen=True)
class BoardTime:
    """The time of a board: `passed` lets so many seconds pass on a board whose time stands still between two calls."""

    now_s: Callable[[], float]
    passed: Callable[[float], None]


def time_of(port: Any) -> BoardTime:
    """Virtual time of an emulated board, else the wall clock, which passes by itself."""
    if isinstance(port, EmulatedSerial):
        return BoardTime(lambda: port.time_s, port.wait)
    return BoardTime(time.monotonic, lambda duration_s: None)


class LoopFlight:
    """The board computes, a simulated rig moves: angles go to the board, voltages come back, one frame each a sample.

    A disarmed board leaves the rig without input. `round_trip_s` and `law_cycles` are those of the last armed sample.
    """

    mode = "LOOP"
    ticks = 1
    own_pace = False

    def __init__(
        self, client: BoardClient, plant: SteppedPlant, wires: Wiring, board: BoardTime, period_s: float
    ) -> None:
        self.armed = False
        self.round_trip_s: float | None = None
        self.law_cycles: int | None = None
        self._client, self._plant, self._wires, self._board, self._period_s = client, plant, wires, board, period_s
        self._samples = 0

    def arm(self) -> Angles:
        """Arm and start the law at rest where the simulated rig stands."""
        angles_rad = self._wires.angles(self._plant.measured())
        self._client.arm("LOOP")
        self._client.reset_law(*angles_rad)
        self.armed = True
        return angles_rad

    def disarm(self) -> None:
        """Power stage off; the simulated rig loses its inputs."""
        self.armed = False
        self._client.disarm()

    def sample(self, reference: Angles) -> LiveRow:
        """Measure, ask the board, and move the rig by one period."""
        began_s, t_s = self._board.now_s(), self._samples * self._period_s
        y = self._plant.measured()
        voltages_V = self._answer(reference, self._wires.angles(y)) if self.armed else (0.0,) * len(self._client.loops)
        u = self._wires.command_V(voltages_V)
        self._samples += 1
        self._plant.advance(u, self._samples * self._period_s)
        self._board.passed(max(0.0, self._period_s - (self._board.now_s() - began_s)))
        return LiveRow(t_s, u, y, self._wires.columns(reference))

    def health(self) -> Health:
        """The board's state and counters, and the host's side of the line."""
        return self._client.health()

    def _answer(self, reference: Angles, angles_rad: Angles) -> Angles:
        asked_s = self._board.now_s()
        self.armed = False  # until the answer is there
        answer = self._client.sample(*reference, *angles_rad)
        self.armed = True
        self.round_trip_s, self.law_cycles = self._board.now_s() - asked_s, answer.law_cycles
        return answer.voltages_V
