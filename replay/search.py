"""Which other firmware, run as code, leaves no difference between its answer and the log."""

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from records.errors import BadInput
from records.table import ControllerTable
from replay import thresholds
from replay.build import fused_outputs
from replay.causes.columns import OFFSET, constant_inputs, given_columns, output_lines
from replay.causes.lone import lone_variants
from replay.causes.midair import begins_in_flight
from replay.causes.overflow import angles_that_wrap, output_wraps, sums_that_overflow
from replay.causes.prefilter import fitted_prefilters
from replay.flight import ReplayedLog, readings
from replay.follower import (
    MISREAD,
    OUTPUT_HELD,
    RESET,
    SAMPLE_LOST,
    STALE_ANGLES,
    STALE_REFERENCES,
    UNLOGGED,
    Follower,
    Trace,
)
from replay.law import FLOAT32, ReplayLaw, Setup, channel_agrees
from replay.variants import Variant, variants
from replay.workshop import GRID_SLACK, Workshop

Array = NDArray[np.float64]

LOG_ROUNDING, MISSING_ROWS, FUSED = "log_rounding", "missing_rows", "fused_multiply_add"
REPEATED_ROW = "repeated_row"
IN_FLIGHT = "begins_in_flight"
INCIDENT_SENTENCES = {
    OUTPUT_HELD: "kept its output although its law ran on (a lost output frame)",
    SAMPLE_LOST: "was not run and kept its output (a lost sample)",
    RESET: "was reset in flight",
    STALE_ANGLES: "used the angles of the sample before",
    STALE_REFERENCES: "used the references of the sample before",
    UNLOGGED: "saw a sample that the log does not hold",
    MISREAD: "had another reading than the log holds",
}
MIMICS = (STALE_ANGLES, STALE_REFERENCES, MISREAD)  # many of these may stand for one change of the firmware
OF_THE_LOG = {UNLOGGED, MISREAD}  # incidents that are the log's doing


@dataclass(frozen=True)
class Told:
    """A cause by name, its sentence, its incidents (kind, time in s), and names of causes that the log cannot tell from it.

    `cause` None: nothing but the law of the table is needed.
    """

    cause: str | None
    sentence: str | None
    incidents: tuple[tuple[str, float], ...] = ()
    alternatives: tuple[str, ...] = ()


@dataclass(frozen=True)
class Explanation:
    """Changes of the firmware, and incidents, that together leave nothing unexplained."""

    changes: tuple[Variant, ...]
    trace: Trace

    @property
    def cost(self) -> int:
        """The simpler of two explanations costs less."""
        return len(self.trace.incidents) + thresholds.CHANGE_COST * len(self.changes)

    @property
    def name(self) -> str:
        """Machine names of all changes and kinds of incident, joined by " + "."""
        return " + ".join([*(change.name for change in self.changes), *self.trace.kinds()])

    @property
    def is_plain(self) -> bool:
        """True unless incidents may stand for a change that was not tried."""
        kinds = self.trace.kinds()
        return sum(kinds[kind] for kind in MIMICS) <= thresholds.MANY_INCIDENTS

    @property
    def is_of_the_log(self) -> bool:
        """True where the table's own law explains all, but for readings that the log lacks or holds otherwise."""
        return not self.changes and set(self.trace.kinds()) <= OF_THE_LOG


def explain(
    flight: ReplayedLog,
    table: ControllerTable,
    others: Sequence[ControllerTable] = (),
    as_printed: Told | None = None,
    arithmetic: str = FLOAT32,
) -> Told | None:
    """The simplest firmware that leaves no difference: the table's law with incidents, one change, a fused build, two changes.

    None where none was found. `as_printed` is what is told of a log whose digits do not tell another law from the table's; `arithmetic`
    is that in which the law flew.
    """
    base = Setup(table, arithmetic=arithmetic)
    shops = [Workshop(reading) for reading in readings(flight)]
    for shop in shops:
        found = _exact(shop, base, [()])
        if found and found[0].is_plain:
            return _told(shop.flight, found)
    if as_printed is not None:
        return as_printed
    for shop in shops:
        single = [*variants(table, shop.flight, others), *fitted_prefilters(table, shop.flight, shop.inputs(base))]
        lone = _lone(shop, table)
        found = [*_exact(shop, base, [()]), *_exact(shop, base, ((variant,) for variant in (*single, *lone)))]
        if any(explanation.is_plain or explanation.is_of_the_log for explanation in found):
            return _or_in_flight(_told(shop.flight, found), shop, table)
        if _is_fused(shop, table):
            sentence = "the firmware was built so that products and sums are fused into one rounding"
            return Told(FUSED, sentence)
        found += _exact(shop, base, (*_pairs(single), *_wrapped(shop, base, single)))
        if found:
            return _told(shop.flight, found)
    return _lost_in_gap(shops[0], base) or _too_few_rows(shops[0].flight) or _from_midair(shops[0], table)


