"""What was checked of one controller table: everything, as verification.json states it; of a board on its line, as validation.json does."""

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

from records.text.units import said

VERIFICATION_SCHEMA = "verification/1"
VALIDATION_SCHEMA = "validation/1"


@dataclass(frozen=True)
class FirstMismatch:
    """Where two executions part: stimulus, step and lane, the signal that differs first, and all words in hexadecimal.

    `signal` is an output or a word of the state. `step` is None when all outputs agreed but a state at rest, or at the end, did not.
    `inputs` are the references, then the angles, of all loops; `words` what the first and what the second execution gave.
    """

    stimulus: str
    step: int | None
    lane: int
    signal: str
    inputs: tuple[str, ...]
    words: tuple[str, str]

    def __str__(self) -> str:
        place = "at rest or at the end" if self.step is None else f"at step {self.step}"
        given = " ".join(self.inputs)
        return f"{self.stimulus}, lane {self.lane}, {place}: {self.signal} is {' against '.join(self.words)} on {given}"


@dataclass(frozen=True)
class Equality:
    """Two executions of the same law stepped side by side: how many steps, and in how many their bits differed (NaN equals NaN)."""

    between: tuple[str, str]
    arithmetic: str
    steps: int
    mismatches: int
    first_mismatch: FirstMismatch | None = None

    @property
    def failures(self) -> tuple[str, ...]:
        """The sentence that says how they differ and where first; empty when they do not."""
        if not self.mismatches:
            return ()
        one, other = self.between
        where = f", first in {self.first_mismatch}" if self.first_mismatch else ""
        return (f"{one} and {other} differ in {self.mismatches} of {self.steps} steps ({self.arithmetic}){where}",)


def equality_table(equality: Equality) -> dict[str, Any]:
    """The comparison as a JSON object; `first_mismatch` is there only where there is one."""
    content = asdict(equality)
    if equality.first_mismatch is None:
        del content["first_mismatch"]
    return content


@dataclass(frozen=True)
class RoundingBound:
    """A proved bound on what one step can differ from real arithmetic, per output (u_M), and how it was proved.

    The bounds are in V but where `units` names another.
    """

    volts: Mapping[str, float]
    method: str
    units: Mapping[str, str] = field(default_factory=dict)

    @property
    def told(self) -> str:
        """The bounds in words."""
        return ", ".join(f"{name} within {self.size(name)}" for name in self.volts)

    def column(self, name: str) -> str:
        """An output's column: u_M_V, u_A; one that states no unit is the name alone."""
        unit = self.units.get(name, "V")
        return name if unit == "1" else f"{name}_{unit.replace(' ', '').replace('/', '_').replace('^', '')}"

    def size(self, name: str) -> str:
        """The bound of one output in words."""
        bound = self.volts[name]
        return f"{bound:.2g} {self.units[name]}".removesuffix(" 1") if name in self.units else f"{1e3 * bound:.2f} mV"

    @property
    def entries(self) -> dict[str, Any]:
        """What verification.json states."""
        return {**self.volts, "method": self.method, **({"units": dict(self.units)} if self.units else {})}


@dataclass(frozen=True)
class PoleMigration:
    """The slowest closed-loop pole of one axis as designed, and the worst one between grid points after fit and rounding.

    `scheduled_by` is the column that the law goes by, None of a law without a schedule.
    """

    axis: str
    designed_slowest_rad_s: float
    worst_slowest_rad_s: float
    at_psi_rad: float
    stable: bool
    scheduled_by: str | None = None

    @property
    def at(self) -> str:
        """Where on the schedule the worst one is, in words; empty of a law without one."""
        return "" if self.scheduled_by is None else said(self.scheduled_by, self.at_psi_rad)

    @property
    def entry(self) -> dict[str, Any]:
        """What verification.json states."""
        content = asdict(self)
        return at_own_schedule(content, content.pop("scheduled_by"))


def at_own_schedule(entry: Mapping[str, Any], column: str | None) -> dict[str, Any]:
    """An entry whose at_psi_rad is called by the law's own schedule, at_theta_rad; without a schedule it has none."""
    return {
        key if key != "at_psi_rad" else f"at_{column}": value
        for key, value in entry.items()
        if key != "at_psi_rad" or column is not None
    }


