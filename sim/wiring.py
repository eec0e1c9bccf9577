"""Between a plant's columns and a law's loops: which outputs a law measures, which inputs it commands, what the others stay at."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from records.errors import BadInput
from records.loops import Loop
from sim.bind import BoundPlant

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Wiring:
    """The places of the loops' `outputs` and `inputs` among the plant's, and `rest_V` (inputs,) for those that no loop commands."""

    outputs: tuple[int, ...]
    inputs: tuple[int, ...]
    rest_V: Array
    output_count: int

    def angles(self, outputs: Sequence[float]) -> tuple[float, ...]:
        """What the loops measure of all the plant's outputs."""
        return tuple(outputs[place] for place in self.outputs)

    def columns(self, angles: Sequence[float]) -> tuple[float, ...]:
        """The loops' angles or references as all the plant's outputs, NaN where there is no loop."""
        spread = [math.nan] * self.output_count
        for place, angle in zip(self.outputs, angles, strict=True):
            spread[place] = angle
        return tuple(spread)

    def command_V(self, voltages_V: Sequence[float]) -> tuple[float, ...]:
        """All the plant's inputs where the loops command `voltages_V`."""
        command_V: list[float] = self.rest_V.tolist()
        for place, u_V in zip(self.inputs, voltages_V, strict=True):
            command_V[place] = u_V
        return tuple(command_V)


def wiring(bound: BoundPlant, loops: Sequence[Loop], u0_V: Array | None = None) -> Wiring:
    """The wiring of `loops`; inputs without a loop stay at `u0_V` (inputs,), or at the least effort.

    Raises BadInput naming what the plant does not have.
    """
    outputs, inputs = [str(name) for name in bound.model.outputs], [symbol.name for symbol in bound.model.inputs]
    lacking = [f"the output {loop.output}" for loop in loops if loop.output not in outputs]
    lacking += [f"the input {loop.input}" for loop in loops if loop.input not in inputs]
    if lacking:
        raise BadInput(
            "plant for this law", f"plant {bound.plant.name!r}", f"a plant without {', '.join(lacking)}",
            "the columns that the table's loops measure and command",
            "give the plant that the table was designed for, or design a table for this one",
        )  # fmt: skip
    rest_V = (
        [min(max(0.0, low), high) for low, high in map(bound.commands, bound.model.inputs)] if u0_V is None else u0_V
    )
    return Wiring(
        tuple(outputs.index(loop.output) for loop in loops),
        tuple(inputs.index(loop.input) for loop in loops),
        np.asarray(rest_V, dtype=float),
        len(outputs),
    )
