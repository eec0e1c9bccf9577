"""What no model could better: the errors of predictions that a sensor's own error and the noise leave which a hypothesis supposes.

An axis is free, pushed by white noise q and by a torque that comes and goes, an acceleration a of standard deviation s and correlation
time T; it is read every h with variance r:

    x'' = a + white q,   a' = -a / T + white 2 s^2 / T,   R = r h

What a filter knows of (x, v, a) has the covariance P of its steady state (the algebraic Riccati equation: Bar-Shalom, Li and Kirubarajan,
Estimation with Applications to Tracking and Navigation, 2001, section 8.2). A time tau ahead, with theta = tau / T,

    attainable^2 = r + c P c^T + q tau^3 / 3 + s^2 T^4 (2 theta^3 / 3 - theta^2 + 2 - 2 (1 + theta) e^-theta - m^2)
    c = (1, tau, T^2 m),   m = theta - 1 + e^-theta

of a measured state that is no axis', r + (q R)^(1/2) + q tau.
"""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_continuous_are

from diagnosis.detect.signals import value_of
from diagnosis.filter.filter_input import variance_stated
from diagnosis.hypothesis.case import Case, FilteredLog
from diagnosis.hypothesis.hypothesis import Hypothesis, noise_on
from sim.effect import Role

Array = NDArray[np.float64]
Push = tuple[float, float]  # standard deviation of an acceleration, its correlation time in s
NO_PUSH: Push = (0.0, 1.0)


def attainable(case: Case, flight: FilteredLog, hypothesis: Hypothesis, horizons_s: Array) -> Array:
    """Mean squares (horizons, outputs), in squares of the outputs' units, at the middle of each horizon, which ends at one of `horizons_s`
    and begins at the last one's end.

    Every axis is taken as free, with the inertia that it has where the log begins: one that springs or brakes could be predicted better.
    """
    library, model = case.library, case.library.bound.model
    tau = 0.5 * (np.append(0.0, horizons_s[:-1]) + horizons_s)
    axes = {str(axis.position): place for place, axis in enumerate(model.axes)}
    states = {state: 10.0 ** (2.0 * level) for state, level in hypothesis.state_noise.items()}
    coarse = coarse_steps(case, hypothesis)
    found = np.empty((len(tau), len(model.outputs)))
    for place, (name, expression) in enumerate(model.outputs.items()):
        errors = hypothesis.reading_noise.get(name)
        r = float(flight.filter_input.single[library.outputs.index(name)])
        r = r if errors is None else variance_stated(library.bound.plant, name)
        r = max(r if np.isfinite(r) else 0.0, coarse.get(name, 0.0) ** 2 / 12.0, 1e-30)
        own = r if errors is None else r + errors.sd**2
        if (axis := axes.get(str(expression))) is not None:
            q = float(10.0 ** (2.0 * hypothesis.process_noise[axis]))
            moved = of_an_axis(q, _push(case, flight, hypothesis, axis), r * flight.step_s, tau)
        else:
            drift = states.get(str(expression), 0.0)
            moved = np.sqrt(drift * r * flight.step_s) + drift * tau
        found[:, place] = own + moved
    return found


def of_an_axis(q: float, push: Push, R: float, tau: Array) -> Array:
    """The variance (k,), in rad^2, of where an axis is `tau` (k,) s ahead: of what a filter knows, and of what noise does until then.

    `q` is white noise on its speed in rad^2/s^3, `push` in rad/s^2 and s, `R` the variance of readings times their spacing in rad^2 s, more
    than 0; of an axis that slides, m in place of rad.
    """
    s, T = push
    theta = tau / T
    m = theta + np.expm1(-theta)
    c = np.stack([np.ones_like(tau), tau, T**2 * m])
    came = s**2 * T**4 * (2.0 * theta**3 / 3.0 - theta**2 + 2.0 - 2.0 * (1.0 + theta) * np.exp(-theta) - m**2)
    known = np.einsum("ik,ij,jk->k", c, _known(q, push, R), c)
    return np.asarray(known + q * tau**3 / 3.0 + np.maximum(came, 0.0))


def _known(q: float, push: Push, R: float) -> Array:
    """P (3, 3), in units in which R is 1 and white noise of the whole strength would be: else numbers of twenty decades meet."""
    s, T = push
    whole = q + 2.0 * s**2 * T
    rate = (whole / R) ** 0.25
    length = np.sqrt(R * rate)
    units = length * rate ** np.arange(3.0)
    A = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0 / (T * rate)]])
    Q = np.diag([0.0, q / whole, 2.0 * (s / units[2]) ** 2 / (T * rate)])
    C = np.array([[1.0], [0.0], [0.0]])
    return np.asarray(solve_continuous_are(A.T, C, Q, np.eye(1)) * np.outer(units, units))


def _push(case: Case, flight: FilteredLog, hypothesis: Hypothesis, axis: int) -> Push:
    """The torque that comes and goes on an axis, as an acceleration where the log begins."""
    gust = noise_on(case, axis)
    if gust is None or gust.name not in hypothesis.effects:
        return NO_PUSH
    model, values = case.library.bound.model, hypothesis.effects[gust.name]
    x, u = flight.x0[None, : len(model.states)], flight.filter_input.u[:1]
    (inertia,) = value_of(model, model.axes[axis].inertia, np.zeros(1), x, u, case.library.bound.p)
    return values[gust.symbol(Role.STRENGTH)] / abs(float(inertia)), values[gust.symbol(Role.MEMORY)]


def coarse_steps(case: Case, hypothesis: Hypothesis) -> Mapping[str, float]:
    """The steps of the sensors that a hypothesis takes to be coarse, by output, in its unit."""
    effects, sensors = case.library.effects, case.library.bound.model.places.sensors
    return {
        sensors[effects[name].place].output: values[effects[name].symbol(Role.STEP)]
        for name, values in hypothesis.effects.items()
        if effects[name].shown_in_readings
    }
