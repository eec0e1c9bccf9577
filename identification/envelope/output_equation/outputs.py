"""Linear accelerations from states and controls in three ways (seed 003, chapter 3): classical, linear, fuzzy.

All take and give deviations from the trim of their flight. The chapter itself is not part of the text that we have: its headings and
the abstract tell the three ways, and that random effects of the measurement spoil the classical one.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.signal import savgol_filter

from identification.envelope.flights.flight import Deviations, GRAVITY_m_s2
from identification.envelope.output_equation.fuzzy import Fuzzy, Trained, fuzzy

Array = NDArray[np.float64]
METHODS = ("classical", "linear", "fuzzy")
# Rows of a parabola through measured velocities, whose slope is their derivative; the ends are held beyond the record.
SLOPE_ROWS = 9

Equation = Callable[[Deviations, Array], Array]
"""(flights, states x of them (flights, n, 8), measured or estimated) -> accelerations (flights, n, 3)."""


@dataclass(frozen=True, eq=False)
class Linear:
    """y = C x + D u, C (3, 8) and D (3, 4)."""

    C: Array
    D: Array

    def __call__(self, data: Deviations, x: Array) -> Array:
        """Accelerations (flights, n, 3)."""
        return np.asarray(x @ self.C.T + data.u @ self.D.T)


@dataclass(frozen=True, eq=False)
class Nonlinear:
    """The fuzzy system of states and controls."""

    system: Fuzzy

    def __call__(self, data: Deviations, x: Array) -> Array:
        """Accelerations (flights, n, 3)."""
        inputs = np.concatenate([x, data.u], axis=2)
        return self.system(inputs.reshape(-1, inputs.shape[2])).reshape(*x.shape[:2], -1)


def classical(data: Deviations, x: Array) -> Array:
    """Equations of motion of the centre of gravity, less their own value in the quiet first seconds' mean state.

    A_x = du/dt + q w - r v + g sin(theta)
    A_y = dv/dt + r u - p w - g cos(theta) sin(phi)
    A_z = dw/dt + p v - q u - g cos(theta) cos(phi)
    The derivative is the slope of a parabola through `SLOPE_ROWS` rows. They hold at the centre of gravity: that the accelerometer
    sits elsewhere, they do not know.
    """
    trim = data.trim[:, None, 4:12]
    slope = savgol_filter(x[:, :, :3], SLOPE_ROWS, 2, deriv=1, delta=data.sample_period_s, axis=1, mode="nearest")
    return np.asarray(slope + _turning(x + trim) - _turning(trim))


def _turning(x: Array) -> Array:
    """What the equations hold besides the derivative, from whole states."""
    u, v, w, p, q, r, phi, theta = np.moveaxis(x, -1, 0)
    g = GRAVITY_m_s2
    return np.stack(
        [
            q * w - r * v + g * np.sin(theta),
            r * u - p * w - g * np.cos(theta) * np.sin(phi),
            p * v - q * u - g * np.cos(theta) * np.cos(phi),
        ],
        axis=-1,
    )


def linear(data: Deviations) -> Linear:
    """C and D by least squares over measured states."""
    rows = np.concatenate([data.x, data.u], axis=2).reshape(data.count, -1)
    CD = np.linalg.lstsq(rows, data.y.reshape(data.count, -1), rcond=None)[0].T
    states = data.x.shape[2]
    return Linear(CD[:, :states], CD[:, states:])


def nonlinear(data: Deviations, margins: Array) -> Trained:
    """The fuzzy system trained on measured states; errors count in margins (3,)."""
    rows = np.concatenate([data.x, data.u], axis=2).reshape(data.count, -1)
    return fuzzy(rows, data.y.reshape(data.count, -1), margins)


def equations(data: Deviations, margins: Array) -> tuple[Mapping[str, Equation], Trained]:
    """The three output equations of one condition from its flights, and the fuzzy one's training."""
    trained = nonlinear(data, margins)
    return {"classical": classical, "linear": linear(data), "fuzzy": Nonlinear(trained.system)}, trained
