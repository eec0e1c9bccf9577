"""The one interface of all controllers: from a plant to a table, and from the table to a float law, its exact twin and its C."""

from collections.abc import Mapping
from typing import Any, Protocol

from codegen.twin import Float32Twin
from design.settings import DesignSettings
from sim.bind import BoundPlant
from sim.loop import Controller as FloatLaw


class Controller(Protocol):
    """A row of controllers.table.CONTROLLERS.

    A table's digest names table and controller: it is in the C, in the image, and in what the board answers to IDENTIFY. Any image is
    linked from the same firmware and the three C texts.
    """

    @property
    def name(self) -> str:
        """What --controller calls it."""

    @property
    def title(self) -> str:
        """A few words for a heading."""

    @property
    def source(self) -> str:
        """The paper and the place in it."""

    @property
    def plants(self) -> str:
        """For which plants it can be designed; it refuses all others."""

    @property
    def note(self) -> str:
        """A paragraph of docs/controllers.md: how it is designed, and which of the paper's slips are mended."""

    def design(self, bound: BoundPlant, settings: DesignSettings) -> Any:
        """The table (a records.law_table.FlownTable) on this plant; raises BadInput where it cannot be designed."""

    def text(self, table: Any) -> str:
        """The table as JSON text with its digest."""

    def float_law(self, table: Any) -> FloatLaw:
        """The law in double precision."""

    def twin(self, table: Any) -> Float32Twin:
        """The exact model of the float32 C."""

    def generate(self, table: Any) -> Mapping[str, str]:
        """law.h, law.c and law_self_test.c; the same table gives the same bytes."""
