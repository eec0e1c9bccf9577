"""A log that begins in flight: the law's state at its first row is not known, but at a quiet moment the log itself nearly tells it.

Where references have rested long enough for their filter to settle, and the output was off its limits for four samples,

    x_1 = x_2 = r,   w = 0,   s = v = u - u_ff(r),   and the differences of e and s follow from the last rows.

Known to the rounding of u only, the state cannot give equal bits: agreement is within a stated voltage.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from design.law import polynomial
from diagnosis.firmware_replay_events import Workshop
from diagnosis.firmware_replay_flight import Flight
from diagnosis.firmware_replay_law import ReplayLaw, Setup
from records.table import AxisLaw, ControllerTable

Array = NDArray[np.float64]

SETTLED = 20.0  # time constants of the reference filter: exp(-20) (1 + 20) of a step is left
HISTORY = 4  # samples that the differences of e and s reach back
BOUNDS_V = (1e-6, 1e-5, 1e-4)
LEAST_ROWS = 500


def begins_in_flight(shop: Workshop, table: ControllerTable) -> tuple[float, float] | None:
    """Time from which the table's law, put into the state that the log tells, follows it, and within how many volt; else None."""
    row = _quiet_row(shop.flight, table)
    if row is None:
        return None
    setup = Setup(table)
    law, inputs, n = ReplayLaw(setup), shop.inputs(setup), len(shop.flight.t_s)
    state = _state(law, shop.flight, table, row)
    wanted, slack = shop.answers(setup)
    for bound_V in BOUNDS_V:
        if law.run(law.copied(state), (row, n), inputs, wanted, slack + bound_V) == n:
            return float(shop.flight.t_s[row]), bound_V
    return None


def _quiet_row(flight: Flight, table: ControllerTable) -> int | None:
    """The first row before which both references rested for SETTLED time constants and HISTORY rows are whole and off the limits."""
    n = len(flight.t_s)
    longest_s = max(table.elevation.prefilter_time_constant_s, table.azimuth.prefilter_time_constant_s)
    rest = max(HISTORY, int(np.ceil(SETTLED * longest_s / table.sample_period_s)))
    moved = np.concatenate([[True], np.any(flight.reference_rad[1:] != flight.reference_rad[:-1], axis=1)])
    last_move = np.maximum.accumulate(np.where(moved, np.arange(n), 0))
    low = np.array([table.elevation.u_min_V, table.azimuth.u_min_V])
    high = np.array([table.elevation.u_max_V, table.azimuth.u_max_V])
    with np.errstate(invalid="ignore"):
        free = np.all((flight.logged_V > low) & (flight.logged_V < high) & np.isfinite(flight.angle_rad), axis=1)
    run = np.concatenate([[0], np.cumsum(free)])
    rows = np.arange(HISTORY, max(HISTORY, n - LEAST_ROWS))
    quiet = (run[rows] - run[rows - HISTORY] == HISTORY) & (rows - last_move[rows] >= rest)
    found = rows[quiet]
    return int(found[0]) if found.size else None


def _state(law: ReplayLaw, flight: Flight, table: ControllerTable, row: int) -> Any:
    """The state before `row`."""
    state = law.start(flight.angle_rad[row - 1])
    for index, axis in enumerate((table.elevation, table.azimuth)):
        reference_rad = _held(axis, flight.reference_rad[row - 1, index])
        ahead_rad = _held(table.elevation, flight.reference_rad[row - 1, 0])
        e_rad = reference_rad - flight.angle_rad[row - HISTORY : row, index]
        s_V = flight.logged_V[row - HISTORY : row, index] - polynomial(axis.feedforward_V, ahead_rad)
        own = state.axis[index]
        own.reference_1_rad = own.reference_2_rad = reference_rad
        own.e_0_rad, own.e_1_rad, own.e_2_rad = _differences(e_rad)
        own.v_V = float(s_V[-1])
        for power, value in enumerate(_differences(s_V)):
            own.s_V[power] = value
        state.reference_rad[index] = float(flight.reference_rad[row - 1, index])
    return state


def _held(axis: AxisLaw, reference_rad: float) -> float:
    return float(np.clip(reference_rad, axis.reference_min_rad, axis.reference_max_rad))


def _differences(values: Array) -> tuple[float, float, float]:
    """The last value, its first and its second backward difference."""
    return float(values[-1]), float(values[-1] - values[-2]), float(values[-1] - 2.0 * values[-2] + values[-3])