def _exact(shop: Workshop, base: Setup, combined: Iterable[tuple[Variant, ...]]) -> list[Explanation]:
    """Those of the combinations that leave nothing unexplained."""
    found: list[Explanation] = []
    last: Variant | None = None
    begun = base
    for changes in combined:
        if changes and changes[0] is not last:  # of pairs, the same comes first many times in a row
            last = changes[0]
            begun = last.change(base)
        setup = begun if changes else base
        for variant in changes[1:]:
            setup = variant.change(setup)
        try:
            trace = Follower(shop, setup, misread=not changes).follow()
        except BadInput:  # no law can be made from such numbers, so none flew
            continue
        if trace.explains:
            found.append(Explanation(changes, trace))
    return found


def _lone(shop: Workshop, table: ControllerTable) -> list[Variant]:
    """Variants that are tried by themselves: those that the log itself shows beside the table's law."""
    flight, inputs = shop.flight, shop.inputs(Setup(table))
    own_V, names = ReplayLaw(Setup(table)).outputs(inputs), flight.input_names
    return [
        *constant_inputs(flight, names),
        *output_wraps(own_V, flight.logged_V, flight),
        *output_lines(own_V, flight.logged_V, names),
        *given_columns(table),
        *sums_that_overflow(table, flight, inputs),
        *angles_that_wrap(table, flight),
        *lone_variants(table),
    ]


def channel_cause(flight: ReplayedLog, table: ControllerTable, own_V: Array, word_V: float) -> Variant | None:
    """What lies between answers (n, loops) of the table's law, computed elsewhere in words of `word_V`, and the log; None: unknown."""
    names, base = flight.input_names, Setup(table)
    single = [
        *variants(table, flight, ()),
        *constant_inputs(flight, names),
        *output_wraps(own_V, flight.logged_V, flight),
    ]
    for variant in (*single, *output_lines(own_V, flight.logged_V, names)):
        channel = variant.change(base).channel
        slack_V = np.nan_to_num(flight.half_step_V) + word_V + GRID_SLACK * np.array(channel.step_V)
        if variant.group == "channel" and channel_agrees(channel, own_V, flight.logged_V, slack_V):
            return variant
    return None


def _wrapped(shop: Workshop, base: Setup, single: Sequence[Variant]) -> Iterator[tuple[Variant, ...]]:
    """Each other law with the range in which its answers would wrap round."""
    for variant in single:
        setup = variant.change(base)
        if variant.group == "channel":
            continue
        try:
            own_V = ReplayLaw(setup).outputs(shop.inputs(setup))
        except BadInput:  # no law can be made from such numbers, so none flew
            continue
        logged_V, _ = shop.answers(setup)
        yield from ((variant, wrap) for wrap in output_wraps(own_V, logged_V, shop.flight))


def _pairs(single: Sequence[Variant]) -> Iterator[tuple[Variant, ...]]:
    return ((one, other) for one, other in combinations(single, 2) if one.group != other.group)


def _is_fused(shop: Workshop, table: ControllerTable) -> bool:
    """True where a build with fused multiply-add gives every logged number."""
    outputs = fused_outputs(table, shop.inputs(Setup(table)))
    if outputs is None:
        return False
    wanted, slack = shop.answers(Setup(table, arithmetic=FLOAT32))
    return bool(np.all(np.isnan(wanted) | (np.abs(outputs - wanted) <= slack)))


