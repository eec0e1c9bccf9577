"""A controller that is nothing but its design rule, its equations over any arithmetic, and its template of C."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from codegen.law_frame import AxisEquations
from codegen.twin import Float32Twin
from controllers.equations.designing import Points, points_of
from controllers.equations.exact import EquationLaw, EquationTwin
from controllers.equations.source import generate
from controllers.equations.tuned import Tunable
from design.settings import DesignSettings
from design.structure import demand_helicopter
from records.law_table import LawTable, law_table_text
from sim.bind import BoundPlant
from sim.loop import Controller


@dataclass(frozen=True)
class EquationController:
    """A row of the table.

    `needs` says why it is the helicopter's alone, None where it is any plant's. `equations` are those of a table, `gains` is the record of
    one axis' own numbers, `tables` designs at the operating points, `template` is its file in controllers/templates; `tunable` is what a
    plant's file may say of it.
    """

    name: str
    title: str
    source: str
    plants: str
    note: str
    equations: Callable[[LawTable[Any]], AxisEquations]
    gains: type
    tables: Callable[[Points], LawTable[Any]]
    template: str
    tunable: Tunable | None = None
    needs: str | None = None

    def design(self, bound: BoundPlant, settings: DesignSettings) -> LawTable[Any]:
        """The table on this plant; raises BadInput where it cannot be designed."""
        return self.tables(self.points(bound, settings))

    def points(self, bound: BoundPlant, settings: DesignSettings) -> Points:
        """What it is designed on; raises BadInput for a plant that it cannot have."""
        if self.needs is not None:
            demand_helicopter(bound, f"the controller {self.name!r}", self.needs)
        return points_of(bound, settings)

    def text(self, table: LawTable[Any]) -> str:
        """The table as JSON text with its digest."""
        return law_table_text(table)

    def float_law(self, table: LawTable[Any]) -> Controller:
        """The law in double precision."""
        return EquationLaw(self.equations(table), table)

    def twin(self, table: LawTable[Any]) -> Float32Twin:
        """The exact model of the float32 C."""
        return EquationTwin(self.equations(table), table)

    def generate(self, table: LawTable[Any]) -> Mapping[str, str]:
        """law.h, law.c and law_self_test.c."""
        return generate(table, self.equations(table), self.template)
