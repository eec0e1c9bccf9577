"""Where the second rig flies: drawn periods, encoders, friction, controller, air and manoeuvres behind the shared way
to make a case."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray
from scipy.signal import lfilter

from blind.rigs.bench import Bench, Logging, Plan, denied_parameters, needs_reversal
from blind.rigs.second.controller import draw_controller
from blind.rigs.second.manoeuvre import LIVELY, QUIET, dither, reference
from blind.rigs.second.simulation import (
    FASTEST_RAD_S,
    GUST_STEPS,
    PRESLIDING,
    PROGRAM,
    ROUNDED,
    STEP_S,
    STICK_SLIP,
    bearing,
)
from blind.rigs.second.stated import draw_stated, draw_true
from blind.simulation import flight
from blind.simulation.ce150 import Rig, stated_zero
from blind.simulation.flight import Apparatus, Bearing, RunInputs
from blind.simulation.record import Loss, Model, Record
from blind.simulation.rest import start_state

Array = NDArray[np.float64]
SETTLE_S = 3.0
TRIAL_S = 20.0
RUN_LENGTHS_S = (45, 76)  # from, to below
PERIODS_S = (0.005, 0.01, 0.02)
# By law: the width of the rounding in rad/s, of presliding in rad, of the band of rest in rad/s.
WIDTHS = {ROUNDED: (1e-3, 1e-2), PRESLIDING: (2e-4, 4e-3), STICK_SLIP: (5e-4, 3e-3)}


@dataclass(frozen=True)
class SecondStyle:
    """How a case is flown: kinds of manoeuvre by run, reach in rad, dither in V, air, how irregular the rows."""

    manoeuvres: tuple[str, ...]
    lively: bool
    reach_rad: tuple[float, float]
    dither_V: tuple[float, float]
    air: tuple[float, float]
    air_memory_s: float
    jitter_share: float


@dataclass(frozen=True, eq=False)
class SecondLab:
    """A rig as its controller knows it, its bearings, the controller, the way to fly."""

    nominal: Rig
    bearing: Bearing
    control: Any
    style: SecondStyle
    run_s: float

    @property
    def jitter(self) -> bool:
        """Whether the rows come at irregular times."""
        return self.style.jitter_share > 0.0

    def inputs(self, rng: Generator, loss: Loss, run: int | None) -> RunInputs:
        """The case's run of that number, each with another manoeuvre; a trial (`run` None) is shorter and flies any of
        them."""
        style, period_s = self.style, self.control.period_s
        settle = round(SETTLE_S / period_s)
        rows = settle + round((TRIAL_S if run is None else self.run_s) / period_s)
        t_s = np.arange(rows) * period_s
        kind = style.manoeuvres[rng.integers(len(style.manoeuvres)) if run is None else run]
        asked = [reference(kind, rng, t_s, axis, style.lively, style.reach_rad[axis]) for axis in range(2)]
        dithers = [dither(rng, t_s, size) if size else np.zeros(rows) for size in style.dither_V]
        return RunInputs(
            settle=settle,
            step_s=STEP_S,
            steps=_steps(style, rng, rows, settle, period_s),
            reference=np.column_stack(asked),
            dither_V=np.column_stack(dithers),
            gust=_air(style, rng, rows, period_s),
            gust_steps=GUST_STEPS,
            lost=_lost(loss, rng, rows, settle),
        )

    def fly(self, model: Model, shadows: Sequence[Model], inputs: RunInputs) -> Record:
        """From rest at the first reference."""
        psi, phi = inputs.reference[0]
        start = start_state(self.nominal, float(psi), float(phi), FASTEST_RAD_S)
        apparatus = Apparatus(PROGRAM, self.bearing, self.nominal, self.control)
        return flight.fly(apparatus, model, inputs, start, shadows)

    def predict(self, rig: Rig, record: Record, step_s: float) -> Array:
        """Free runs of an effect-free rig on this rig's bearings."""
        return flight.predict(PROGRAM, rig, self.bearing, record, step_s)


