"""Figures of merit of one flight, one axis at a time, as the encoder shows it.

A hold is what lies between two changes of any reference; its step is the change of this axis' reference that began it. `_rad` and `_V`
are the units of a loop's output and input, as in records/loops.py.
"""

from dataclasses import asdict, dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from sim.activity import activity
from sim.tracking import SETTLED_RAD, SETTLED_SHARE, longest, settling_s

Array = NDArray[np.float64]

STEADY_S = 2.0
LEAST_STEP_RAD = np.radians(2.0)
LEAST_STEP_SHARE = 0.1  # likewise of the largest step, for what is no angle


@dataclass(frozen=True)
class Merit:
    """One axis over a flight; times in s, angles in rad, voltages in V.

    `overshoot` is the largest excess beyond a new reference as a share of its step; `settling_s` the longest time from a step until the
    output stays as near to it as sim/tracking.py calls settled, None where it does not before the next change; `steady_error_rad` the
    largest |mean error| of the last two seconds of a hold; `iae_rad_s` the integral of |error|; `largest_error_rad` that of all samples
    later than the longest time to settle asked for, 5 s after the last change; `swing_V` largest minus least voltage after the first hold;
    `travel_V_s` and `reversals_1_s` its activity from then on.
    """

    overshoot: float
    settling_s: float | None
    steady_error_rad: float
    iae_rad_s: float
    largest_error_rad: float
    swing_V: float
    travel_V_s: float
    reversals_1_s: float


CALM_S = 5.0


def merit(t_s: Array, reference_rad: Array, y_rad: Array, u_V: Array, axis: int, is_angle: bool = True) -> Merit:
    """Judge one axis of a flight: t_s (n,), references and outputs (n, loops), inputs (n, loops)."""
    holds = _holds(reference_rad)
    reference, y, u = reference_rad[:, axis], y_rad[:, axis], u_V[:, axis]
    error = reference - y
    period_s = float(t_s[1] - t_s[0])
    before = np.concatenate([[y[0]], reference])
    steps = [(begin, end, float(reference[begin] - before[begin])) for begin, end in holds]
    largest = max((abs(step) for _, _, step in steps), default=0.0)
    least, band = (LEAST_STEP_RAD, SETTLED_RAD) if is_angle else (LEAST_STEP_SHARE * largest, SETTLED_SHARE * largest)
    steps = [entry for entry in steps if abs(entry[2]) >= least > 0.0]
    settling = [settling_s(t_s[begin:end], error[begin:end], band) for begin, end, _ in steps]
    calm = [error[begin + round(CALM_S / period_s) : end] for begin, end in holds]
    late = slice(holds[0][1] if len(holds) > 1 else 0, None)
    busy = activity(t_s[late], u[late])
    return Merit(
        overshoot=max((_overshoot(error[begin:end], step) for begin, end, step in steps), default=0.0),
        settling_s=longest(settling),
        steady_error_rad=max(
            abs(float(np.mean(error[max(begin, end - round(STEADY_S / period_s)) : end]))) for begin, end in holds
        ),
        iae_rad_s=float(np.sum(np.abs(error)) * period_s),
        largest_error_rad=max((float(np.max(np.abs(part))) for part in calm if part.size), default=0.0),
        swing_V=float(np.ptp(u[late])),
        **asdict(busy),
    )


def _holds(reference_rad: Array) -> list[tuple[int, int]]:
    changed = np.flatnonzero(np.any(np.diff(reference_rad, axis=0) != 0.0, axis=1)) + 1
    edges = [0, *changed.tolist(), len(reference_rad)]
    return list(pairwise(edges))


def _overshoot(error_rad: Array, step_rad: float) -> float:
    return float(max(np.max(-np.sign(step_rad) * error_rad), 0.0) / abs(step_rad))