def _told(flight: ReplayedLog, found: Sequence[Explanation]) -> Told:
    """The cheapest explanation in words; those of equal cost and another name are its alternatives."""
    best = min(found, key=lambda explanation: explanation.cost)
    repeats = _repeats(flight, best)
    if repeats is not None and repeats < thresholds.BY_CHANCE:
        return _repeated(flight, best)
    equals = dict.fromkeys([REPEATED_ROW] if repeats is not None else [])
    equals |= dict.fromkeys(entry.name for entry in found if entry.cost == best.cost and entry.name != best.name)
    if best.is_of_the_log and best.trace.incidents and not equals:
        return _misread(flight, best) if best.trace.samples(MISREAD) else _not_logged(flight, best)
    clauses = [change.sentence for change in best.changes]
    clauses += [_incident_clause(flight, kind, count, best) for kind, count in best.trace.kinds().items()]
    incidents = tuple((entry.kind, float(flight.t_s[entry.first])) for entry in best.trace.incidents)
    if not clauses:
        return _rounded_only(flight)
    sentence = f"the firmware {'; it '.join(clauses)}"
    if equals:
        sentence += f"; these data cannot tell this from {', '.join(equals)}"
    sentence += _other_ways(best, found)
    if flight.inputs_are_rounded:
        sentence += f"; agreement to the digits of the log only ({_digits(flight)})"
    return Told(best.name, sentence, incidents, tuple(equals))


def _other_ways(best: Explanation, found: Sequence[Explanation]) -> str:
    """What else of the same name explains the log as well."""
    ways = dict.fromkeys(
        "; it ".join(change.sentence for change in entry.changes)
        for entry in found
        if entry.cost == best.cost and entry.name == best.name
    )
    others = list(ways)[1:]
    if not others:
        return ""
    more = f", or one of {len(others) - 1} more of this kind" if len(others) > 1 else ""
    return f"; or it {others[0]}{more}"


def _repeats(flight: ReplayedLog, found: Explanation) -> float | None:
    """The chance of a plant that rested whenever its law was not run, where each such sample is the row before once more; else None."""
    if found.changes or set(found.trace.kinds()) != {SAMPLE_LOST}:
        return None
    lost = [row for entry in found.trace.incidents for row in range(entry.first, entry.first + entry.samples)]
    columns = np.hstack([flight.logged_V, flight.reference_rad, flight.angle_rad])
    if not all(np.array_equal(columns[row], columns[row - 1]) for row in lost):
        return None
    others = np.delete(np.arange(1, len(columns)), [row - 1 for row in lost])
    moving = np.any(flight.angle_rad[others] != flight.angle_rad[others - 1], axis=1)
    return float((1.0 - moving.mean()) ** len(lost)) if moving.size else 1.0


def _repeated(flight: ReplayedLog, found: Explanation) -> Told:
    incidents = found.trace.incidents
    at_s = flight.t_s[incidents[0].first]
    sentence = (
        f"the log repeats rows: {sum(entry.samples for entry in incidents)} are the same as the one before in every column, first at "
        f"{at_s:.6g} s, and without them the replay agrees; a firmware that was not run there would look the same if nothing moved"
    )
    times = tuple((REPEATED_ROW, float(flight.t_s[entry.first])) for entry in incidents)
    return Told(REPEATED_ROW, sentence, times, (SAMPLE_LOST,))


def _misread(flight: ReplayedLog, found: Explanation) -> Told:
    incidents = found.trace.incidents
    times = [float(flight.t_s[entry.first]) for entry in incidents]
    first_s = next(time for time, entry in zip(times, incidents, strict=True) if entry.kind == MISREAD)
    sentence = other_readings(found.trace.samples(MISREAD), first_s, lacks=UNLOGGED in found.trace.kinds())
    return Told(MISREAD, sentence, tuple((entry.kind, time) for time, entry in zip(times, incidents, strict=True)))


def other_readings(rows: int, first_s: float, lacks: bool = False) -> str:
    """What is said of a log that in so many rows holds another reading than the law had, or `lacks` some."""
    where = "a row" if rows == 1 else f"{rows} rows"
    return (
        f"the log holds another reading than the firmware had in {where}{' or lacks one' * lacks}, first at {first_s:.6g} s; with readings "
        "near it there, and everywhere else, the firmware is cleared"
    )


