"""Effects of sensors as the filter takes them: the reading is turned back into what it says of the true output."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from diagnosis.kit import Kit
from diagnosis.tape import Tape, late
from sim.effects.effect import Values

Array = NDArray[np.float64]


def sensed(kit: Kit, tape: Tape, effects: Mapping[str, Values]) -> Tape:
    """The tape under the sensor effects among `effects`.

    A delay puts the reading back to when it was true, a lag likewise by its time constant; steps make it less certain; behind play the
    axis is half the play further the way it last moved, and anywhere within while the reading stands.
    """
    for name, values in effects.items():
        place, kind = name.split(".")
        sensor = kit.bound.model.places.sensors.get(place)
        if sensor is None:
            continue
        output = kit.outputs.index(sensor.output)
        if kind in ("delay", "lag"):
            tape = late(tape, output, values["tau"])
        elif kind == "quantization":
            tape = _coarser(tape, output, values["q"])
        elif kind == "backlash":
            tape = _behind_play(tape, output, values["width"])
    return tape


def _coarser(tape: Tape, output: int, step: float) -> Tape:
    r = tape.r.copy()
    r[:, output] += step**2 / 12.0
    return Tape(tape.t_s, tape.u, tape.y, r, tape.row, tape.rows)


def _behind_play(tape: Tape, output: int, width: float) -> Tape:
    y, r = tape.y.copy(), tape.r.copy()
    seen = np.flatnonzero(np.isfinite(y[:, output]))
    read = y[seen, output]
    moved = np.append(0.0, np.diff(read))
    last = np.maximum.accumulate(np.where(moved != 0.0, np.arange(len(moved)), 0))
    way = np.sign(moved[last])
    standing = np.arange(len(moved)) - last
    y[seen, output] = read + 0.5 * width * way
    # Fast motion changes the reading at every sample; after that long without a change the axis may be anywhere within the play.
    typical = np.median(np.diff(np.flatnonzero(moved != 0.0))) if np.count_nonzero(moved) > 2 else 1.0
    unsure = standing > 2.0 * typical
    r[seen[unsure], output] += width**2 / 6.0
    return Tape(tape.t_s, tape.u, y, r, tape.row, tape.rows)
