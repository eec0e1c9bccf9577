"""A comparison of controllers as its page shows it: what each costs and how it flew, its spread, and the same for a program."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from controllers.controller import Controller
from records.loops import Loop
from records.verification import Equality, equality_table
from sim.bind import BoundPlant
from verification.comparison.eq26 import FormError
from verification.comparison.flights import Flown, Law, Trial
from verification.comparison.manoeuvres import figures
from verification.comparison.measures import Merit

SCHEMA = "comparison/1"


@dataclass(frozen=True)
class Wanted:
    """What is compared: the plants that they fly, and the steps of each equality."""

    trial: Trial
    steps: int


@dataclass(frozen=True)
class BoardCost:
    """What one control step took at most, of all that were compared, and the image's memory; flash without wait states."""

    cycles_max: int
    stack_bytes: int
    flash_bytes: int
    ram_bytes: int


@dataclass(frozen=True, eq=False)
class Built:
    """One controller on the board: its loops, the limits of each one's input, and law, its table's digest, equality, cost; its flights
    through the figures, with merits."""

    row: Controller
    loops: tuple[Loop, ...]
    limits_V: tuple[tuple[float, float], ...]
    law: Law
    digest: str
    equality: tuple[Equality, ...]
    self_test_mismatches: int
    cost: BoardCost
    flights: Mapping[str, Flown]
    figures: Mapping[str, Mapping[str, Merit]]


@dataclass(frozen=True, eq=False)
class Compared(Built):
    """The same with its merits by axis on each spread plant and with each effect."""

    spread: Sequence[Mapping[str, Merit]]
    effects: Mapping[str, Mapping[str, Merit]]
    filters: Mapping[float, Sequence[Mapping[str, Merit]]]

    @property
    def failures(self) -> tuple[str, ...]:
        """Sentences, one a check that did not hold."""
        differing = [f"{self.row.name}: {text}" for row in self.equality for text in row.failures]
        wrong = self.self_test_mismatches
        return (*differing, *([f"{self.row.name}: the self-test finds {wrong} mismatches"] if wrong else []))


@dataclass(frozen=True)
class SpreadMerits:
    """One axis over the spread plants: how many flights had a step that did not settle, and medians and worst of its merits."""

    unsettled: int
    median_iae_rad_s: float
    worst_iae_rad_s: float
    worst_overshoot: float
    worst_settling_s: float | None
    worst_steady_error_rad: float
    worst_swing_V: float
    median_travel_V_s: float
    median_reversals_1_s: float


def spread_of(flown: Sequence[Mapping[str, Merit]], axis: str) -> SpreadMerits:
    """The flights of one controller on spread plants, one axis."""
    merits = [entry[axis] for entry in flown]
    times = [merit.settling_s for merit in merits if merit.settling_s is not None]
    return SpreadMerits(
        unsettled=len(merits) - len(times),
        median_iae_rad_s=float(np.median([merit.iae_rad_s for merit in merits])),
        worst_iae_rad_s=max(merit.iae_rad_s for merit in merits),
        worst_overshoot=max(merit.overshoot for merit in merits),
        worst_settling_s=max(times, default=None),
        worst_steady_error_rad=max(merit.steady_error_rad for merit in merits),
        worst_swing_V=max(merit.swing_V for merit in merits),
        median_travel_V_s=float(np.median([merit.travel_V_s for merit in merits])),
        median_reversals_1_s=float(np.median([merit.reversals_1_s for merit in merits])),
    )


def facts(
    bound: BoundPlant, rows: Sequence[Compared], wanted: Wanted, eq26: Mapping[tuple[str, str], FormError]
) -> dict[str, Any]:
    """compare.json for a program."""
    return {
        "schema": SCHEMA,
        "plant": bound.plant.name,
        "runs": wanted.trial.runs,
        "seed": wanted.trial.seed,
        "figures": {name: figure.title for name, figure in figures(bound).items()},
        "controllers": [_facts(row) for row in rows],
        "eq26_float32": [{"form": form, "axis": axis, **asdict(error)} for (form, axis), error in eq26.items()],
    }


def _facts(row: Compared) -> dict[str, Any]:
    return {
        "name": row.row.name,
        "title": row.row.title,
        "source": row.row.source,
        "table_digest": row.digest,
        "equality": [equality_table(entry) for entry in row.equality],
        "self_test_mismatches": row.self_test_mismatches,
        "target": asdict(row.cost),
        "figures": {name: _told(row, merits) for name, merits in row.figures.items()},
        "spread": {loop.axis: _own(loop, asdict(spread_of(row.spread, loop.axis))) for loop in row.loops},
        "effects": {name: _told(row, merits) for name, merits in row.effects.items()},
        "filters": [
            {"share": share, **{loop.axis: _own(loop, asdict(spread_of(merits, loop.axis))) for loop in row.loops}}
            for share, merits in row.filters.items()
        ],
    }


def _told(row: Compared, merits: Mapping[str, Merit]) -> dict[str, Any]:
    return {loop.axis: _own(loop, asdict(merits[loop.axis])) for loop in row.loops}


def _own(loop: Loop, section: Mapping[str, Any]) -> dict[str, Any]:
    """The same by names in the units of this loop's output and input."""
    return {
        f"{loop.own(name.removesuffix('_s'))}_s" if name.endswith(("_rad_s", "_V_s")) else loop.own(name): value
        for name, value in section.items()
    }
