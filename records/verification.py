"""What was verified of one controller table, as verification.json states it."""

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass

SCHEMA = "verification/1"


@dataclass(frozen=True)
class Equality:
    """Two executions of the same law stepped side by side: how many steps, and in how many their bits differed (NaN equals NaN)."""

    between: tuple[str, str]
    arithmetic: str
    steps: int
    mismatches: int


@dataclass(frozen=True)
class RoundingBound:
    """A proved bound on what one step in float32 can differ from real arithmetic, per output [V], and how it was proved."""

    u_M: float
    u_T: float
    method: str


@dataclass(frozen=True)
class PoleMigration:
    """The slowest closed-loop pole of one axis as designed, and the worst one between grid points after fit and rounding."""

    axis: str
    designed_slowest_rad_s: float
    worst_slowest_rad_s: float
    at_psi_rad: float
    stable: bool


@dataclass(frozen=True)
class TargetCost:
    """What one control step costs on the target: cycles measured and bounded, worst stack, and the image's memory."""

    arithmetic: str
    cycles_max: int
    cycles_bound: int
    stack_bytes: int
    flash_bytes: int
    ram_bytes: int


@dataclass(frozen=True)
class SelfTest:
    """The self-test that is emitted with the law, run at `place` ("host" or "target"): mismatches against the twin's recorded steps."""

    place: str
    arithmetic: str
    mismatches: int


@dataclass(frozen=True)
class Verification:
    """All checks of one table."""

    table_digest: str
    equality: tuple[Equality, ...]
    self_tests: tuple[SelfTest, ...]
    rounding: RoundingBound
    poles: tuple[PoleMigration, ...]
    target: tuple[TargetCost, ...]

    @property
    def failures(self) -> tuple[str, ...]:
        """One sentence for each check that did not hold; empty when all did."""
        unequal = (
            f"{a} and {b} differ in {row.mismatches} of {row.steps} steps ({row.arithmetic})"
            for row in self.equality
            for a, b in (row.between,)
            if row.mismatches
        )
        self_tests = (
            f"the self-test on the {row.place} found {row.mismatches} mismatches ({row.arithmetic})"
            for row in self.self_tests
            if row.mismatches
        )
        unstable = (
            f"the {row.axis} loop is unstable at {row.at_psi_rad:.3f} rad" for row in self.poles if not row.stable
        )
        slow = (
            f"{row.cycles_max} cycles were measured above the bound of {row.cycles_bound} ({row.arithmetic})"
            for row in self.target
            if row.cycles_max > row.cycles_bound
        )
        return (*unequal, *self_tests, *unstable, *slow)

    @property
    def passed(self) -> bool:
        """True when every check held."""
        return not self.failures


def verification_text(verification: Verification) -> str:
    """The record as JSON text in the form of CONTRACT.md."""
    content = asdict(verification)
    ordered: Mapping[str, object] = {
        "schema": SCHEMA,
        "table_digest": verification.table_digest,
        "passed": verification.passed,
        "failures": list(verification.failures),
        "equality": content["equality"],
        "self_test": content["self_tests"],
        "rounding_bound_V": content["rounding"],
        "poles": content["poles"],
        "target": content["target"],
    }
    return json.dumps(ordered, indent=1) + "\n"
