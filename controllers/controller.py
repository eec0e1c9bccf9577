"""The one interface of all controllers: from a plant to a table, and from the table to a float law, its exact twin and its C."""

from collections.abc import Mapping
from typing import Any, Protocol

from codegen.twin import Float32Twin
from design.settings import DesignSettings
from records.law_table import FlownTable
from sim.bind import BoundPlant


class FloatLaw(Protocol):
    """The law in double precision, as the closed loop takes it (sim.loop.Controller)."""

    def reset(self, psi_rad: float, phi_rad: float) -> None: ...

    def step(self, psi_ref_rad: float, phi_ref_rad: float, psi_rad: float, phi_rad: float) -> tuple[float, float]: ...


class Controller(Protocol):
    """A row of controllers.table.CONTROLLERS.

    `title` is a few words for a heading, `source` the paper and the place in it, `note` a paragraph of docs/controllers.md: how it is
    designed, and which of the paper's slips are mended. A table's digest names table and controller: it is in the C, in the image, and
    in what the board answers to IDENTIFY. Any image is linked from the same firmware and the three C texts.
    """

    @property
    def name(self) -> str: ...

    @property
    def title(self) -> str: ...

    @property
    def source(self) -> str: ...

    @property
    def note(self) -> str: ...

    def design(self, bound: BoundPlant, settings: DesignSettings) -> Any:
        """The table (a FlownTable) on this plant; raises BadInput where it cannot be designed."""

    def text(self, table: Any) -> str:
        """The table as JSON text with its digest."""

    def float_law(self, table: Any) -> FloatLaw:
        """The law in double precision."""

    def twin(self, table: Any) -> Float32Twin:
        """The exact model of the float32 C."""

    def generate(self, table: Any) -> Mapping[str, str]:
        """law.h, law.c and law_self_test.c; the same table gives the same bytes."""


__all__ = ["Controller", "FloatLaw", "FlownTable"]
