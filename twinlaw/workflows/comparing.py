"""The stages behind `twinlaw compare`: each controller designed, generated, linked, verified on the board, and flown."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from codegen.protocol_source import protocol_source
from controllers.controller import Controller
from controllers.instantaneous import CONTROLLER as INSTANTANEOUS
from controllers.table import CONTROLLERS
from design.settings import read_settings
from records.errors import VerificationFailed
from records.files import write_atomic
from records.protocol import PROTOCOL
from records.verification import Equality, equality_table
from rig.emulator.board import EmulatedBoard
from rig.flight.target_law import TargetLaw
from rig.programming.image import build_firmware
from sim.bind import BoundPlant
from twinlaw.cli.console import stage
from verification.comparison.eq26 import FormError, form_errors
from verification.comparison.flights import AXES, FILTERS, Each, Flown, Law, Trial, fly_figures, judge
from verification.comparison.manoeuvres import FIGURES
from verification.comparison.measures import Merit
from verification.equality import compare
from verification.flown_law import FlownLaw
from verification.host_law import HostLaw
from verification.stimuli import standard_stimuli

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
    """One controller on the board: its law, its table's digest, equality, cost; its flights through the figures, with merits."""

    row: Controller
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


def compare_controllers(
    bound: BoundPlant, names: Sequence[str], wanted: Wanted, folder: Path, each: Each
) -> list[Compared]:
    """Everything of each controller; `each` flies the spread plants and effects, as `map` does."""
    built = [build_controller(bound, name, wanted, folder) for name in names]
    laws = {entry.row.name: entry.law for entry in built}
    judged = judge(bound, laws, read_settings(bound).sample_period_s, wanted.trial, each)
    return [Compared(**vars(entry), **vars(judged[entry.row.name])) for entry in built]


def build_controller(bound: BoundPlant, name: str, wanted: Wanted, folder: Path) -> Built:
    """One controller designed, verified, and flown through the figures; leaves its table, C and image in folder/NAME."""
    row = CONTROLLERS[name]
    with stage(f"{name}: designing"):
        table = row.design(bound, read_settings(bound))
        texts = row.generate(table)
    place = folder / name
    write_atomic(place / "controller.json", row.text(table))
    for file, text in {**texts, **protocol_source(PROTOCOL)}.items():
        write_atomic(place / "generated" / file, text)
    with stage(f"{name}: building the firmware"):
        image = build_firmware(texts, place)
    twin, host = row.twin(table), HostLaw(texts)
    target = TargetLaw(EmulatedBoard(image.elf), state_words=twin.state_words)
    stimuli = standard_stimuli(table, wanted.steps, state_words=twin.state_words)
    with stage(f"{name}: stepping twin, host and target side by side"):
        equality = tuple(compare(one, other, stimuli).equality for one, other in ((twin, host), (host, target)))
        mismatches = host.self_test() + target.self_test()
    cost = BoardCost(
        cycles_max=target.cycles_max,
        stack_bytes=target.stack_bytes,
        flash_bytes=image.sizes.flash_bytes,
        ram_bytes=image.sizes.ram_bytes,
    )
    with stage(f"{name}: flying the papers' manoeuvres"):
        flights = fly_figures(bound, FlownLaw(texts), table.sample_period_s)
    figures = {figure: flown.merits() for figure, flown in flights.items()}
    law = Law(texts, {share: _filtered(bound, row, table, share) for share in FILTERS})
    return Built(row, law, table.digest, equality, mismatches, cost, flights, figures)


def _filtered(bound: BoundPlant, row: Controller, table: Any, share: float) -> Mapping[str, str]:
    """The controller's texts behind another reference filter, in shares of the plant file's time constants."""
    settings = read_settings(bound)
    changed = {
        axis: replace(
            getattr(table, axis), prefilter_time_constant_s=share * settings.axis(axis).prefilter_time_constant_s
        )
        for axis in AXES
    }
    return row.generate(replace(table, **changed))


def eq26_errors(bound: BoundPlant, names: Sequence[str]) -> Mapping[tuple[str, str], FormError]:
    """Eq (26) in float32, the paper's form and the board's, by form and axis; nothing where the controller that solves it is left out."""
    if INSTANTANEOUS.name not in names:
        return {}
    with stage("solving eq (26) in float32 over the whole range"):
        settings = read_settings(bound)
        return form_errors(bound, settings, INSTANTANEOUS.design(bound, settings))


def demand_equal(rows: Sequence[Compared]) -> None:
    """Raise VerificationFailed naming every check that did not hold."""
    failures = [text for row in rows for text in row.failures]
    if failures:
        raise VerificationFailed("; ".join(failures))


def facts(
    bound: BoundPlant, rows: Sequence[Compared], wanted: Wanted, eq26: Mapping[tuple[str, str], FormError]
) -> dict[str, Any]:
    """compare.json for a program."""
    return {
        "schema": SCHEMA,
        "plant": bound.plant.name,
        "runs": wanted.trial.runs,
        "seed": wanted.trial.seed,
        "figures": {name: figure.title for name, figure in FIGURES.items()},
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
        "figures": {
            name: {axis: asdict(merit) for axis, merit in merits.items()} for name, merits in row.figures.items()
        },
        "spread": {axis: asdict(spread_of(row.spread, axis)) for axis in AXES},
        "effects": {
            name: {axis: asdict(merit) for axis, merit in merits.items()} for name, merits in row.effects.items()
        },
        "filters": [
            {"share": share, **{axis: asdict(spread_of(merits, axis)) for axis in AXES}}
            for share, merits in row.filters.items()
        ],
    }


@dataclass(frozen=True)
class Spread:
    """One axis over the spread plants: how many flights had a step that did not settle, and medians and worst of its merits."""

    unsettled: int
    median_iae_rad_s: float
    worst_iae_rad_s: float
    worst_overshoot: float
    worst_settling_s: float | None
    worst_steady_error_rad: float
    worst_swing_V: float


def spread_of(flown: Sequence[Mapping[str, Merit]], axis: str) -> Spread:
    """The flights of one controller on spread plants, one axis."""
    merits = [entry[axis] for entry in flown]
    times = [merit.settling_s for merit in merits if merit.settling_s is not None]
    return Spread(
        unsettled=len(merits) - len(times),
        median_iae_rad_s=float(np.median([merit.iae_rad_s for merit in merits])),
        worst_iae_rad_s=max(merit.iae_rad_s for merit in merits),
        worst_overshoot=max(merit.overshoot for merit in merits),
        worst_settling_s=max(times, default=None),
        worst_steady_error_rad=max(merit.steady_error_rad for merit in merits),
        worst_swing_V=max(merit.swing_V for merit in merits),
    )
