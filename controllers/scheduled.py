"""The scheduled polynomial law of seed 000, eqs (20)-(28): the one that `twinlaw run` flies, as a row among the others."""

from collections.abc import Mapping

from codegen.law import generate_law
from codegen.twin import Float32Twin
from design.law import FloatLaw
from design.settings import DesignSettings
from design.table import design
from records.table import ControllerTable, table_text
from sim.bind import BoundPlant
from sim.loop import Controller


class Scheduled:
    """The existing chain behind the interface of controllers.controller."""

    name = "scheduled"
    title = "scheduled pole placement"
    source = "seed 000, section 3.4: coefficients as polynomials in what schedules them"
    plants = "any plant of one to four loops of up to five states, as `ce150`, that holds the margins of [design] over its range"
    note = (
        "is the table that `twinlaw run` flies ([theory.md](theory.md), sections 2 to 4): two poles a state of each axis and one "
        "of a roll-off placed at each operating point of [design], coefficients fitted over what schedules them, integral "
        "action, references filtered by 1/(T s + 1)^2."
    )

    def design(self, bound: BoundPlant, settings: DesignSettings) -> ControllerTable:
        """The table on this plant; raises BadInput where it cannot be designed, or falls below a margin."""
        return design(bound, settings)[0]

    def text(self, table: ControllerTable) -> str:
        """The table as JSON text with its digest."""
        return table_text(table)

    def float_law(self, table: ControllerTable) -> Controller:
        """The law in double precision."""
        return FloatLaw(table)

    def twin(self, table: ControllerTable) -> Float32Twin:
        """The exact model of the float32 C."""
        return Float32Twin(table)

    def generate(self, table: ControllerTable) -> Mapping[str, str]:
        """law.h, law.c and law_self_test.c."""
        return generate_law(table)


CONTROLLER = Scheduled()
