"""What can be matched with frequency responses: a model's matrices as functions of its free parameters, and its response.

    (1)  T(omega) = C (z I - A_d)^-1 B_d + D / z,   z = exp(j omega T_s),   x(k+1) = A_d x(k) + B_d u(k)

Eq (6) of seed 002, T(s) = C (s I - A)^-1 B + D, for readings every T_s of a plant whose inputs are held: A_d and B_d are exact. The hold's
half sample of delay is 9 degrees at 15 rad/s and 50 Hz. A row is read before its new input takes hold, hence D / z.
"""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

from design.linearise import linearise
from design.settings import read_settings
from identification.fit.ranges import Range, ranges_of
from identification.frequency.lateral import STATES, StateSpace, state_space
from identification.runs.run import coefficient_names
from records.errors import BadInput
from records.plant import Plant
from sim.bind import BoundPlant
from sim.equilibrium import rest_with

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]


class LinearModel(Protocol):
    """A linear model with free parameters `names`: where they start, and how far off that may be, both (parameters,)."""

    @property
    def names(self) -> tuple[str, ...]:
        """Free parameters."""
        ...

    @property
    def start(self) -> Array:
        """The plant file's values of them."""
        ...

    @property
    def spread(self) -> Array:
        """Their standard deviations, as the plant file states them."""
        ...

    @property
    def states(self) -> tuple[str, ...]:
        """Names of x, with their units as far as they have one."""
        ...

    @property
    def inputs(self) -> tuple[str, ...]:
        """Columns of u."""
        ...

    @property
    def outputs(self) -> tuple[str, ...]:
        """Columns of y."""
        ...

    def matrices(self, theta: Array) -> StateSpace | None:
        """A, B, C, D at theta; None where the plant cannot be as theta says."""
        ...


@dataclass(frozen=True, eq=False)
class LateralModel:
    """Eq (3) of seed 002 with the parameters of its plant file, of which `names` are free."""

    plant: Plant
    names: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    states: tuple[str, ...] = STATES

    @property
    def start(self) -> Array:
        """Values of the plant file."""
        return np.array([self.plant.parameters[name].values[0] for name in self.names])

    @property
    def spread(self) -> Array:
        """Standard deviations of the plant file."""
        return np.array([self.plant.parameters[name].sds[0] for name in self.names])

    def matrices(self, theta: Array) -> StateSpace:
        """Eq (3)."""
        values = {name: entry.values[0] for name, entry in self.plant.parameters.items()}
        return state_space(values | dict(zip(self.names, theta.tolist(), strict=True)))


@dataclass(frozen=True, eq=False)
class OperatingPointModel:
    """A plant of this project, linearised where it rests with the outputs at `places` at `values`; that point is found anew for each theta.

    `ranges` hold the free parameters: outside them there is no such plant.
    """

    bound: BoundPlant
    ranges: Mapping[str, Range]
    places: tuple[int, ...]
    values: tuple[float, ...]

    @property
    def names(self) -> tuple[str, ...]:
        """Free parameters."""
        return tuple(self.ranges)

    @property
    def states(self) -> tuple[str, ...]:
        """The plant's states."""
        return tuple(str(state) for state in self.bound.model.states)

    @property
    def inputs(self) -> tuple[str, ...]:
        """Columns of the plant's inputs."""
        return tuple(str(variable) for variable in self.bound.model.inputs)

    @property
    def outputs(self) -> tuple[str, ...]:
        """Columns of the plant's outputs."""
        return tuple(self.bound.model.outputs)

    @property
    def _places(self) -> list[int]:
        known = coefficient_names(self.bound.model)
        return [known.index(name) for name in self.names]

    @property
    def start(self) -> Array:
        """Values of the plant file."""
        return np.asarray(self.bound.p[self._places])

    @property
    def spread(self) -> Array:
        """Standard deviations of the plant file."""
        return np.asarray(self.bound.sd[self._places])

    def matrices(self, theta: Array) -> StateSpace | None:
        """A, B, C at the rest point, eqs (17) and (18) of seed 000; None where there is none."""
        if any(
            not entry.lower <= value <= entry.upper for entry, value in zip(self.ranges.values(), theta, strict=True)
        ):
            return None
        p = self.bound.p.copy()
        p[self._places] = theta
        moved = replace(self.bound, p=p)
        try:
            linear = linearise(moved, rest_with(moved, self.places, self.values))
        except (BadInput, FloatingPointError):
            return None
        return StateSpace(linear.A, linear.B, linear.C, np.zeros((linear.C.shape[0], linear.B.shape[1])))


def held_response(of: StateSpace, omega_rad_s: Array, period_s: float) -> Complex:
    """(1), shape (f, outputs, inputs)."""
    A_d, B_d = discrete(of, period_s)
    z = np.exp(1j * omega_rad_s * period_s)
    states = np.linalg.solve(z[:, None, None] * np.eye(A_d.shape[0]) - A_d, np.broadcast_to(B_d, (z.size, *B_d.shape)))
    return np.asarray(of.C @ states + of.D / z[:, None, None])


def discrete(of: StateSpace, period_s: float) -> tuple[Array, Array]:
    """A_d (n, n) and B_d (n, m) of held inputs."""
    n, m = of.B.shape
    block = np.zeros((n + m, n + m))
    block[:n] = np.hstack([of.A, of.B]) * period_s
    whole = expm(block)
    return whole[:n, :n], whole[:n, n:]


def operating_point_model(
    bound: BoundPlant,
    names: tuple[str, ...],
    means: Mapping[str, float],
    limits: Mapping[str, tuple[float, float]] | None = None,
) -> OperatingPointModel:
    """The plant where it rests at the `means` of its outputs; the free parameters within `limits`, by default a fifth to five times.

    Of axes with positions that is by these; where no input holds them all there, and of a plant without a position, by what its loops
    measure, or where none are named by as many of its outputs as it has inputs.

    Raises BadInput for an unknown parameter or a plant that cannot rest there.
    """
    outputs = list(map(str, bound.model.outputs))
    arms = [axis.position for axis in bound.model.axes if axis.position is not None]
    held = [output for output, y in zip(outputs, bound.model.outputs.values(), strict=True) if y in arms]
    own = ranges_of(bound, names, limits)
    if arms:
        with suppress(BadInput):
            return OperatingPointModel(bound, own, *_held_at(bound, held, means))
    return OperatingPointModel(bound, own, *_held_at(bound, _driven(bound, outputs), means))


def _held_at(
    bound: BoundPlant, held: Sequence[str], means: Mapping[str, float]
) -> tuple[tuple[int, ...], tuple[float, ...]]:
    """Places of the outputs and their means; raises BadInput where the plant does not rest with them there."""
    places = tuple(list(map(str, bound.model.outputs)).index(output) for output in held)
    values = tuple(means[output] for output in held)
    rest_with(bound, places, values)
    return places, values


def _driven(bound: BoundPlant, outputs: Sequence[str]) -> list[str]:
    """Outputs that the inputs can hold: those of the loops, or where none are named as many as there are inputs."""
    if bound.plant.design:
        return [loop.output for loop in read_settings(bound).loops]
    return list(outputs[: len(bound.model.inputs)])
