"""Where the real rigs fly, log by log otherwise: rates, loops, held axes, disturbances and errors of the colour that real rigs have,
and what happens to people's logs."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from blind.rigs.bench import FILTERED, Bench, Columns, Logging, Plan
from blind.rigs.real import operators
from blind.rigs.real.manoeuvre import CLOSED, OPEN, drawn
from blind.rigs.real.orders import Asked
from blind.rigs.real.plant import RealPlant, draw_stated, draw_true
from blind.rigs.real.plants import CE150
from blind.rigs.real.simulation import ARC_TANGENT, DAHL, LUGRE, Body, RealInputs, fly, predict
from blind.rigs.real.spectra import Spectrum, called
from blind.simulation.ce150 import DRY_FRICTION, Rig
from blind.simulation.record import Loss, Model, Record

Array = NDArray[np.float64]
SETTLE_S = 2.0
TRIAL_S = 15.0
TRAINING = 2
RUN_LENGTHS_S = (20.0, 60.0)
PERIODS_S = (0.02, 0.01, 0.005, 0.002, 0.001)
HOLD_PERIODS_S = PERIODS_S[:-1]  # of a hold-out, which lasts 20 s at least
MOST_ROWS = 12_000  # of a log: what people send
CONVERTER_STEPS = 2**16  # of a command over its range
# By law: the width of the arc tangent in shares of a usual rate, of the bristles in shares of a usual angle.
WIDTHS = {ARC_TANGENT: (2e-3, 1e-2), DAHL: (3e-4, 4e-3), LUGRE: (3e-4, 4e-3)}
# RMS of a disturbance as a share of what the spectrum's own rig left of its accelerations: from a quiet room to a poor rig.
PUSH_SCALE = (0.002, 0.03)
CORNERS_HZ = (60.0, 300.0)  # of a filter that somebody put on the angles and forgot: at most 2.7 ms late
MISREAD_COUNTS = (0.1, 0.5)  # RMS of each, noise without and with a colour


@dataclass(frozen=True)
class LogStyle:
    """How one log is made: its period and length in s, closed loop or open, axes that are held; its faults: gaps in rows (first, length
    as shares of the log), seconds of the logger's clock in a true one, a drive of sixteen bits."""

    period_s: float
    length_s: float
    closed: bool
    locked: tuple[bool, bool]
    gaps: tuple[tuple[float, float], ...] = ()
    clock: float = 1.0
    coarse: bool = False

    @property
    def rows(self) -> int:
        """Of the log, before any are lost."""
        return round(self.length_s / self.period_s)


@dataclass(frozen=True)
class Errors:
    """By axis the colour of a disturbance and its RMS as a share of a usual acceleration; by output the colour of a reading error and the
    RMS of both reading errors in counts."""

    push: tuple[Spectrum, ...]
    push_share: tuple[float, ...]
    reading: tuple[Spectrum, ...]
    white_counts: tuple[float, ...]
    coloured_counts: tuple[float, ...]


