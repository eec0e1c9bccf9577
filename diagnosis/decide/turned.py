"""In which rows of the logs alone a column's sign is turned: somebody plugged it in otherwise while the rig was recorded."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from diagnosis import decisions
from diagnosis.decide.column_wiring import ColumnWiring, Stretch, rewired, silenced, turned_signs
from diagnosis.fit.likelihood import likelihood_of
from diagnosis.hypothesis.case import Case, FilteredLog
from diagnosis.hypothesis.hypothesis import Hypothesis, nominal_hypothesis, passes
from diagnosis.validate.prediction import WINDOW_S
from jobs.thread_map import thread_map

Array = NDArray[np.float64]
NOWHERE: Stretch = (0, 0)


def turned_within(case: Case) -> list[ColumnWiring]:
    """Every single slip of a sign in those rows of each log alone in which the plant as stated follows it better so."""
    found = thread_map(lambda sign: _within(case, sign), list(turned_signs(case)))
    return [wiring for wiring in found if wiring is not None]


def _within(case: Case, sign: ColumnWiring) -> ColumnWiring | None:
    """A sign turned in some rows; None where it is better in none, or in all."""
    stated = nominal_hypothesis(case, float(decisions.FIRST_PROCESS_NOISE))
    spans = [_span_of(case.with_flights([flight]), stated, sign) for flight in case.flights]
    counts = [len(flight.log.t_s) for flight in case.flights]
    everywhere = [(0, count) for count in counts]
    if spans in (everywhere, [NOWHERE for _ in counts]):
        return None
    return replace(
        sign,
        rows={flight.number: span for flight, span in zip(case.flights, spans, strict=True)},
        cost=sum(_cost(span, count) for span, count in zip(spans, counts, strict=True)),
    )


def _span_of(alone: Case, stated: Hypothesis, sign: ColumnWiring) -> Stretch:
    """The rows of one log in which a turned sign lets the plant follow it better; none where they begin and end within a second, in which
    nobody plugs in and back, or the plant follows it better yet without the column there: what comes late, or does less than it says, is
    no turned sign."""
    (flight,) = alone.flights
    straight, turned = _by_row(alone, stated), _by_row(rewired(alone, sign), stated)
    if straight is None or turned is None:
        return NOWHERE

    def likelihood(span: Stretch, wiring: ColumnWiring = sign) -> float:
        return likelihood_of(rewired(alone, replace(wiring, rows={flight.number: span})), stated)

    count = len(straight)
    span = _likeliest(turned - straight)
    for end in (0, 1):
        if 0 < span[end] < count:
            span = _moved(span, end, count, likelihood)
    t_s, (since, until) = flight.log.t_s, span
    is_brief = since > 0 and until < count and t_s[until] - t_s[since] < WINDOW_S
    return NOWHERE if is_brief or likelihood(span) <= likelihood(span, silenced(sign)) else span


def _by_row(alone: Case, stated: Hypothesis) -> Array | None:
    """The log likelihood of each row, but for what no reading of the columns changes; None where the filter fails."""
    runs = passes(alone, stated)
    return None if runs is None else -0.5 * np.nansum(runs[0].w ** 2 + np.log(runs[0].s), axis=1)


def _likeliest(gains: Array) -> Stretch:
    """The rows, to the log's end, from its beginning, all, or between, that gain most beyond what the choice costs; none where none do."""
    count, total = len(gains), np.append(0.0, np.cumsum(gains))
    until = int(np.argmax(total - np.minimum.accumulate(total)))
    between = (int(np.argmin(total[: until + 1])), until)
    spans = (NOWHERE, (0, count), (int(np.argmin(total)), count), (0, int(np.argmax(total))), between)
    return max(spans, key=lambda span: total[span[1]] - total[span[0]] - _cost(span, count))


def _cost(span: Stretch, count: int) -> float:
    """What the choice of these rows of `count` costs, in nats: a sign may turn at any of them."""
    return sum(0 < end < count for end in span) * float(np.log(count))


def _moved(span: Stretch, end: int, count: int, likelihood: Callable[[Stretch], float]) -> Stretch:
    """The same with one end where the log is likeliest, by ever smaller steps: a filter led astray needs some rows to come back."""
    best, step = likelihood(span), count // 2
    while step:
        ends = ((span[0] + by, span[1]) if end == 0 else (span[0], span[1] + by) for by in (-step, step))
        there = [(likelihood(other), other) for other in ends if 0 <= other[0] < other[1] <= count]
        if there and max(there)[0] > best:
            best, span = max(there)
        else:
            step //= 2
    return span


def in_words(case: Case, wiring: ColumnWiring, names: Sequence[str]) -> str:
    """In which rows of which of the logs, by their names, a column is read otherwise; nothing where it is so in all."""
    if wiring.rows is None:
        return ""
    return " in " + " and ".join(
        (names[place] if place < len(names) else f"log {place + 1}") + _times(flight, wiring.rows[flight.number])
        for place, flight in enumerate(case.flights)
        if wiring.rows[flight.number] != NOWHERE
    )


def _times(flight: FilteredLog, span: Stretch) -> str:
    (since, until), t_s = span, flight.log.t_s
    if until == len(t_s):
        return f" from {t_s[since]:.6g} s on" if since else ""
    return f" from {t_s[since]:.6g} s to {t_s[until]:.6g} s" if since else f" until {t_s[until]:.6g} s"
