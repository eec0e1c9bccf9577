"""What can be watched: a board that flies, or a log that is replayed."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

from records.logs.live import LiveRow
from records.text.units import shown, stem, unit_suffix
from sim.bind import BoundPlant


@dataclass(frozen=True)
class Step:
    """Rows that came, and how long to wait for the next step on the wall clock; 0 for a source that keeps its own pace."""

    rows: Sequence[LiveRow]
    wait_s: float


class Source(Protocol):
    """Moved by one thread alone. `anew` is set by a source whose next row does not follow the last one, and cleared by its reader."""

    anew: bool

    @property
    def armed(self) -> bool:
        """Whether a board obeys its law now."""
        ...

    def facts(self) -> Mapping[str, Any]:
        """What never changes, for the page."""
        ...

    def status(self) -> Mapping[str, Any]:
        """What changes, for the page."""
        ...

    def obey(self, wish: Mapping[str, Any]) -> None:
        """Do what a page asks for; raises BadInput for what cannot be done."""
        ...

    def step(self) -> Step:
        """Go on by a little; raises BadInput where the board is lost."""
        ...

    def disarm(self) -> None:
        """Nothing is armed afterwards; raises BadInput where the board does not answer."""
        ...

    def close(self) -> None:
        """Leave ports and files as they are to be left."""
        ...


def signals(bound: BoundPlant) -> dict[str, Any]:
    """Inputs and outputs as the page names them: what a person calls it, the unit shown, and its factor."""
    model = bound.model
    axes = {str(axis.position): axis.name for axis in model.axes}
    outputs = [_signal(name, axes.get(str(expression), "")) for name, expression in model.outputs.items()]
    return {"outputs": outputs, "inputs": [_signal(str(variable), "") for variable in model.inputs]}


def _signal(name: str, axis: str) -> dict[str, Any]:
    unit, factor = shown(name)
    return {
        "name": name,
        "label": f"{axis} {stem(name)}".strip(),
        "unit": unit if unit_suffix(name) else "",
        "factor": factor,
    }