def draw_bench(nominal: Rig, plan: Plan, rng: Generator) -> Bench:
    """All of a case but its effects: what its plant file states, the rig itself, controller, manoeuvres, air, how it
    is logged."""
    denied = denied_parameters(plan, rng)
    known, changes = draw_stated(nominal, denied, rng)
    true = draw_true(known, rng)
    period_s = float(rng.choice(PERIODS_S))
    _, control = draw_controller(known, period_s, rng)
    training = int(rng.choice([1, 2, 3], p=[0.2, 0.6, 0.2]))
    style = _draw_style(plan, training + 1, rng)
    lab = SecondLab(known, _draw_bearing(rng), control, style, float(rng.integers(*RUN_LENGTHS_S)))
    logging = Logging(
        period_s=period_s,
        length_s=lab.run_s,
        start_s=float(np.round(rng.uniform(0.5, 400.0), 3)) if rng.random() < 0.3 else 0.0,
        speed_noise_rad_s=float(10.0 ** rng.uniform(-1.0, 0.3)),
        speed_step_rad_s=float(rng.choice([0.001, 0.01, 0.1, 0.25, 0.5, 1.0])),
    )
    return Bench(known, true, lab, training, logging, {**changes, **stated_zero(denied)})


def _draw_style(plan: Plan, runs: int, rng: Generator) -> SecondStyle:
    kinds = LIVELY if plan.excited else QUIET
    lively = 1.0 if plan.excited else 0.6
    style = SecondStyle(
        manoeuvres=tuple(kinds[index] for index in rng.permutation(len(kinds))[:runs]),
        lively=plan.excited,
        reach_rad=(float(rng.uniform(0.22, 0.45) * lively), float(rng.uniform(0.6, 1.3) * lively)),
        dither_V=(float(rng.uniform(0.4, 0.9)), float(rng.uniform(0.8, 2.0))) if plan.excited else (0.0, 0.0),
        air=(float(10.0 ** rng.uniform(-2.523, -1.523)), float(10.0 ** rng.uniform(-2.523, -1.523))),
        air_memory_s=float(10.0 ** rng.uniform(-2.3, -1.0)) if rng.random() < 0.3 else 0.0,
        jitter_share=float(rng.uniform(0.02, 0.08)) if rng.random() < 0.12 else 0.0,
    )
    if needs_reversal(plan):
        style = replace(style, dither_V=(style.dither_V[0], 5.0 if plan.excited else 3.0))
    return style


def _draw_bearing(rng: Generator) -> Bearing:
    law = int(rng.choice(list(WIDTHS)))
    low, high = np.log10(WIDTHS[law])
    first, second = 10.0 ** rng.uniform(low, high, 2)
    return bearing(law, float(first), float(second))


def _steps(style: SecondStyle, rng: Generator, rows: int, settle: int, period_s: float) -> NDArray[np.int32]:
    steps = np.full(rows, round(period_s / STEP_S), np.int32)
    most = round(style.jitter_share * steps[0])
    if most:
        steps[settle:] += rng.integers(-most, most + 1, rows - settle, dtype=np.int32)
    return steps


def _air(style: SecondStyle, rng: Generator, rows: int, period_s: float) -> Array:
    """Accelerations of the given intensity (rad/s^1.5), white down to 1 ms or with a memory, held for 1 ms each."""
    gust_s = GUST_STEPS * STEP_S
    gusts = round(period_s / gust_s)
    white = rng.standard_normal((rows * gusts, 2)) * np.asarray(style.air) / np.sqrt(gust_s)
    keep = np.exp(-gust_s / style.air_memory_s) if style.air_memory_s else 0.0
    return np.ascontiguousarray(lfilter([1.0 - keep], [1.0, -keep], white, axis=0).reshape(rows, gusts, 2))


def _lost(loss: Loss, rng: Generator, rows: int, settle: int) -> NDArray[np.uint8]:
    """A chain of two states, so that frames get lost in bursts; by chance alone where a burst has one frame."""
    stay = max(loss.share, 1.0 - 1.0 / loss.burst_frames)
    begin = loss.share * (1.0 - stay) / (1.0 - loss.share)
    luck = rng.random(rows)
    lost = np.zeros(rows, np.uint8)
    for row in range(settle, rows):
        lost[row] = luck[row] < (stay if lost[row - 1] else begin)
    return lost