def _not_logged(flight: ReplayedLog, found: Explanation) -> Told:
    incidents = found.trace.incidents
    # Also where the law's answer is the same without.
    lacks: NDArray[np.bool_] = np.asarray(np.isnan(flight.angle_rad).any(axis=1))
    for entry in incidents:
        lacks[entry.first : entry.first + entry.samples] = True
    count = int(lacks.sum())
    what = "a sample" if count == 1 else f"{count} samples"
    sentence = (
        f"the log lacks {what} that the firmware had, first at {flight.t_s[np.argmax(lacks)]:.6g} s; with readings that fit there, "
        "and everywhere else, the firmware is cleared"
    )
    return Told(UNLOGGED, sentence, tuple((UNLOGGED, float(flight.t_s[entry.first])) for entry in incidents))


def _incident_clause(flight: ReplayedLog, kind: str, count: int, found: Explanation) -> str:
    first = next(entry for entry in found.trace.incidents if entry.kind == kind)
    at = f"at {flight.t_s[first.first]:.6g} s"
    times = at if count == 1 else f"{count} times, first {at}"
    samples = sum(entry.samples for entry in found.trace.incidents if entry.kind == kind)
    share = f", {samples} samples in all" if samples > count else ""
    return f"{INCIDENT_SENTENCES[kind]} {times}{share}"


def _rounded_only(flight: ReplayedLog) -> Told:
    if not flight.inputs_are_rounded:
        return Told(None, None)
    sentence = (
        f"the log rounded its inputs ({_digits(flight)}); the replay agrees with all of these digits: print nine digits"
    )
    return Told(LOG_ROUNDING, sentence)


def _digits(flight: ReplayedLog) -> str:
    written = Counter(str(entry) for entry in flight.input_printings)
    return " and ".join(written)


def _lost_in_gap(shop: Workshop, base: Setup) -> Told | None:
    """The law follows the log up to rows that are missing: what it saw there, and so its state behind, is not known."""
    stopped = Follower(shop, base).follow().stopped
    gaps = [(first, behind) for first, behind in shop.flight.missing if behind <= (stopped or 0) <= behind + 2]
    if not gaps:
        return None
    (first, behind), t_s = gaps[0], shop.flight.t_s
    sentence = (
        f"the replay agrees with all rows before {t_s[first]:.6g} s; {behind - first} rows are missing there, "
        "and the law's state behind them cannot be known"
    )
    return Told(MISSING_ROWS, sentence)


def _too_few_rows(flight: ReplayedLog) -> Told | None:
    """The log holds too few of the law's samples: what it saw in the others, and so its state, is not known."""
    if not flight.lacking:
        return None
    n = len(flight.t_s)
    sentence = f"the log holds {n} of {n + flight.lacking} samples; the law's state between them cannot be known"
    return Told(MISSING_ROWS, sentence)


def _or_in_flight(told: Told, shop: Workshop, table: ControllerTable) -> Told:
    """An offset looks like a law's sum that is not at 0: that of a log which begins in flight, and hence not at 0 s."""
    in_flight = _from_midair(shop, table) if told.cause == OFFSET else None
    if in_flight is None:
        return told
    if shop.flight.t_s[0] > 0.0:
        return replace(in_flight, alternatives=(OFFSET,))
    sentence = f"{told.sentence}; a log that begins in flight, its law's sum not at 0, would look the same"
    return replace(told, sentence=sentence, alternatives=(*told.alternatives, IN_FLIGHT))


def _from_midair(shop: Workshop, table: ControllerTable) -> Told | None:
    """The law started before the log did; put into a state that the log tells, it follows to the end."""
    found = begins_in_flight(shop, table)
    if found is None:
        return None
    at_s, bound_V = found
    sentence = (
        f"the log does not begin with the law at rest; from {at_s:.6g} s on, put into the state that the log tells, "
        f"the replay agrees within {bound_V:g} {shop.flight.unit}, which is rounding and no proof of equal bits"
    )
    return Told(IN_FLIGHT, sentence)
