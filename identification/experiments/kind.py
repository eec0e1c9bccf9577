"""What an experiment is: how the rig stands for it, how it is performed, what it tells."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from numpy.random import Generator

from identification.runs.run import Run
from records.experiment import Experiment
from sim.bind import BoundPlant


@dataclass(frozen=True)
class Kind:
    """An experiment: how the rig must stand for it, which parameters it is for, how it is performed, how its record becomes a run.

    `aids` are parameters that the plant does not have, each with the facts of the record that give its value and sd (none: unknown).
    `code` is how a genetic search codes its parameters: lowest and highest value and number of bits. `symbol` is what its paper calls it,
    "" where it has no name but its title.
    """

    number: int
    title: str
    mount: str
    locked: tuple[str, ...]
    own: tuple[str, ...]
    perform: Callable[[BoundPlant, Generator], Experiment]
    run: Callable[[Experiment, BoundPlant], Run]
    aids: Mapping[str, tuple[str, str] | None]
    code: Mapping[str, tuple[float, float, int]] = field(default_factory=dict)
    symbol: str = ""

    @property
    def heading(self) -> str:
        """Its symbol and title."""
        return f"{self.symbol}: {self.title}" if self.symbol else self.title
