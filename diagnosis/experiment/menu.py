"""The rig's own menu of further experiments, each as a plan that can be flown in the simulation before anybody goes to the rig."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import sympy
from numpy.typing import NDArray

from diagnosis.experiment.stand_in import steered
from diagnosis.hypothesis.case import Case
from sim.model import Model

Array = NDArray[np.float64]
LEAST_REACH = {"rad": 0.2, "m": 0.02}  # by which a plan moves an axis at least
WIDEST_RAD = 2.0  # of a wide sweep, where the axis has no stops before
STOPS = 0.85  # share of the way to a stop that a plan uses
DITHER = 0.1  # of the inputs' range
DITHER_HZ = (0.3, 0.7, 1.1, 1.7, 2.6, 3.9, 6.0)
PLAN_SEED = 3


@dataclass(frozen=True, eq=False)
class Course:
    """What is flown: references (n, axes) by time t_s (n,) from 0, what is added to the inputs (n, inputs), when the motors are off."""

    t_s: Array
    reference: Array
    dither: Array
    off: NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Plan:
    """One experiment: what it is called, what is to be done, what it costs beside a plain run, from 0 up, and what is flown.

    `locked` axes are held, `weightless` mounts the rig so that gravity turns no axis, `speeds` logs what else it can measure.
    """

    name: str
    instruction: str
    effort: float
    course: Course
    locked: tuple[str, ...] = ()
    weightless: bool = False
    speeds: bool = False


@dataclass(frozen=True)
class Room:
    """How far one axis may go about its middle in these plans, and to where at most in a wide sweep."""

    axis: str
    middle: float
    reach: float
    widest: float
    unit: str


def rooms(case: Case) -> tuple[Room, ...]:
    """The room of every axis that can be steered, from what the logs show and where its stops are."""
    model = case.library.bound.model
    found = []
    for axis in steered(model):
        place = model.places.axes[axis.name]
        column = list(model.outputs).index(place.angle)
        y = np.concatenate([flight.log.y[:, column] for flight in case.flights])
        seen = np.percentile(y[np.isfinite(y)], [5.0, 95.0]) if np.isfinite(y).any() else np.zeros(2)
        low, high = (
            edge * WIDEST_RAD if stop is None else STOPS * case.library.bound.number(stop)
            for edge, stop in ((-1.0, axis.lower), (1.0, axis.upper))
        )
        middle = float(np.clip(seen.mean(), low, high))
        reach = max(float(np.ptp(seen)) / 2.0, LEAST_REACH[place.length_unit])
        reach = min(reach, 0.5 * (high - low))
        middle = float(np.clip(middle, low + reach, high - reach))
        found.append(Room(axis.name, middle, reach, min(0.5 * (high - low), WIDEST_RAD), place.length_unit))
    return tuple(found)


def plans(case: Case, period_s: float) -> Iterator[Plan]:
    """Everything on the menu that this plant allows."""
    room, model = rooms(case), case.library.bound.model
    if not room:
        return
    make = _Maker(case, room, period_s)
    yield make.lively("lively run", "fly every axis in steps, at times that do not coincide", 0.05)
    unseen = [case.library.outputs[place] for place, slot in enumerate(case.slots) if slot < 0]
    told = " and ".join(name.rsplit("_rad_s", 1)[0] for name in unseen if name in case.library.rotor_speeds)
    if told:
        yield make.lively("rotor speeds logged", f"repeat a lively run with {told} in the log", 0.3, speeds=True)
    if len(room) > 1:
        for held in room:
            others = " and ".join(entry.axis for entry in room if entry is not held)
            text = f"lock the {held.axis} at {_shown(held.middle, held.unit)} and fly the {others} in steps"
            yield make.lively(f"{held.axis} locked", text, 0.3, locked=(held.axis,))
    level = next((entry for entry in room if entry.axis == model.places.level), None)
    if level is not None:
        text = f"sweep the {level.axis} slowly over {_shown(2.0 * level.widest, level.unit)}, the others held"
        yield make.sweep(f"wide {level.axis} sweep", text, level)
    if gravity_parameters(model):
        yield make.weightless()
    yield make.coast_down()
    yield make.dithered()
    yield make.ramp()


def gravity_parameters(model: Model) -> tuple[str, ...]:
    """For each axis that gravity turns, the coefficient of its moment that nothing else depends on while all other axes stand.

    () where an axis has none such.
    """
    found = []
    for axis in model.axes:
        place = model.places.axes.get(axis.name)
        if place is None or place.gravity is None or place.gravity_moment is None:
            continue
        still = {other.velocity: 0 for other in model.axes if other is not axis}
        beside = sympy.expand((axis.torque - place.gravity).xreplace(still))
        others = beside.free_symbols | sympy.sympify(axis.inertia).free_symbols
        own = sorted(str(symbol) for symbol in place.gravity_moment.free_symbols - others)
        if not own:
            return ()
        found.append(own[0])
    return tuple(found)


class _Maker:
    """Plans about the middle of the axes' room."""

    def __init__(self, case: Case, room: tuple[Room, ...], period_s: float) -> None:
        self._case, self._room, self._period_s = case, room, period_s
        self._middle = np.array([entry.middle for entry in room])
        self._reach = np.array([entry.reach for entry in room])
        model = case.library.bound.model
        self._span = np.array([np.ptp(case.library.bound.commands(variable)) for variable in model.inputs])

    def lively(self, name: str, text: str, effort: float, locked: tuple[str, ...] = (), speeds: bool = False) -> Plan:
        """Steps of every axis that is free, at times that do not coincide."""
        t_s = self._times(12.0)
        knots, levels = (
            np.array([0.0, 1.0, 1.5, 3.0, 4.0, 5.5, 6.2, 7.7, 8.4, 12.0]),
            (0, 0, 1, 1, -1, -1, 0.4, 0.4, -0.6, -0.6),
        )
        share = np.stack([np.interp(t_s + 0.8 * k, knots, levels) for k in range(len(self._room))], axis=1) * 0.8
        return Plan(name, text, effort, self._course(t_s, share * self._reach), locked=locked, speeds=speeds)

    def sweep(self, name: str, text: str, level: Room) -> Plan:
        """A slow triangle of one axis over all its room."""
        t_s = self._times(16.0)
        wave = np.interp(t_s, [0.0, 4.0, 12.0, 16.0], [0.0, level.widest - 0.05, 0.05 - level.widest, 0.0])
        moved = np.zeros((len(t_s), len(self._room)))
        column = self._room.index(level)
        moved[:, column] = wave - self._middle[column]
        return Plan(name, text, 0.1, self._course(t_s, moved))

    def weightless(self) -> Plan:
        """Pulses on the first axis with gravity out of play, all others locked."""
        heavy = next(
            n for n, place in self._case.library.bound.model.places.axes.items() if place.gravity_moment is not None
        )
        t_s = self._times(6.0)
        pulses = np.where((t_s % 3.0) < 0.6, 2.0 * DITHER, 0.0)[:, None] * self._span
        text = f"mount the rig turned by 90 degrees, so that gravity no longer turns the {heavy}, and send short pulses"
        locked = tuple(entry.axis for entry in self._room if entry.axis != heavy)
        still = np.zeros((len(t_s), len(self._room)))
        return Plan(
            "rig turned by 90 degrees", text, 1.0, self._course(t_s, still, pulses, True), locked, weightless=True
        )

    def coast_down(self) -> Plan:
        """Up to speed, motors off, and once more from the other side."""
        t_s = self._times(12.0)
        wave = np.interp(t_s, [0.0, 2.0, 5.9, 6.0, 8.0, 12.0], [-1.0, 1.0, 1.0, 1.0, -1.0, -1.0])[:, None]
        off = ((t_s > 1.6) & (t_s < 5.0)) | ((t_s > 7.6) & (t_s < 11.0))
        text = "ramp each axis through its middle, switch the motors off at speed, let it come to rest; from both sides"
        return Plan("coast-down", text, 0.1, self._course(t_s, wave * self._reach, off=off))

    def dithered(self) -> Plan:
        """All references still, a multisine on every input."""
        t_s = self._times(10.0)
        rng = np.random.default_rng(PLAN_SEED)
        phases = rng.uniform(0.0, 2.0 * np.pi, (len(DITHER_HZ), len(self._span)))
        waves = np.sin(2.0 * np.pi * np.array(DITHER_HZ)[:, None] * t_s[:, None, None] + phases).sum(axis=1)
        dither = DITHER * self._span * waves / np.abs(waves).max(axis=0)
        text = f"hold still and add a dither of a tenth of the range, {DITHER_HZ[0]} Hz to {DITHER_HZ[-1]} Hz, to every input"
        return Plan("dither", text, 0.1, self._course(t_s, np.zeros((len(t_s), len(self._room))), dither))

    def ramp(self) -> Plan:
        """Slow triangles of every axis, one after the other, without dither."""
        t_s = self._times(16.0)
        wave = np.interp(t_s, [0.0, 4.0, 12.0, 16.0], [0.0, 0.7, -0.7, 0.0])[:, None]
        text = "ramp each reference slowly up and down, without dither"
        return Plan("slow ramp", text, 0.0, self._course(t_s, wave * self._reach))

    def _times(self, length_s: float) -> Array:
        return np.asarray(np.arange(round(length_s / self._period_s)) * self._period_s, dtype=float)

    def _course(
        self, t_s: Array, moved: Array, dither: Array | None = None, off: NDArray[np.bool_] | bool = False
    ) -> Course:
        """References `moved` (n, axes) from the middle."""
        added = np.zeros((len(t_s), len(self._span))) if dither is None else dither
        return Course(t_s, self._middle + moved, added, np.broadcast_to(np.asarray(off, dtype=bool), t_s.shape))


def _shown(value: float, unit: str) -> str:
    return f"{np.degrees(value) + 0.0:.0f} deg".replace("-0 ", "0 ") if unit == "rad" else f"{value:.3g} {unit}"
