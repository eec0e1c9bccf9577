"""Design as the verbs run it: a plant file goes in, a controller's table and the report on it come out."""

import contextlib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from controllers import loading
from controllers.settling import demand_settling
from controllers.table import CONTROLLERS
from design.report import DesignReport
from design.settings import read_settings
from design.table import design, poles_on
from design.trade_off import TradePoint, trade_off
from records.errors import BadInput, VerificationFailed
from records.law_table import FlownTable, LawTable
from records.table import ControllerTable
from records.verification import PoleMigration
from sim.bind import BoundPlant
from twinlaw.cli.console import stage
from twinlaw.workflows.chain.arithmetics import ARITHMETICS
from twinlaw.workflows.reading import load_bound
from verification.settling import demand_settled


@dataclass(frozen=True)
class Designed:
    """A plant with the controller that was designed for it and the report on it."""

    bound: BoundPlant
    table: ControllerTable
    report: DesignReport


def design_controller(plant: Path, arithmetic: str = "float32") -> Designed:
    """Design at all operating points, fit, and judge as flown in `arithmetic`; raises BadInput for an unusable plant or table."""
    with _computable(str(plant)):
        bound = load_bound(plant)
    return design_plant(bound, arithmetic, str(plant))


def design_plant(bound: BoundPlant, arithmetic: str = "float32", where: str = "") -> Designed:
    """The same for a plant that is loaded, told as `where`."""
    with stage("designing at the operating points, fitting, judging"), _computable(where or bound.plant.name):
        table, report = design(bound, read_settings(bound), ARITHMETICS[arithmetic].rounding)
    _fly(bound, table, arithmetic)
    return Designed(bound, table, report)


def _fly(bound: BoundPlant, table: FlownTable, arithmetic: str) -> None:
    """The gate's last question, put to the law that flies."""
    with stage(f"flying the generated law in {arithmetic} from rest"):
        demand_settled(bound, table, arithmetic)


def roll_off_trade(designed: Designed) -> tuple[TradePoint, ...]:
    """What other roll-off poles would make of the same design, see design.trade_off."""
    with stage("moving the roll-off"):
        return trade_off(designed.bound, read_settings(designed.bound), designed.table)


def design_other(plant: Path, name: str, arithmetic: str = "float32") -> LawTable[Any]:
    """The table of a controller that is not the scheduled law; raises BadInput for a plant that it cannot be designed for."""
    loading.demand_arithmetic(name, arithmetic)
    with _computable(str(plant)):
        bound = load_bound(plant)
    return design_other_on(bound, name, str(plant))


def design_other_on(bound: BoundPlant, name: str, where: str = "") -> LawTable[Any]:
    """The same for a plant that is loaded, told as `where`."""
    row = CONTROLLERS[name]
    with stage(f"designing {row.title}"), _computable(where or bound.plant.name):
        table: LawTable[Any] = row.design(bound, read_settings(bound))
        if isinstance(table, LawTable):  # the scheduled law's margins are judged where it is designed
            demand_settling(bound, table, row.float_law(table), row.plants)
    _fly(bound, table, "float32")
    return table


@contextlib.contextmanager
def _computable(where: str) -> Iterator[None]:
    """Raise BadInput naming the plant where its numbers overflow, or leave nothing to solve."""
    try:
        with np.errstate(over="raise", invalid="raise", divide="raise"):
            yield
    except (ArithmeticError, np.linalg.LinAlgError, VerificationFailed) as error:
        got = f"numbers that cannot be computed with ({error})"
        remedy = (
            "look for a wrong power of ten among the parameters, and for a root or a quotient without a slope at rest"
        )
        raise BadInput("plant", where, got, "magnitudes of a rig, in SI units", remedy) from error


def poles_of(report: DesignReport) -> tuple[PoleMigration, ...]:
    """The report's poles as verification.json states them."""
    column = report.scheduled_by if report.is_scheduled else None
    return tuple(PoleMigration(**entry, scheduled_by=column) for entry in report.pole_entries())


def demand_table_of(bound: BoundPlant, table: FlownTable, where: str) -> None:
    """Raise BadInput for a table of another plant; `where` names it."""
    if table.plant != bound.plant.name:
        got, expected = f"a table for {table.plant!r}", f"one for {bound.plant.name!r}"
        raise BadInput("controller table", where, got, expected, "give its plant with --plant")


def table_poles(bound: BoundPlant, table: ControllerTable, arithmetic: str = "float32") -> tuple[PoleMigration, ...]:
    """Poles of a table that exists already, flown in `arithmetic` on this plant; raises BadInput when the table is for another plant."""
    demand_table_of(bound, table, table.digest[:16])
    with stage("closing the loop at all angles"):
        settings = read_settings(bound)
        entries = poles_on(bound, settings, table, ARITHMETICS[arithmetic].rounding)
        column = None if table.schedule is None else table.loops[table.index(table.schedule.axis)].output
        return tuple(PoleMigration(**entry, scheduled_by=column) for entry in entries)
