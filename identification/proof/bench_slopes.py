"""The bench's fit in tools that differentiate the simulation themselves, CasADi and JAX, each where it is installed.

Dry friction is b_c tanh(v / SLIP_RAD_S) in both, as neither has events; one RK4 step a sample, slopes by the tool's forward mode.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import sympy
from numpy.typing import NDArray
from scipy.optimize import least_squares

from sim.bench.peers import module, symbolic_rates
from sim.bind import BoundPlant

Array = NDArray[np.float64]
MOST_RUNS = 100
MOST_OFF = 5.0  # times the start
LOST_RESIDUAL, LOST_SLOPE = 1e3, 1e6  # of a run that leaves all bounds, as neither simulation has stops


@dataclass(frozen=True, eq=False)
class FitProblem:
    """What is fitted: y (n, outputs) under u (n, inputs) held from row to row of `period_s`, from x0 (states,), all in SI.

    The coefficients `places` of p begin at `start`; all others are known.
    """

    bound: BoundPlant
    period_s: float
    u: Array
    y: Array
    x0: Array
    places: Sequence[int]
    start: Array

    @property
    def rows(self) -> list[int]:
        """Place of each output among the states."""
        return [self.bound.model.states.index(output) for output in self.bound.model.outputs.values()]

    def rates(self, modules: Any) -> Any:
        """dx/dt as a function of a tool's states, inputs and fitted coefficients, with the numbers of all others put in."""
        model = self.bound.model
        symbols = list(model.parameter_symbols)
        fitted = [symbols[place] for place in self.places]
        known = {s: v for s, v in zip(symbols, self.bound.p.tolist(), strict=True) if s not in fitted}
        expressions = tuple(rate.subs(known) for rate in symbolic_rates(model))
        return sympy.lambdify([*model.states, *model.inputs, *fitted], expressions, modules=modules, cse=True)


Fitted = Callable[[], Array]  # the coefficients (k,) after a fit
Slopes = tuple[
    Callable[[Array], Array], Callable[[Array], Array]
]  # residuals (rows,) and their slopes (rows, k) by relative coefficients


def jax_fit(flight: FitProblem) -> Fitted | None:
    """A compiled scan over the samples and its forward-mode Jacobian; None where JAX is not installed."""
    jax = module("jax")
    if jax is None:
        return None
    jax.config.update("jax_enable_x64", True)
    jnp, rates, rows = jax.numpy, flight.rates("jax"), np.array(flight.rows)

    def residual(relative: Any) -> Any:
        p = relative * flight.start

        def sample(x: Any, u: Any) -> Any:
            x = _rk4(lambda at: jnp.stack(rates(*at, *u, *p)), x, flight.period_s)
            return x, x[rows]

        _, y = jax.lax.scan(sample, jnp.array(flight.x0), jnp.array(flight.u[:-1]))
        return (y - flight.y[1:]).ravel()

    return _fit(flight, (jax.jit(residual), jax.jit(jax.jacfwd(residual))))


def casadi_fit(flight: FitProblem) -> Fitted | None:
    """The sample as a CasADi function, accumulated over the run, with its forward sensitivities, on CasADi's virtual machine.

    None where CasADi is not installed.
    """
    casadi = module("casadi")
    if casadi is None:
        return None
    names = {name: getattr(casadi, name) for name in ("sin", "cos", "tanh", "sign")} | {"Abs": casadi.fabs}
    model, rates = flight.bound.model, flight.rates([names])
    relative = casadi.SX.sym("relative", len(flight.places))
    p = casadi.vertsplit(relative * flight.start)
    x, u = casadi.SX.sym("x", len(model.states)), casadi.SX.sym("u", len(model.inputs))

    def slopes_at(at: Any) -> Any:
        return casadi.vertcat(*rates(*casadi.vertsplit(at), *casadi.vertsplit(u), *p))

    after = _rk4(slopes_at, x, flight.period_s)
    step = casadi.Function("step", [x, u, relative], [after])
    S = casadi.SX.sym("S", len(model.states), len(flight.places))
    moved = casadi.jtimes(after, x, S) + casadi.jacobian(after, relative)
    # State and sensitivities side by side: one column each, accumulated together.
    both = casadi.Function("both", [casadi.horzcat(x, S), u, relative], [casadi.horzcat(after, moved)])
    samples, width = len(flight.u) - 1, 1 + len(flight.places)
    run, run_slopes = step.mapaccum("run", samples), both.mapaccum("run_slopes", samples)
    inputs, rows = flight.u[:-1].T, flight.rows
    start = np.hstack([flight.x0[:, None], np.zeros((len(model.states), len(flight.places)))])

    def residual(relative: Array) -> Array:
        given = np.tile(relative[:, None], samples)
        return np.asarray((np.asarray(run(flight.x0, inputs, given)).T[:, rows] - flight.y[1:]).ravel())

    def slopes(relative: Array) -> Array:
        given = np.tile(relative[:, None], samples)
        every = np.asarray(run_slopes(start, inputs, given)).reshape(len(model.states), samples, width)
        return np.asarray(every[rows, :, 1:].transpose(1, 0, 2).reshape(-1, width - 1))

    return _fit(flight, (residual, slopes))


def _fit(flight: FitProblem, of: Slopes) -> Fitted:
    """SciPy's trust region on the tool's residuals and slopes, everything compiled before."""
    residual, slopes = of
    first = np.ones(len(flight.places))
    residual(first), slopes(first)

    def work() -> Array:
        found = least_squares(
            lambda relative: np.clip(
                np.nan_to_num(np.asarray(residual(relative)), nan=LOST_RESIDUAL), -LOST_RESIDUAL, LOST_RESIDUAL
            ),
            first,
            jac=lambda relative: np.clip(np.nan_to_num(np.asarray(slopes(relative))), -LOST_SLOPE, LOST_SLOPE),
            bounds=(1.0 / MOST_OFF, MOST_OFF),
            method="trf",
            max_nfev=MOST_RUNS,
        )
        return np.asarray(found.x * flight.start)

    return work


def _rk4(rates: Callable[[Any], Any], x: Any, h: float) -> Any:
    k1 = rates(x)
    k2 = rates(x + 0.5 * h * k1)
    k3 = rates(x + 0.5 * h * k2)
    k4 = rates(x + h * k3)
    return x + h / 6.0 * (k1 + 2.0 * (k2 + k3) + k4)