@dataclass(frozen=True, eq=False)
class RealLab:
    """A plant as stated and as it is, its body, its errors, the styles of its logs: training, hold-out, trial."""

    plant: RealPlant
    nominal: Rig
    true: Rig
    body: Body
    errors: Errors
    styles: tuple[LogStyle, ...]
    lively: float
    jitter: bool = field(default=False)

    def inputs(self, rng: Generator, loss: Loss, run: int | None) -> RealInputs:
        """The case's log of that number; the trial for None."""
        style = self.styles[-1 if run is None else run]
        settle = round(SETTLE_S / style.period_s)
        t_s = np.asarray(np.arange(settle + style.rows) * style.period_s, float)
        axes = len(self.plant.axes)
        wishes = np.zeros((len(t_s), 2))
        for i in range(axes):
            wishes[:, i] = self.lively * drawn(CLOSED if style.closed else OPEN, rng, t_s)
        asked = Asked(wishes, t_s, style.locked)
        if style.closed:
            orders = operators.closed(self.plant, self.nominal, asked, rng)
        else:
            orders = operators.opened(self.plant, self.true, asked, rng)
        range_V = [self.plant.range_V(self.nominal, i) for i in range(len(self.plant.inputs))]
        bits = [(high - low) / CONVERTER_STEPS if style.coarse else 1e-12 for low, high in range_V]
        return RealInputs(
            settle=settle,
            period_s=style.period_s,
            closed=style.closed,
            locked=style.locked,
            gain=orders.gain,
            rate_filter_s=orders.rate_filter_s,
            bit_V=(bits[0], bits[-1]),
            reference=orders.reference,
            base_V=orders.base_V,
            push=self._push(rng, len(t_s) + 1, style.period_s),
            misread=self._misread(rng, len(t_s), style.period_s),
            lost=_lost(loss, rng, len(t_s), settle),
            kept=_kept(style),
            clock=style.clock,
            start=orders.start,
        )

    def fly(self, model: Model, shadows: Sequence[Model], inputs: RealInputs) -> Record:
        """From where the operator begins."""
        return fly(self.plant, self.body, model, shadows, inputs)

    def predict(self, rig: Rig, record: Record, step_s: float) -> Array:
        """Free runs of an effect-free rig on this rig's bearings."""
        return predict(self.plant, self.body, rig, record, min(step_s, self.plant.longest_step_s))

    def _push(self, rng: Generator, rows: int, period_s: float) -> Array:
        out, p, errors = np.zeros((rows, 2)), self.plant, self.errors
        for i in range(len(p.axes)):
            size = errors.push_share[i] * p.torque[i] / p.inertia[i]
            out[:, i] = size * errors.push[i].drawn(rng, rows, period_s)
        return out

    def _misread(self, rng: Generator, rows: int, period_s: float) -> Array:
        out, errors = np.zeros((rows, 2)), self.errors
        for i in range(len(self.plant.outputs)):
            counts = errors.white_counts[i] * rng.standard_normal(rows)
            counts += errors.coloured_counts[i] * errors.reading[i].drawn(rng, rows, period_s)
            out[:, i] = counts * self.nominal.resolution_rad[i]
        return out


def draw_bench(plant: RealPlant, given: Rig, plan: Plan, rng: Generator) -> Bench:
    """All of a case but its effects: what its plant file states, the rig itself, its errors, how its logs are made."""
    denied = sorted({effect.hides for effect in plan.effects if effect.hides} | _absent(given, rng))
    known, changes = draw_stated(given, denied, rng)
    true = draw_true(known, rng)
    styles = _draw_styles(plant, rng)
    lively = float(rng.uniform(0.75, 1.0) if plan.excited else rng.uniform(0.4, 0.7))
    lab = RealLab(plant, known, true, _draw_body(plant, rng), _draw_errors(plant, given, rng), styles, lively)
    logging = Logging(
        period_s=styles[0].period_s,
        length_s=styles[0].length_s,
        start_s=float(np.round(rng.uniform(0.5, 900.0), 3)) if rng.random() < 0.4 else 0.0,
        speed_noise_rad_s=float(10.0 ** rng.uniform(-0.5, 0.5)),
        speed_step_rad_s=float(rng.choice([0.01, 0.1, 1.0])),
    )
    columns = Columns(plant.name, plant.rig, plant.inputs, plant.outputs, plant.speeds)
    return Bench(known, true, lab, TRAINING, logging, changes, columns, _faults(lab), each_shows=True)


def _faults(lab: RealLab) -> tuple[str, ...]:
    """What is odd about the logs, in words, with sizes where they matter."""
    logs = lab.styles[:-1]
    drift = max(abs(log.clock - 1.0) for log in logs)
    found = {
        "gaps": any(log.gaps for log in logs),
        f"clock drift {drift:.1e}": drift > 0.0,
        f"{FILTERED} {1e3 * lab.body.filter_s[0]:.2f} ms": lab.body.filter_s[0] > 0.0,
        "16-bit commands": any(log.coarse for log in logs),
        "open loop": not all(log.closed for log in logs),
        "held axis": any(any(log.locked) for log in logs),
    }
    return tuple(name for name, there in found.items() if there)


def _absent(given: Rig, rng: Generator) -> set[str]:
    """Dry friction that neither the plant file nor the rig has, now and then: an absent term alone must tell nothing."""
    return {name for name in DRY_FRICTION if name in given.values and rng.random() < 0.1}


def _draw_styles(plant: RealPlant, rng: Generator) -> tuple[LogStyle, ...]:
    """Of the training logs, the hold-out and a trial; each axis is free in one training log at least, and in the trial."""
    held = _draw_held(plant, rng)
    logs = [_draw_style(plant, PERIODS_S, locked, rng) for locked in held[:-1]]
    hold = _draw_style(plant, HOLD_PERIODS_S, held[-1], rng)
    period_s = float(np.median([style.period_s for style in logs]))
    trial = LogStyle(max(period_s, 0.005), TRIAL_S, logs[0].closed, (False, False))
    return (*logs, hold, trial)


