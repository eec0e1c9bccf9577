"""Single parts of the second rig's simulation, called on their own, and ways to fly it in still air."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from blind.rigs.bench import Bench, Plan
from blind.rigs.second.controller import draw_controller
from blind.rigs.second.lab import SecondLab, SecondStyle
from blind.rigs.second.simulation import PROGRAM, ROUNDED, STEP_S, bearing
from blind.simulation.ce150 import Rig, load_rig
from blind.simulation.flight import Bearing
from blind.simulation.native import opened, set_fields
from blind.simulation.record import Loss, Model, Record
from tests.blind.conftest import PLANT

Settings = Mapping[tuple[str, int], float]
NOMINAL = load_rig(PLANT)[0]
SMOOTH = NOMINAL.with_values({"b_cE": np.zeros(1), "b_cA": np.zeros(1)})
STILL = (0.0, 0.0)
PLAIN = bearing(ROUNDED, 5e-3, 5e-3)


class Part:
    """A rig's state in the compiled simulation, with settings of effects; each method is one part of a step."""

    def __init__(self, settings: Settings, x: list[float] | None = None, t_s: float = 0.0, rig: Rig = NOMINAL) -> None:
        self.ffi, self.lib = opened(PROGRAM)
        self.rig = self.ffi.new("rig_t *", rig.fields())
        self.effects = self.ffi.new("effects_t *")
        set_fields(self.effects, settings)
        self.state = self.ffi.new("state_t *")
        self.state.t_s = t_s
        self.state.x = [*(x or []), *[0.0] * (12 - len(x or []))]
        self.lib.weather(self.effects, self.state)

    def at(self, t_s: float) -> Any:
        """The state with what depends on nothing but the time as it is then."""
        self.state.t_s = t_s
        self.lib.weather(self.effects, self.state)
        return self.state

    def slope(self) -> np.ndarray:
        """Derivative of the state, friction apart, in still air."""
        dx = self.ffi.new("double[12]")
        self.lib.slope(self.rig, self.effects, self.state, self.state.x, self.ffi.new("double[2]"), dx)
        return np.array(list(dx))

    def command(self, *volts: float) -> None:
        """Send a command for both rotors."""
        self.lib.commands_send(self.state, self.ffi.new("double[2]", volts))

    def settle(self, *volts: float) -> None:
        """As if that command had been there for ever."""
        self.lib.commands_settle(self.state, self.ffi.new("double[2]", volts))

    def drive(self, seconds: float) -> np.ndarray:
        """Voltages at the rotors after so long."""
        for _ in range(round(seconds / STEP_S)):
            self.lib.weather(self.effects, self.state)
            self.lib.driver_step(self.rig, self.effects, self.state, STEP_S)
            self.state.t_s += STEP_S
        return np.array(list(self.state.volts))

    def rub(self, friction: Bearing) -> np.ndarray:
        """The state after one step of the bearings alone."""
        held = self.ffi.new("bearing_t *", {name: list(values) for name, values in friction.items()})
        self.lib.bearing_step(self.rig, held, self.effects, self.state, STEP_S)
        return np.array(list(self.state.x))

    def shown(self, angles: np.ndarray, axis: int) -> np.ndarray:
        """What the encoder's shaft shows while the axis goes through `angles`, one per step."""
        self.state.x[2 * axis] = angles[0]
        self.lib.sensor_rest(self.effects, self.state)
        out = []
        for before, now in zip([angles[0], *angles[:-1]], angles, strict=True):
            self.state.x[2 * axis], self.state.x[2 * axis + 1] = now, (now - before) / STEP_S
            self.lib.sensor_step(self.effects, self.state, STEP_S)
            self.state.t_s += STEP_S
            out.append(self.state.read[axis])
        return np.array(out)


def calm_style(manoeuvre: str, reach_rad: tuple[float, float], dither_V: tuple[float, float]) -> SecondStyle:
    return SecondStyle((manoeuvre,) * 4, True, reach_rad, dither_V, STILL, 0.0, 0.0)


def lab_of(
    rig: Rig, seconds: float, style: SecondStyle, *, friction: Bearing = PLAIN, period_s: float = 0.01, seed: int = 0
) -> SecondLab:
    return SecondLab(rig, friction, draw_controller(rig, period_s, np.random.default_rng(seed))[1], style, seconds)


def flown(lab: SecondLab, settings: Settings, *, placed: bool = False, loss: Loss | None = None) -> Record:
    """Fly a rig that is as stated but for the settings; shadow 0 has them, shadow 1 has not."""
    model = Model(lab.nominal, settings)
    inputs = lab.inputs(np.random.default_rng(3), loss or Loss(), 0)
    return lab.fly(model, [model, Model(lab.nominal, {}, placed=placed)], inputs)


def bench_of(draw: Any, seed: int, *, excited: bool = True) -> Bench:
    bench: Bench = draw(NOMINAL, Plan("nominal", (), (), excited, False), np.random.default_rng(seed))
    return bench
