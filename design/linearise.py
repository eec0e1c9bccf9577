"""The linearised plant at an operating point, eqs (17)-(19), and its two single-input subsystems."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from records.errors import BadInput
from records.loops import LOOPS
from sim.bind import BoundPlant
from sim.equilibrium import OperatingPoint
from sim.kernel.reference import reference

Array = NDArray[np.float64]


@dataclass(frozen=True)
class LinearPlant:
    """dx/dt = A x + B u, y = C x of deviations from an operating point; shapes (n, n), (n, m), (r, n)."""

    A: Array
    B: Array
    C: Array


@dataclass(frozen=True)
class Subsystem:
    """Which states, input and output of the plant the design of one axis sees."""

    states: tuple[str, str, str]
    input: str
    output: str


SUBSYSTEMS: Mapping[str, Subsystem] = {
    loop.axis: Subsystem((rotor_speed, loop.output, f"{loop.symbol}_dot_rad_s"), loop.input, loop.output)
    for loop, rotor_speed in zip(LOOPS, ("omega_M_rad_s", "omega_T_rad_s"), strict=True)
}


def linearise(bound: BoundPlant, point: OperatingPoint) -> LinearPlant:
    """A, B, C of eqs (17) and (18) at `point`, without Coulomb friction: sgn has no slope at rest."""
    model = reference(bound.model)
    no_friction = np.zeros(len(bound.model.axes))
    arguments = (0.0, point.x0, point.u0, bound.p, no_friction)
    return LinearPlant(model.A(*arguments), model.B(*arguments), model.C(*arguments))


def subsystem(bound: BoundPlant, linear: LinearPlant, axis: str) -> LinearPlant:
    """The third-order part of `linear` from the axis' input to its angle, eq (20) or (21), cross-coupling left out.

    Raises BadInput where the input does not drive the rotor's speed at once, as behind a second lag.
    """
    wanted = SUBSYSTEMS[axis]
    names = [symbol.name for symbol in bound.model.states]
    rows = [names.index(name) for name in wanted.states]
    column = [symbol.name for symbol in bound.model.inputs].index(wanted.input)
    output = list(bound.model.outputs).index(wanted.output)
    if not np.any(linear.B[rows, column]):
        raise BadInput(
            f"{axis} axis", f"plant {bound.plant.name!r}", f"{wanted.input} behind a second lag of the rotor",
            "a rotor with one lag: the law is designed on three states",
            "design it on another plant, and fly this one with --table",
        )  # fmt: skip
    return LinearPlant(
        A=linear.A[np.ix_(rows, rows)], B=linear.B[np.ix_(rows, [column])], C=linear.C[np.ix_([output], rows)]
    )