def _draw_held(plant: RealPlant, rng: Generator) -> list[tuple[bool, bool]]:
    """Of a training log's two axes one is held in 40 %, never the same one in both logs; of a hold-out's in 15 %."""
    none = (False, False)
    if len(plant.axes) == 1:
        return [none] * (TRAINING + 1)
    first = int(rng.integers(2))
    choices = [first, 1 - first, int(rng.integers(2))]
    chances = [0.4] * TRAINING + [0.15]
    return [
        (axis == 0, axis == 1) if rng.random() < chance else none for axis, chance in zip(choices, chances, strict=True)
    ]


def _draw_style(plant: RealPlant, periods_s: Sequence[float], locked: tuple[bool, bool], rng: Generator) -> LogStyle:
    period_s = float(rng.choice(periods_s))
    length_s = round(min(float(rng.uniform(*RUN_LENGTHS_S)), MOST_ROWS * period_s), 2)
    closed = bool(rng.random() < operators.CLOSED_SHARE[plant.name])
    if plant is CE150 and not closed and not any(locked):
        length_s = min(length_s, 30.0)  # by hand nobody keeps both axes in their range for longer
    gaps = tuple(
        (float(rng.uniform(0.05, 0.9)), float(rng.uniform(0.05, 0.6) / length_s))
        for _ in range(int(rng.integers(1, 4)) if rng.random() < 0.25 else 0)
    )
    clock = 1.0 + float(rng.choice([-1.0, 1.0]) * 10.0 ** rng.uniform(-5.0, -3.0)) if rng.random() < 0.5 else 1.0
    return LogStyle(period_s, length_s, closed, locked, gaps, clock, bool(rng.random() < 0.5))


def _draw_body(plant: RealPlant, rng: Generator) -> Body:
    law = int(rng.choice(list(WIDTHS)))
    widths, filters = [1.0, 1.0], [0.0, 0.0]
    for i in range(len(plant.axes)):
        usual = plant.rate[i] if law == ARC_TANGENT else plant.reach[i]
        widths[i] = usual * float(10.0 ** rng.uniform(*np.log10(WIDTHS[law])))
    if rng.random() < 0.3:
        time_s = float(1.0 / (2.0 * np.pi * 10.0 ** rng.uniform(*np.log10(CORNERS_HZ))))
        filters = [time_s if i < len(plant.axes) else 0.0 for i in range(2)]  # what a gyro measures is no angle
    return Body(law, (widths[0], widths[1]), (filters[0], filters[1]))


def _draw_errors(plant: RealPlant, given: Rig, rng: Generator) -> Errors:
    """Where white noise is stated its size, doubled, stands for a count: a file states what is found on a usual day."""
    unit = [max(1.0, 2.0 * noise / step) for noise, step in zip(given.noise, given.resolution_rad, strict=True)]
    pushes, colours = called("push", plant.colours.push), plant.colours.reading or ((),) * len(plant.outputs)
    readings = [called("reading", names) for names in colours]
    push = tuple(pushes[rng.integers(len(pushes))] for _ in plant.axes)
    low, high = np.log10(PUSH_SCALE)
    return Errors(
        push=push,
        push_share=tuple(spectrum.share * float(10.0 ** rng.uniform(low, high)) for spectrum in push),
        reading=tuple(of[rng.integers(len(of))] for of in readings),
        white_counts=tuple(one * float(rng.uniform(*MISREAD_COUNTS)) for one in unit),
        coloured_counts=tuple(one * float(rng.uniform(*MISREAD_COUNTS)) for one in unit),
    )


def _kept(style: LogStyle) -> NDArray[np.bool_]:
    kept = np.ones(style.rows, bool)
    for first, share in style.gaps:
        kept[round(first * style.rows) : round((first + share) * style.rows)] = False
    return kept


def _lost(loss: Loss, rng: Generator, rows: int, settle: int) -> NDArray[np.uint8]:
    """Bursts of a drawn length each, so far apart that they make up the share."""
    lost = np.zeros(rows, np.uint8)
    row = settle
    while loss.share > 0.0:
        row += int(rng.geometric(min(1.0, loss.share / loss.burst_frames / (1.0 - loss.share))))
        if row >= rows:
            break
        burst = int(rng.geometric(1.0 / loss.burst_frames))
        lost[row : row + burst] = 1
        row += burst
    return lost
