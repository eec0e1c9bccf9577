"""Which other firmware, run as code, leaves no difference between its answer and the log."""

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from diagnosis.firmware_replay_build import fused_outputs
from diagnosis.firmware_replay_events import (
    OUTPUT_HELD,
    RESET,
    SAMPLE_LOST,
    STALE_ANGLES,
    STALE_REFERENCES,
    UNLOGGED,
    Follower,
    Trace,
    Workshop,
)
from diagnosis.firmware_replay_flight import Flight, readings
from diagnosis.firmware_replay_law import FLOAT32, Setup
from diagnosis.firmware_replay_midair import begins_in_flight
from diagnosis.firmware_replay_prefilter import fitted_prefilters
from diagnosis.firmware_replay_variants import Variant, variants
from records.errors import BadInput
from records.table import ControllerTable

LOG_ROUNDING, MISSING_ROWS, FUSED = "log_rounding", "missing_rows", "fused_multiply_add"
IN_FLIGHT = "begins_in_flight"
INCIDENT_SENTENCES = {
    OUTPUT_HELD: "kept its output although its law ran on (a lost output frame)",
    SAMPLE_LOST: "was not run and kept its output (a lost sample)",
    RESET: "was reset in flight",
    STALE_ANGLES: "used the angles of the sample before",
    STALE_REFERENCES: "used the references of the sample before",
    UNLOGGED: "saw a sample that the log does not hold",
}
MIMICS = (STALE_ANGLES, STALE_REFERENCES)  # many of these may stand for one change of the firmware
MANY = 3
CHANGE_COST = 2  # incidents that one change of the firmware outweighs


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
        return len(self.trace.incidents) + CHANGE_COST * len(self.changes)

    @property
    def name(self) -> str:
        """Machine names of all changes and kinds of incident, joined by " + "."""
        return " + ".join([*(change.name for change in self.changes), *self.trace.kinds()])

    @property
    def is_plain(self) -> bool:
        """True unless incidents may stand for a change that was not tried."""
        kinds = self.trace.kinds()
        return sum(kinds[kind] for kind in MIMICS) <= MANY


def explain(flight: Flight, table: ControllerTable, others: Sequence[ControllerTable] = ()) -> Told | None:
    """The simplest firmware that leaves no difference: the table's law with incidents, one change, a fused build, two changes.

    None where none was found.
    """
    base = Setup(table)
    shops = [Workshop(reading) for reading in readings(flight)]
    for shop in shops:
        found = _exact(shop, base, [()])
        if found and found[0].is_plain:
            return _told(shop.flight, found)
    for shop in shops:
        single = [*variants(table, shop.flight, others), *fitted_prefilters(table, shop.flight, shop.inputs(base))]
        found = [*_exact(shop, base, [()]), *_exact(shop, base, ((variant,) for variant in single))]
        if any(explanation.is_plain for explanation in found):
            return _told(shop.flight, found)
        if _is_fused(shop, table):
            sentence = "the firmware was built so that products and sums are fused into one rounding"
            return Told(FUSED, sentence)
        found += _exact(shop, base, _pairs(single))
        if found:
            return _told(shop.flight, found)
    return _lost_in_gap(shops[0], base) or _from_midair(shops[0], table)


def _exact(shop: Workshop, base: Setup, combined: Iterable[tuple[Variant, ...]]) -> list[Explanation]:
    """Those of the combinations that leave nothing unexplained."""
    found = []
    for changes in combined:
        setup = base
        for variant in changes:
            setup = variant.change(setup)
        try:
            trace = Follower(shop, setup).follow()
        except BadInput:  # no law can be made from such numbers, so none flew
            continue
        if trace.explains:
            found.append(Explanation(changes, trace))
    return found


def _pairs(single: Sequence[Variant]) -> Iterator[tuple[Variant, ...]]:
    return ((one, other) for one, other in combinations(single, 2) if one.group != other.group)


def _is_fused(shop: Workshop, table: ControllerTable) -> bool:
    """True where a build with fused multiply-add gives every logged number."""
    outputs = fused_outputs(table, shop.inputs(Setup(table)))
    if outputs is None:
        return False
    wanted, slack = shop.answers(Setup(table, arithmetic=FLOAT32))
    return bool(np.all(np.isnan(wanted) | (np.abs(outputs - wanted) <= slack)))


def _told(flight: Flight, found: Sequence[Explanation]) -> Told:
    """The cheapest explanation in words; those of equal cost and another name are its alternatives."""
    best = min(found, key=lambda explanation: explanation.cost)
    equals = dict.fromkeys(entry.name for entry in found if entry.cost == best.cost and entry.name != best.name)
    clauses = [change.sentence for change in best.changes]
    clauses += [_incident_clause(flight, kind, count, best) for kind, count in best.trace.kinds().items()]
    incidents = tuple((entry.kind, float(flight.t_s[entry.first])) for entry in best.trace.incidents)
    if not clauses:
        return _rounded_only(flight)
    sentence = f"the firmware {'; it '.join(clauses)}"
    if equals:
        sentence += f"; these data cannot tell this from {', '.join(equals)}"
    if flight.inputs_are_rounded:
        sentence += f"; agreement to the digits of the log only ({_digits(flight)})"
    return Told(best.name, sentence, incidents, tuple(equals))


def _incident_clause(flight: Flight, kind: str, count: int, found: Explanation) -> str:
    first = next(entry for entry in found.trace.incidents if entry.kind == kind)
    at = f"at {flight.t_s[first.first]:.6g} s"
    times = at if count == 1 else f"{count} times, first {at}"
    samples = sum(entry.samples for entry in found.trace.incidents if entry.kind == kind)
    share = f", {samples} samples in all" if samples > count else ""
    return f"{INCIDENT_SENTENCES[kind]} {times}{share}"


def _rounded_only(flight: Flight) -> Told:
    if not flight.inputs_are_rounded:
        return Told(None, None)
    sentence = f"the log rounded its inputs ({_digits(flight)}); the replay agrees with all of these digits"
    return Told(LOG_ROUNDING, sentence)


def _digits(flight: Flight) -> str:
    written = Counter(str(entry) for entry in flight.printings[:2])
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


def _from_midair(shop: Workshop, table: ControllerTable) -> Told | None:
    """The law started before the log did; put into a state that the log tells, it follows to the end."""
    found = begins_in_flight(shop, table)
    if found is None:
        return None
    at_s, bound_V = found
    sentence = (
        f"the log does not begin with the law at rest; from {at_s:.6g} s on, put into the state that the log tells, "
        f"the replay agrees within {bound_V:g} V, which is rounding and no proof of equal bits"
    )
    return Told(IN_FLIGHT, sentence)