@dataclass(frozen=True)
class TargetCost:
    """What one control step costs on the target: least and most cycles measured, their bound, worst stack, and the image's memory.

    `cycles_budget` is what a sample period leaves for the step.
    """

    arithmetic: str
    cycles_min: int
    cycles_max: int
    cycles_bound: int
    stack_bytes: int
    flash_bytes: int
    ram_bytes: int
    cycles_budget: int

    @property
    def fits(self) -> bool:
        """Whether no step can be measured above its bound, nor last longer than a sample period allows."""
        return self.cycles_max <= self.cycles_bound <= self.cycles_budget


@dataclass(frozen=True)
class SelfTest:
    """The self-test that is emitted with the law, run at `place` ("host" or "target"): mismatches against the twin's recorded steps."""

    place: str
    arithmetic: str
    mismatches: int


@dataclass(frozen=True)
class ProofResult:
    """What became of one proof: "proved", "failed" or "skipped", with its figure (or the reason) in words.

    `detail` lists what a reader may want to see one by one (findings, survivors); `figures` are the same as numbers, for a program.
    """

    name: str
    outcome: str
    figure: str
    detail: tuple[str, ...] = ()
    figures: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Verification:
    """All checks of one table; `rounding` is the bound of the arithmetic that was asked for, `roundings` has that of each."""

    table_digest: str
    equality: tuple[Equality, ...]
    self_tests: tuple[SelfTest, ...]
    rounding: RoundingBound
    poles: tuple[PoleMigration, ...]
    target: tuple[TargetCost, ...]
    roundings: Mapping[str, RoundingBound] = field(default_factory=dict)
    proofs: tuple[ProofResult, ...] = ()

    @property
    def failures(self) -> tuple[str, ...]:
        """One sentence for each check that did not hold; empty when all did."""
        unequal = (sentence for row in self.equality for sentence in row.failures)
        self_tests = (
            f"the self-test on the {row.place} found {row.mismatches} mismatches ({row.arithmetic})"
            for row in self.self_tests
            if row.mismatches
        )
        unstable = (
            f"the {row.axis} loop is unstable{f' at {row.at}' if row.at else ''}"
            for row in self.poles
            if not row.stable
        )
        slow = (
            f"{row.cycles_max} cycles were measured above the bound of {row.cycles_bound} ({row.arithmetic})"
            for row in self.target
            if row.cycles_max > row.cycles_bound
        )
        late = (
            f"a step may take {row.cycles_bound} cycles of the {row.cycles_budget} that the sample period leaves ({row.arithmetic})"
            for row in self.target
            if row.cycles_bound > row.cycles_budget
        )
        unproved = (f"{row.name}: {row.figure}" for row in self.proofs if row.outcome == "failed")
        return (*unequal, *self_tests, *unstable, *slow, *late, *unproved)

    @property
    def passed(self) -> bool:
        """True when every check held."""
        return not self.failures


def verification_text(verification: Verification) -> str:
    """The record as JSON text in the form of CONTRACT.md."""
    content = asdict(verification)
    ordered: Mapping[str, object] = {
        "schema": VERIFICATION_SCHEMA,
        "table_digest": verification.table_digest,
        "passed": verification.passed,
        "failures": list(verification.failures),
        "equality": [equality_table(row) for row in verification.equality],
        "self_test": content["self_tests"],
        "rounding_bound_V": verification.rounding.entries,
        "rounding_bounds_V": {name: bound.entries for name, bound in verification.roundings.items()},
        "poles": [row.entry for row in verification.poles],
        "target": content["target"],
        **({"proofs": content["proofs"]} if verification.proofs else {}),
    }
    return json.dumps(ordered, indent=1) + "\n"


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
    verdict = {"schema": VALIDATION_SCHEMA, "passed": validation.passed, "failures": list(validation.failures)}
    content = {**asdict(validation), "equality": equality_table(validation.equality)}
    content["timing"]["tick_jitter_s"] = validation.timing.tick_jitter_s
    return json.dumps({**verdict, **content}, indent=1) + "\n"
