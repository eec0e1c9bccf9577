"""The log's clock: it may run some per cent fast or slow against the plant, as one does that a processor's own oscillator drives, or a loop
that takes its period and a little more.

All rates of the plant then look lower or higher by one share. What its file knows of them, and what it knows exactly, as a gravity or how
one axis throws the other, tells of that as far as it goes: a rig whose numbers are known to so many per cent tells no clock nearer. It is
told and refuses nothing, as a number that the file takes for exact may be wrong as well.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from diagnosis import decisions
from diagnosis.decide.columns import settled_or_none, with_usual_forces
from diagnosis.decide.rows import most_by_an_effect
from diagnosis.fit.linear_problem import Fit
from diagnosis.fit.nominal import gain_over
from diagnosis.hypothesis.case import Case, FilteredLog
from diagnosis.hypothesis.initial_state import start_of
from records.reasons import Note

RATE_FOUND = 0.001  # of the rate: a fifth of one standard deviation of the best that a CE150 tells, where the search is at its end
MOST_CLOCKS = 6  # that are tried beside the first two: a bound on the time, which no data set

Clocks = Mapping[float, Fit]  # the plant's fit on each clock that was tried, by the seconds that it counts in one


def clock_in_doubt(case: Case, nominal: Fit) -> tuple[Note, ...]:
    """That the logs' clock may run fast or slow, and by how much: read on another one the plant follows them more than LOGS_DOUBTED better,
    and no effect promises as much beside it. `nominal` is the plant's fit to the logs as they are, or to a part."""
    plain = settled_or_none(case, nominal.hypothesis)
    if plain is None:
        return ()
    usual = with_usual_forces(case, plain)
    rate, end = _likeliest(case, usual)
    off = abs(rate - 1.0)
    gain = gain_over(case, usual, end) - _cost(rate)
    if off > _most() or gain < decisions.LOGS_DOUBTED:
        return ()
    if most_by_an_effect(on_clock(case, rate), end) > gain:
        return ()
    said = (
        f"perhaps the log's clock runs {100.0 * off:.2g} % {'fast' if rate > 1.0 else 'slow'}: with its times divided by "
        f"{rate:.4f} the plant follows {gain:.0f} nats better"
    )
    return (Note("clock_doubted", "t_s", {"clock_rate": rate, "gain_nats": gain}, said),)


def _likeliest(case: Case, usual: Fit) -> tuple[float, Fit]:
    """The clock on which the plant follows the logs best, and its fit there; that of the logs where two clocks beside promise no more.

    Each is fitted with its noise: a clock that is off looks like noise, beside which slopes promise nothing.
    """
    step = float(decisions.CLOCK_SD)
    clocks = {1.0: usual}
    for rate in (1.0 - step, 1.0 + step):
        _try(case, clocks, rate)
    for _ in range(MOST_CLOCKS):
        rate, height = _top(clocks, step)
        if height - _worth(clocks, 1.0) < decisions.PROMISED_SHARE * decisions.LOGS_DOUBTED:
            return 1.0, usual
        near = abs(rate - _best(clocks)) < RATE_FOUND
        beyond = abs(rate - 1.0) > _most() + 1.5 * step  # the first step beyond shows whether the top lies within
        if near or beyond or not _try(case, clocks, rate):
            break
    best = _best(clocks)
    return best, clocks[best]


def _try(case: Case, clocks: dict[float, Fit], rate: float) -> bool:
    """Whether the plant can be fitted on a clock; it begins from the fit on the nearest one."""
    nearest = min(clocks, key=lambda other: abs(other - rate))
    found = settled_or_none(on_clock(case, rate), clocks[nearest].hypothesis)
    if found is not None:
        clocks[rate] = found
    return found is not None


def _worth(clocks: Clocks, rate: float) -> float:
    return clocks[rate].log_posterior - _cost(rate)


def _best(clocks: Clocks) -> float:
    return max(clocks, key=lambda rate: _worth(clocks, rate))


def _top(clocks: Clocks, step: float) -> tuple[float, float]:
    """Where the parabola through the best clock and its neighbours is highest, and how high; a step beyond the last one that was tried
    where that is the best."""
    best = _best(clocks)
    left = max((rate for rate in clocks if rate < best), default=None)
    right = min((rate for rate in clocks if rate > best), default=None)
    if left is None or right is None:
        return best + (step if right is None else -step), _worth(clocks, best)
    rates = (left, best, right)
    bend, slope, here = np.polyfit(np.array(rates) - best, [_worth(clocks, rate) for rate in rates], 2)
    return (best, here) if bend >= 0.0 else (best - 0.5 * slope / bend, here - 0.25 * slope**2 / bend)


def _most() -> float:
    """How far off a clock may be: what gains by more is a rig that is slower or faster than its file says."""
    return decisions.BEYOND_CHANCE * decisions.CLOCK_SD


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
