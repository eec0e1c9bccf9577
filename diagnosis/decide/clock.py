"""The log's clock: it may run some per cent fast or slow against the plant, as one does that a processor's own oscillator drives, or a loop
that takes its period and a little more.

All rates of the plant then look lower or higher by one share. What its file knows of them, and what it knows exactly, as a gravity or how
one axis throws the other, tells of that as far as it goes: a rig whose numbers are known to so many per cent tells no clock nearer. It is
told and refuses nothing, as a number that the file takes for exact may be wrong as well.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from diagnosis import decisions
from diagnosis.decide.columns import looked_at, settled_or_none, with_usual_forces
from diagnosis.decide.rows import most_by_an_effect
from diagnosis.fit.gauss_newton import Fit, fit
from diagnosis.fit.nominal import gain_over
from diagnosis.hypothesis.case import Case, FilteredLog
from diagnosis.hypothesis.initial_state import start_of
from records.reasons import Note

RATE_STEP = (
    0.005  # of the rate, between which slopes are taken: five standard deviations of the best that a CE150 tells
)
RATE_FOUND = 0.0005  # of the rate: the search is at its end
MOST_CLOCKS = 6  # that are tried: a bound on the time, which no data set


@dataclass(frozen=True)
class _Clock:
    """A clock that counts `rate` seconds in one, with the plant's fit on it; which rate it promises, and what that gains in nats."""

    rate: float
    end: Fit
    better: float
    promised: float


def clock_in_doubt(case: Case, nominal: Fit) -> tuple[Note, ...]:
    """That the logs' clock may run fast or slow, and by how much: read on another one the plant follows them more than CLOCK_TOLD better,
    and no effect promises as much. `nominal` is the plant's fit to the logs as they are, or to a part."""
    short = looked_at(case)
    plain = settled_or_none(short, nominal.hypothesis)
    if plain is None or not _is_promised(short, plain):
        return ()
    usual = with_usual_forces(short, plain)
    *_, found = _search(short, usual)
    gain = gain_over(short, usual, found.end) - _cost(found.rate)
    off = abs(found.rate - 1.0)
    if off > decisions.CLOCK_MOST or gain < decisions.CLOCK_TOLD or most_by_an_effect(short, usual) > gain:
        return ()
    said = (
        f"perhaps the log's clock runs {100.0 * off:.2g} % {'fast' if found.rate > 1.0 else 'slow'}: with its times divided by "
        f"{found.rate:.4f} the plant follows {gain:.0f} nats better"
    )
    return (Note("clock_doubted", "t_s", {"clock_rate": found.rate, "gain_nats": gain}, said),)


def _is_promised(case: Case, plain: Fit) -> bool:
    """Whether slopes promise so much that a search is worth its time."""
    return _slopes(case, plain, 1.0).promised > decisions.PROMISED_SHARE * decisions.CLOCK_TOLD


def _search(case: Case, usual: Fit) -> Iterator[_Clock]:
    """Clocks, each of the rate that the one before promises, the first that of the logs."""
    clock = _slopes(case, usual, 1.0)
    yield clock
    for _ in range(MOST_CLOCKS):
        end = settled_or_none(on_clock(case, clock.better), clock.end.hypothesis)
        if end is None or abs(clock.better - clock.rate) < RATE_FOUND:
            return
        clock = _slopes(case, end, clock.better)
        yield clock


def _slopes(case: Case, end: Fit, rate: float) -> _Clock:
    """What two clocks beside promise, to first order in all that the plant's fit may then move."""
    here = end.log_posterior + end.promised - _cost(rate)
    up, down = (_promised(case, end, rate + by) for by in (RATE_STEP, -RATE_STEP))
    slope, bend = (up - down) / (2.0 * RATE_STEP), (2.0 * here - up - down) / RATE_STEP**2
    if not np.isfinite(bend) or bend <= 0.0:
        return _Clock(rate, end, rate, 0.0)
    return _Clock(
        rate,
        end,
        rate + float(np.clip(slope / bend, -decisions.CLOCK_MOST, decisions.CLOCK_MOST)),
        slope**2 / (2.0 * bend),
    )


def _promised(case: Case, end: Fit, rate: float) -> float:
    at = fit(on_clock(case, rate), end.hypothesis, rounds=0)
    return -np.inf if at is None else at.log_posterior + at.promised - _cost(rate)


def _cost(rate: float) -> float:
    """What a clock of a rate costs, in nats, by how exact clocks are."""
    return float(0.5 * ((rate - 1.0) / decisions.CLOCK_SD) ** 2)


def on_clock(case: Case, rate: float) -> Case:
    """The case with its times counted by a clock that is `rate` times slower than the logs' own."""
    return case.with_flights([_read(case, flight, rate) for flight in case.flights])


def _read(case: Case, flight: FilteredLog, rate: float) -> FilteredLog:
    own, log = flight.filter_input, flight.log
    filter_input = replace(own, t_s=own.t_s / rate, untold_s=own.untold_s / rate)
    log = replace(log, t_s=log.t_s / rate, sample_period_s=log.sample_period_s / rate)
    x0, p0 = start_of(case.library, filter_input, flight.locked)
    return replace(flight, log=log, filter_input=filter_input, x0=x0, p0=p0)
