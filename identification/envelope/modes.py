"""The slow oscillations of the models, phugoid and Dutch roll, beside those of the exact derivatives where these are known."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from identification.envelope.flights.conditions import Condition
from identification.envelope.state_equation.free_run import Model
from identification.envelope.study import Study

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
PHUGOID, DUTCH_ROLL = "phugoid", "Dutch roll"
SLOWEST_rad_s = 0.1  # below it an eigenvalue is a mode without oscillation


@dataclass(frozen=True)
class Mode:
    """One oscillation of one condition, all in rad/s: that of the model, of the least squares it began with (None of a condition left
    out), and of the exact derivatives (None where nobody knows them)."""

    condition: Condition
    name: str
    left_out: bool
    model: complex
    least_squares: complex | None
    truth: complex | None

    def off(self, found: complex | None) -> float | None:
        """Distance of what was found from the truth, over the truth's modulus."""
        return None if found is None or self.truth is None else abs(found - self.truth) / abs(self.truth)


def modes_of(found: Study, exact: Callable[[Condition], Model] | None = None) -> tuple[Mode, ...]:
    """Both modes of every condition; `exact` gives the exact model of one."""
    models = [(entry.condition, False, entry.model.state, entry.open_loop) for entry in found.conditions]
    others = [(entry.condition, True, entry.model.state, None) for entry in found.left_out]
    return tuple(
        mode
        for condition, left_out, model, first in [*models, *others]
        for mode in _modes(condition, left_out, model, first, None if exact is None else exact(condition))
    )


def _modes(
    condition: Condition, left_out: bool, model: Model, first: Model | None, exact: Model | None
) -> Iterator[Mode]:
    for name, sought in _named(model if exact is None else exact).items():
        yield Mode(
            condition,
            name,
            left_out,
            _nearest(model, sought),
            None if first is None else _nearest(first, sought),
            None if exact is None else sought,
        )


def _named(model: Model) -> dict[str, complex]:
    """The slowest oscillation and the fastest one; none of a model without oscillations."""
    found = _oscillations(model)
    if not found.size:
        return {}
    return {PHUGOID: complex(found[np.argmin(np.abs(found))]), DUTCH_ROLL: complex(found[np.argmax(found.imag)])}


def _nearest(model: Model, sought: complex) -> complex:
    """The eigenvalue of the upper half plane that is nearest, oscillating or not."""
    every = eigenvalues_rad_s(model)
    upper = every[every.imag >= 0.0]
    return complex(upper[np.argmin(np.abs(upper - sought))])


def _oscillations(model: Model) -> Complex:
    found = eigenvalues_rad_s(model)
    return np.asarray(found[found.imag > SLOWEST_rad_s])


def eigenvalues_rad_s(model: Model) -> Complex:
    """Of the motion in continuous time."""
    return np.asarray(np.log(np.linalg.eigvals(model.A).astype(complex)) / model.sample_period_s)
