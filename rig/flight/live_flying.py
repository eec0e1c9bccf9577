"""A board that flies on its own sensors, watched sample by sample: references go to it, telemetry comes back. The rotors turn."""

from typing import Protocol

from records.errors import BadInput
from records.logs.live import LiveRow
from records.loops import LOOPS, Loop, Pins
from records.protocol import PROTOCOL
from rig.emulator.board import EmulatedBoard
from rig.emulator.serial_port import EmulatedSerial
from rig.flight.live import Angles, BoardTime
from rig.link.client import BoardClient
from rig.link.replies import Health, Telemetry, state_name
from sim.runs.stepped import SteppedPlant
from sim.wiring import Wiring

OLD_FRAMES = 1000  # telemetry from before an ARM, at most


class Rig(Protocol):
    """What hangs on the board's pins."""

    real: bool

    def move(self, period_s: float) -> None:
        """Let one sample period act."""
        ...


class RealRig:
    """A rig that moves by itself."""

    real = True

    def move(self, period_s: float) -> None:
        """Nothing to do."""


class EmulatedRig:
    """A simulated plant on the pins of an emulated board: the PWM drives it, it turns encoders and analogue sensors."""

    real = False

    def __init__(
        self,
        port: EmulatedSerial,
        plant: SteppedPlant,
        wires: Wiring,
        resolution_rad: Angles,
        loops: tuple[Loop, ...] = LOOPS,
    ) -> None:
        self._port, self._plant, self._wires, self._resolution_rad = port, plant, wires, resolution_rad
        self._pins = tuple(loop.pins for loop in loops if loop.pins is not None)
        self._origin = self._counts()
        self._turn_sensors()  # an analogue one knows its place before anything moves

    def move(self, period_s: float) -> None:
        """Advance the plant with the voltages that the pins give now."""
        voltages_V = [self._voltage(pins) for pins in self._pins]
        self._plant.advance(self._wires.command_V(voltages_V), self._plant.t_s + period_s)
        self._turn_sensors()

    def _turn_sensors(self) -> None:
        chip = self._board.config.chip
        for pins, now, first in zip(self._pins, self._counts(), self._origin, strict=True):
            encoder, channel = chip.encoder_of(pins), chip.channel_of(pins)
            if encoder is not None:
                self._board.set_encoder(encoder.timer, now - first)
            if channel is not None and pins.analogue is not None:
                self._board.set_analogue(channel.number, pins.analogue.code(now))

    @property
    def _board(self) -> EmulatedBoard:
        assert self._port.board is not None
        return self._port.board

    def _counts(self) -> list[int]:
        angles_rad = self._wires.angles(self._plant.measured())
        return [round(angle / step) for angle, step in zip(angles_rad, self._resolution_rad, strict=True)]

    def _voltage(self, pins: Pins) -> float:
        """What the driver on these pins gives [V]."""
        pwm, motor = self._board.pwm(), self._board.config.chip.motor_of(pins)
        assert motor is not None
        if not pwm.enabled:
            return 0.0
        turned = pins.direction is not None and self._board.gpio(motor.direction.port).drives(motor.direction.number)
        ticks = (pwm.main_ticks, pwm.tail_ticks)[motor.channel - 1]
        return (-ticks if turned else ticks) * pins.full_scale_V / pwm.period_ticks


def ticks_of_telemetry(period_s: float) -> int:
    """Sample periods from one telemetry to the next: one, or more where the line could not carry so many frames."""
    return max(1, -(-PROTOCOL.constant("TELEMETRY_LEAST_US") // round(1e6 * period_s)))


class FlyingFlight:
    """Flying on the board's own sensors. Time is the board's tick since the first telemetry; a disarmed board tells nothing."""

    mode = "FLYING"

    def __init__(self, client: BoardClient, rig: Rig, wires: Wiring, board: BoardTime, period_s: float) -> None:
        self.ticks = ticks_of_telemetry(period_s)
        self.armed = False
        self.round_trip_s: float | None = None
        self.law_cycles: int | None = None
        self._client, self._rig, self._wires, self._board, self._period_s = client, rig, wires, board, period_s
        self._first_tick: int | None = None

    @property
    def own_pace(self) -> bool:
        """A real board's telemetry is the clock."""
        return self.armed and self._rig.real

    def preset(self, *counts: int) -> None:
        """Declare where the plant stands."""
        self._client.preset(*counts)

    def arm(self) -> Angles:
        """Arm; the board holds the place where it stands, which its first telemetry names."""
        self._client.arm("FLYING")
        for _ in range(OLD_FRAMES):
            told = self._next()
            if state_name(told.state) == "FLYING":
                self.armed = True
                return told.angles_rad
        raise self._silent("telemetry of an earlier flight alone")

    def disarm(self) -> None:
        """Power stage off at once."""
        self.armed = False
        self._client.disarm()

    def sample(self, reference: Angles) -> LiveRow | None:
        """Send the references and take the next telemetry."""
        for _ in range(self.ticks - 1):
            self._rig.move(self._period_s)
            self._board.passed(self._period_s)
        self._rig.move(self._period_s)
        if not self.armed:
            self._board.passed(self._period_s)
            return None
        self.armed = False  # until the telemetry is there
        self._client.reference(*reference)
        told = self._next()
        self.armed = state_name(told.state) == "FLYING"
        self.law_cycles = told.law_cycles
        return self._row(told)

    def health(self) -> Health:
        """The board's state and counters, and the host's side of the line."""
        return self._client.health()

    def _row(self, told: Telemetry) -> LiveRow:
        if self._first_tick is None:
            self._first_tick = told.tick
        t_s = (told.tick - self._first_tick) * self._period_s
        columns = self._wires.columns
        u = self._wires.command_V(told.voltages_V)
        return LiveRow(t_s, u, columns(told.angles_rad), columns(told.references_rad))

    def _next(self) -> Telemetry:
        told = self._client.telemetry()
        if told is None:
            raise self._silent("silence")
        return told

    def _silent(self, got: str) -> BadInput:
        remedy = "check the cable and the board's supply, then arm again"
        return BadInput("telemetry", "flying board", got, "a frame each sample period", remedy)
