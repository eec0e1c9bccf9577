"""Effects of sensors as the filter takes them: the reading is turned back into what it says of the true output."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from diagnosis.filter.filter_input import Tape, late, variance_stated
from diagnosis.library.effect_library import Kit
from diagnosis.library.lattice import grid_evidence
from sim.effect import Values

Array = NDArray[np.float64]
# A reading behind play says that the axis lies within it, no more: as a bell of the same variance an interval costs ln sqrt(12 / 2 pi).
BELL = 0.32
RATE_S = 0.05  # to both sides, over which a reading's rate is taken: long enough for an encoder's steps, short for a helicopter


def sensed(kit: Kit, tape: Tape, effects: Mapping[str, Values]) -> Tape:
    """The tape under the sensor effects among `effects`.

    A delay puts the reading back to when it was true, a lag likewise by its time constant; steps make it less certain; behind play the
    axis is half the play further the way it last moved, and anywhere within it while the reading stands.
    """
    for name, values in effects.items():
        place, kind = name.split(".")
        sensor = kit.bound.model.places.sensors.get(place)
        if sensor is None:
            continue
        output = kit.outputs.index(sensor.output)
        if kind == "delay":
            stated = variance_stated(kit.bound.plant, sensor.output)
            tape = late(unsure_when(tape, output, values["jitter"], stated), output, values["tau"])
        elif kind == "lag":
            tape = late(tape, output, values["tau"])
        elif kind == "quantization":
            tape = _coarser(tape, output, values["q"], kit.bound.plant.sensors[sensor.output])
        elif kind == "backlash":
            tape = behind_play(tape, output, values["width"])
    return tape


def unsure_when(tape: Tape, output: int, jitter_s: float, stated: float) -> Tape:
    """The tape whose readings of an output are true at an instant that is known to `jitter_s` only: r + (dy/dt jitter)^2.

    What the readings showed of noise beyond the variance that is `stated` is no more than that then, as far as its mean goes.
    """
    seen = np.flatnonzero(np.isfinite(tape.read[:, output]))
    if jitter_s <= 0.0 or not len(seen):
        return tape
    r = tape.r.copy()
    further = (rates(tape.t_s[seen], tape.read[seen, output]) * jitter_s) ** 2
    known = min(max(tape.single[output] - stated, 0.0), float(np.mean(further)))
    r[seen, output] += further - tape.standing[seen, output] * known
    return replace(tape, r=r)


def rates(t_s: Array, read: Array) -> Array:
    """How fast readings (n,) at the instants t_s (n,) change, in their unit per second, over RATE_S to both sides; 0 of a single one."""
    before = np.searchsorted(t_s, t_s - RATE_S)
    behind = np.minimum(np.searchsorted(t_s, t_s + RATE_S), len(t_s) - 1)
    passed_s = t_s[behind] - t_s[before]
    return np.divide(read[behind] - read[before], passed_s, out=np.zeros(len(t_s)), where=passed_s > 0.0)


def _coarser(tape: Tape, output: int, grid: float, step: float) -> Tape:
    """The tape where an output lies on a coarser grid: what readings say is read anew, and its evidence is that of the grid."""
    seen = np.flatnonzero(np.isfinite(tape.read[:, output]))
    y, r = tape.y.copy(), tape.r.copy()
    y[:, output] = tape.read[:, output]
    r[seen, output] = tape.standing[seen, output] * tape.single[output]
    evidence = grid_evidence(tape.read[:, output], grid, step)
    plain = replace(tape, y=y, r=r)
    return _less_sure(plain, output, seen, grid, evidence - _once(tape, output, seen) * _charge(tape, output, grid))


def behind_play(tape: Tape, output: int, width: float) -> Tape:
    """The tape where an output's readings follow it behind play of that width."""
    y = tape.y.copy()
    seen = np.flatnonzero(np.isfinite(y[:, output]))
    moved = np.append(0.0, np.diff(tape.read[seen, output]))
    last = np.maximum.accumulate(np.where(moved != 0.0, np.arange(len(moved)), 0))
    unsure = standing_rows(tape, output)
    y[seen, output] += np.where(np.isin(seen, unsure), 0.0, 0.5 * width * np.sign(moved[last]))
    charge = min(BELL, _charge(tape, output, width))
    return _less_sure(replace(tape, y=y), output, unsure, width, -_once(tape, output, unsure) * charge)


def _less_sure(tape: Tape, output: int, rows: NDArray[np.int64], span: float, known: float) -> Tape:
    """The tape where the readings of `rows` may be off by anything within `span`, which is charged with `known` instead of by each row."""
    r = tape.r.copy()
    r[rows, output] += tape.standing[rows, output] * span**2 / 12.0
    counted = _counted(tape, output, rows)
    each = 0.5 * float(np.sum(np.log(r[counted, output] / tape.r[counted, output])))
    return replace(tape, r=r, known=tape.known + each + known)


def _counted(tape: Tape, output: int, rows: NDArray[np.int64]) -> NDArray[np.int64]:
    """Those rows whose readings count in the likelihood."""
    return np.asarray(rows[tape.place[rows, output] >= 0])


def _charge(tape: Tape, output: int, span: float) -> float:
    """What a reading that may be off by anything within `span` costs in likelihood."""
    return 0.5 * float(np.log1p(span**2 / 12.0 / tape.single[output]))


def _once(tape: Tape, output: int, rows: NDArray[np.int64]) -> float:
    """How many readings `rows` hold where the same count, read again and again, is one."""
    return float(np.sum(1.0 / tape.standing[_counted(tape, output, rows), output]))


def standing_rows(tape: Tape, output: int) -> NDArray[np.int64]:
    """Instants at which an axis behind play may be anywhere within it: the reading has not changed for longer than it usually takes, or
    changes back next.
    """
    seen = np.flatnonzero(np.isfinite(tape.y[:, output]))
    moved = np.append(0.0, np.diff(tape.read[seen, output]))
    changes = np.flatnonzero(moved != 0.0)
    if len(changes) < 3:
        return seen
    rows = np.arange(len(moved))
    before = np.clip(np.searchsorted(changes, rows, side="right") - 1, 0, len(changes) - 1)
    after = np.minimum(before + 1, len(changes) - 1)
    standing = rows - changes[before]
    turns = (np.sign(moved[changes[before]]) != np.sign(moved[changes[after]])) & (standing > 0)
    unsure = turns | (standing < 0) | (standing > 2.0 * float(np.median(np.diff(changes))))
    return np.asarray(seen[unsure])
