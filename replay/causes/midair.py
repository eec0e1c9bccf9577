"""A log that begins in flight: the law's state at its first row is not known, but after a while the log itself nearly tells it.

The reference filters and the errors forget how they began: run over the log's own references and angles for long enough, they are those
that flew. Where the output was then off its limits for four samples, the feedback follows from what was sent,

    w = 0,   s = v = u - u_ff(x_2),   and the differences of s from the last rows.

Known to the rounding of u only, the state cannot give equal bits: agreement is within a stated voltage.
"""

import math
from collections.abc import Iterator
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from design.law import polynomial
from records.table import ControllerTable
from replay import thresholds
from replay.flight import ReplayedLog
from replay.law import ReplayLaw, Setup
from replay.workshop import Workshop

Array = NDArray[np.float64]


def begins_in_flight(shop: Workshop, table: ControllerTable) -> tuple[float, float] | None:
    """Time from which the table's law, put into the state that the log tells, follows it, and within how many volt; else None.

    A law that agrees in its first sample began with the log; one that never is off by more than the bound did as well. Of a long log the
    state is told anew now and then, as a law that integrates forgets no error of it; so it is behind each row that lacks a reading. Where
    the law rests, later rows may tell it better.
    """
    rows, setup = _telling_rows(shop.flight, table), Setup(table)
    at_rest_V = ReplayLaw(setup).outputs(shop.inputs(setup))
    off_V = np.abs(at_rest_V - shop.flight.logged_V).max(axis=1)
    last = len(off_V) - thresholds.LEAST_ROWS
    if not rows.size or not off_V[0] > shop.flight.half_step_V[0].max():
        return None
    for later in range(thresholds.FIRST_TRIED):
        left = rows[rows >= rows[0] + later * thresholds.TRIED_LATER]
        whole = left.size and left[0] < last
        bound_V = _followed_within(shop, table, left, float(np.nanmax(off_V))) if whole else None
        if bound_V is not None:
            return float(shop.flight.t_s[left[0]]), bound_V
    return None


def _way_V(logged_V: NDArray[np.float64]) -> NDArray[np.float64]:
    """How far each of the inputs (rows, inputs) goes."""
    return np.asarray(np.nanmax(logged_V, axis=0) - np.nanmin(logged_V, axis=0))


def _followed_within(shop: Workshop, table: ControllerTable, rows: NDArray[np.int64], off_V: float) -> float | None:
    """Within how many volt the law follows the log from the first of the `rows` that tell its state; None where by no bound that a law
    from rest, which is off by `off_V`, clearly misses, nor where an input that moved rests from there on, as laws are alike then."""
    setup = Setup(table)
    law, inputs = ReplayLaw(setup), shop.inputs(setup)
    unread = np.any(np.isnan(shop.flight.angle_rad), axis=1)
    spans = list(_spans(rows, unread))
    if sum(behind - row for row, behind in spans) < thresholds.LEAST_ROWS:
        return None
    states = [_state(law, inputs, shop.flight, table, row) for row, _ in spans]
    wanted, slack = shop.answers(setup)
    whole_V, behind_V = (_way_V(shop.flight.logged_V[first:]) for first in (0, rows[0]))
    for bound_V in thresholds.BOUNDS_V:
        clear_V = thresholds.CLEARLY_OFF * bound_V
        shows = off_V > clear_V and bool(np.all((behind_V > clear_V) | (whole_V <= clear_V)))
        if shows and all(
            law.run(law.copied(state), (row, behind), inputs, wanted, slack + bound_V) == behind
            for state, (row, behind) in zip(states, spans, strict=True)
        ):
            return bound_V
    return None


def _spans(rows: NDArray[np.int64], unread: NDArray[np.bool_]) -> Iterator[tuple[int, int]]:
    """From which row to which the law is followed, from one of the `rows` that tell its state each time: none holds a row that lacks a
    reading, of all n `unread`."""
    n = len(unread)
    while rows.size:
        end = min(int(np.argmax(unread[rows[0] :])) + int(rows[0]), n) if unread[rows[0] :].any() else n
        within = rows[(rows < end) & (rows < n - thresholds.LEAST_ROWS)]
        starts = _anew(within) if within.size else [int(rows[0])]
        yield from ((row, min(behind + thresholds.HISTORY + 1, end)) for row, behind in pairwise([*starts, end]))
        rows = rows[rows > end]


def _anew(rows: NDArray[np.int64]) -> list[int]:
    """The first of the rows that tell the state, and each first that is TOLD_ANEW rows and more behind the last of these."""
    found = [int(rows[0])]
    while (later := rows[rows >= found[-1] + thresholds.TOLD_ANEW]).size:
        found.append(int(later[0]))
    return found


def _telling_rows(flight: ReplayedLog, table: ControllerTable) -> NDArray[np.int64]:
    """The rows before which references were known for SETTLED_CONSTANTS time constants, and HISTORY rows are whole and off the limits."""
    n = len(flight.t_s)
    longest_s = max(axis.prefilter_time_constant_s for axis in table.axes)
    settling = max(thresholds.HISTORY, int(np.ceil(thresholds.SETTLED_CONSTANTS * longest_s / table.sample_period_s)))
    known = np.all(np.isfinite(flight.reference_rad), axis=1)
    low = np.array([axis.u_min_V for axis in table.axes])
    high = np.array([axis.u_max_V for axis in table.axes])
    with np.errstate(invalid="ignore"):
        free = known & np.all((flight.logged_V > low) & (flight.logged_V < high), axis=1)
    free &= np.all(np.isfinite(flight.angle_rad), axis=1)
    rows = np.arange(settling, max(settling, n))
    return rows[(_run_before(known, settling)[rows]) & (_run_before(free, thresholds.HISTORY)[rows])]


def _run_before(marked: NDArray[np.bool_], count: int) -> NDArray[np.bool_]:
    """Row k holds whether the `count` rows before it are all marked; there is one row more than in `marked`."""
    total = np.concatenate([[0], np.cumsum(marked)])
    result = np.zeros(len(total), bool)
    result[count:] = total[count:] - total[:-count] == count
    return result


def _state(law: ReplayLaw, inputs: NDArray[Any], flight: ReplayedLog, table: ControllerTable, row: int) -> Any:
    """The state before `row`. The last difference of s is that of the law's own run, which is finer, unless it was misled on its way."""
    first, ahead_rad = row - thresholds.HISTORY, []
    misled = not np.isfinite(flight.angle_rad[:row]).all()
    state = law.start(inputs[0, law.loops :])
    law.run(state, (0, first), inputs, None, None)
    for last in range(first, row):
        law.run(state, (last, last + 1), inputs, None, None)
        ahead_rad.append(state.axis[law.scheduling].reference_2_rad)
    for index, axis in enumerate(table.axes):
        s_V = flight.logged_V[first:row, index] - [polynomial(axis.feedforward_V, angle) for angle in ahead_rad]
        own = state.axis[index]
        own.v_V = float(s_V[-1])
        for power, value in enumerate(_differences(s_V, min(law.order + misled, thresholds.HISTORY))):
            own.s_V[power] = value
            if power < law.order:
                own.w_V[power] = 0.0
    return state


def _differences(values: Array, count: int) -> list[float]:
    """The last value, its first backward difference, and so on, `count` in all."""
    return [
        float(sum((-1.0) ** back * math.comb(power, back) * values[-1 - back] for back in range(power + 1)))
        for power in range(count)
    ]
