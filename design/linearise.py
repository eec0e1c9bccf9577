"""The linearised plant at an operating point, eqs (17)-(19), and its single-input subsystems, one a loop."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from design.linear_plant import LinearPlant, minimal
from design.structure import measured_axis
from records.errors import BadInput
from records.loops import LOOPS, Loop
from records.table import ORDERS
from sim.bind import BoundPlant
from sim.equilibrium import OperatingPoint
from sim.kernel.reference import reference
from sim.model import Model

Array = NDArray[np.float64]

GROWS_1_S = 1e-9  # a pole to the right of this grows: what rounding leaves of an integrator's 0 is a millionth of that, in a plant of 1/s


def linearise(bound: BoundPlant, point: OperatingPoint) -> LinearPlant:
    """A, B, C of eqs (17) and (18) at `point`, without Coulomb friction: sgn has no slope at rest."""
    model = reference(bound.model)
    no_friction = np.zeros(len(bound.model.axes))
    arguments = (0.0, point.x0, point.u0, bound.p, no_friction)
    return LinearPlant(model.A(*arguments), model.B(*arguments), model.C(*arguments))


def subsystem(bound: BoundPlant, linear: LinearPlant, loop: Loop, loops: Sequence[Loop] = LOOPS) -> LinearPlant:
    """The part of `linear` from the loop's input to its angle, eq (20) or (21), without what other loops hold, an axis or, where none
    moves, the state that they measure: those that the input reaches and that reach the angle, in the plant's order.

    Raises BadInput where the input does not reach the angle here, or through more states than a law can be made for. Of equal parts side
    by side it is what they do together.
    """
    model = bound.model
    column = [symbol.name for symbol in model.inputs].index(loop.input)
    output = [str(name) for name in model.outputs].index(loop.output)
    others = {state for other in loops if other != loop for state in _held_states(model, other)}
    free = np.array([symbol not in others for symbol in model.states])
    coupling = (linear.A != 0.0) & free & free[:, np.newaxis]
    reached = _closure(coupling, (linear.B[:, column] != 0.0) & free)
    rows = np.flatnonzero(reached & _closure(coupling.T, (linear.C[output] != 0.0) & free))
    between = LinearPlant(linear.A[np.ix_(rows, rows)], linear.B[rows][:, [column]], linear.C[[output]][:, rows])
    part = minimal(between) if len(rows) else between
    if not 1 <= len(part.A) <= ORDERS[-1]:
        states = ", ".join(str(model.states[row]) for row in rows) or "none"
        raise BadInput(
            f"{loop.axis} axis", f"plant {bound.plant.name!r}", f"{len(rows)} states between {loop.input} and {loop.output}: {states}",
            f"1 to {ORDERS[-1]} that the input moves and that move the output",
            "choose another operating range, or another input for this loop",
        )  # fmt: skip
    return part


def of_loops(bound: BoundPlant, linear: LinearPlant, loops: Sequence[Loop]) -> LinearPlant:
    """The whole plant with the loops' inputs and outputs alone, in their order, without states that none of these outputs shows.

    Where a wheel stands whose speed is measured is nothing that its loop holds; a state that grows unseen stays.
    """
    inputs, outputs = [symbol.name for symbol in bound.model.inputs], [str(name) for name in bound.model.outputs]
    columns, rows = [inputs.index(loop.input) for loop in loops], [outputs.index(loop.output) for loop in loops]
    shown = _closure(linear.A.T != 0.0, np.any(linear.C[rows] != 0.0, axis=0))
    unseen = linear.A[~shown][:, ~shown]
    kept = np.flatnonzero(shown | (max(np.linalg.eigvals(unseen).real, default=0.0) > GROWS_1_S))
    return LinearPlant(linear.A[kept][:, kept], linear.B[kept][:, columns], linear.C[rows][:, kept])


def _held_states(model: Model, loop: Loop) -> set[Any]:
    axis = measured_axis(model, loop)
    return {model.outputs[loop.output]} if axis is None else {axis.position, axis.velocity}


def _closure(coupling: NDArray[np.bool_], seeds: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """All states that are reached from the seeds, where coupling[i, j] leads from j to i."""
    reached = seeds
    for _ in range(len(seeds)):
        reached = reached | (coupling @ reached)
    return reached
