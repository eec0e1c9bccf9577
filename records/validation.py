"""What was checked of a board on its serial line, as validation.json states it."""

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass

from records.verification import Equality, equality_table

SCHEMA = "validation/1"


@dataclass(frozen=True)
class LineTiming:
    """Round trips of samples over the line, and the time from a control tick to the end of what the main loop does in it."""

    round_trip_median_s: float
    round_trip_max_s: float
    ticks: int
    tick_latency_min_s: float
    tick_latency_max_s: float

    @property
    def tick_jitter_s(self) -> float:
        """Spread of that time."""
        return self.tick_latency_max_s - self.tick_latency_min_s


@dataclass(frozen=True)
class Validation:
    """A board that answered with the right table: its identity, its self-test, replayed steps, cost, timing and line counters.

    `notes` tell what is slow and no failure.
    """

    port: str
    identity: Mapping[str, object]
    table_digest: str
    self_test_mismatches: int
    equality: Equality
    law_cycles_max: int
    timing: LineTiming
    counters: Mapping[str, int]
    notes: tuple[str, ...] = ()

    @property
    def failures(self) -> tuple[str, ...]:
        """One sentence for each check that did not hold."""
        sentences = []
        if self.self_test_mismatches:
            sentences.append(f"the board's self-test found {self.self_test_mismatches} mismatches")
        return (*sentences, *self.equality.failures)

    @property
    def passed(self) -> bool:
        """True when every check held."""
        return not self.failures


def validation_text(validation: Validation) -> str:
    """The record as JSON text."""
    verdict = {"schema": SCHEMA, "passed": validation.passed, "failures": list(validation.failures)}
    content = {**asdict(validation), "equality": equality_table(validation.equality)}
    content["timing"]["tick_jitter_s"] = validation.timing.tick_jitter_s
    return json.dumps({**verdict, **content}, indent=1) + "\n"
