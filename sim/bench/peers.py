"""The closed loop in tools that call Python for the plant or the law: python-control and SciPy."""

import importlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import sympy
from numpy.typing import NDArray

from records.table import ControllerTable
from sim.bench.plain_law import LAW_STATES, PlainNumbers, law_start, law_step
from sim.bind import BoundPlant
from sim.loop import Controller
from sim.manoeuvres import Manoeuvre
from sim.model import Model

SLIP_RAD_S = 0.005
Array = NDArray[np.float64]
Rates = Callable[..., Sequence[float]]
Work = Callable[
    [], Any
]  # flies the task once; the outputs' true values at its end, shape (outputs,) or (runs, outputs)


@dataclass(frozen=True, eq=False)
class Task:
    """What every tool flies: `piece` under the law of `table`, which `controller` makes for tools that call Python.

    A tool that flies many runs at once takes the parameter sets `p` (runs, k), any other the plant's own.
    """

    bound: BoundPlant
    table: ControllerTable
    controller: Callable[[], Controller]
    piece: Manoeuvre
    p: Array

    @property
    def output_rows(self) -> list[int]:
        """Place of each output among the states."""
        return [self.bound.model.states.index(output) for output in self.bound.model.outputs.values()]

    @property
    def period_s(self) -> float:
        """Time from sample to sample."""
        return float(self.piece.t_s[1] - self.piece.t_s[0])


@dataclass(frozen=True)
class Peer:
    """A tool: what makes its run ready (None when it is not installed), what it does differently, whether it flies all runs at once."""

    prepare: Callable[[Task], Work | None]
    note: str
    batched: bool = False


def module(name: str) -> Any:
    """A tool's module, or None where it is not installed."""
    try:
        return importlib.import_module(name)
    except ImportError:
        return None


def symbolic_rates(model: Model) -> list[sympy.Expr]:
    """dx/dt with dry friction b_c tanh(v / SLIP_RAD_S), for tools without events."""
    slips = {
        sign: sympy.tanh(axis.velocity / SLIP_RAD_S)
        for sign, axis in zip(model.friction_signs, model.axes, strict=True)
    }
    return [rate.subs(slips) for rate in model.state_rates()]


def smooth_rates(bound: BoundPlant) -> list[sympy.Expr]:
    """The same with the parameters' numbers put in."""
    values = dict(zip(bound.model.parameter_symbols, bound.p.tolist(), strict=True))
    return [rate.subs(values) for rate in symbolic_rates(bound.model)]


def scalar_rates(bound: BoundPlant) -> Rates:
    """f(x_1, ..., x_n, u_1, ..., u_m) on plain floats, which for six states is much faster in Python than on arrays."""
    arguments = [*bound.model.states, *bound.model.inputs]
    return sympy.lambdify(arguments, smooth_rates(bound), modules="math", cse=True)  # type: ignore[no-any-return]


def _sampled(task: Task, hold: Callable[[Any, Any, float], Any]) -> Work:
    """A loop over the samples in Python; `hold` advances x under constant u by a time."""
    rows, steps = task.output_rows, task.bound.encoder_steps
    references, times = task.piece.reference_rad.tolist(), task.piece.t_s.tolist()

    def measured(x: Any) -> list[float]:
        return [round(x[row] / step) * step for row, step in zip(rows, steps, strict=True)]

    def work() -> list[float]:
        law, x = task.controller(), task.piece.x0
        law.reset(*measured(x))
        for k in range(len(times) - 1):
            x = hold(x, law.step(*references[k], *measured(x)), times[k + 1] - times[k])
        return [x[row] for row in rows]

    return work


def _solve_ivp(task: Task) -> Work:
    from scipy.integrate import solve_ivp

    rates = scalar_rates(task.bound)

    def hold(x: Any, u: Any, h_s: float) -> Any:
        return solve_ivp(lambda t, x: rates(*x, *u), (0.0, h_s), x, rtol=1e-6, atol=1e-8).y[:, -1]

    return _sampled(task, hold)


def _odeint(task: Task) -> Work:
    from scipy.integrate import odeint

    rates = scalar_rates(task.bound)

    def hold(x: Any, u: Any, h_s: float) -> Any:
        return odeint(lambda x, t: rates(*x, *u), x, [0.0, h_s], rtol=1e-6, atol=1e-8)[-1]

    return _sampled(task, hold)


def _python_rk4(task: Task) -> Work:
    return _sampled(task, rk4_hold(scalar_rates(task.bound)))


def rk4_hold(rates: Rates) -> Callable[[Any, Any, float], list[float]]:
    """One Runge-Kutta step on plain floats."""

    def hold(x: Any, u: Any, h_s: float) -> list[float]:
        k1 = rates(*x, *u)
        k2 = rates(*[a + h_s / 2 * k for a, k in zip(x, k1, strict=True)], *u)
        k3 = rates(*[a + h_s / 2 * k for a, k in zip(x, k2, strict=True)], *u)
        k4 = rates(*[a + h_s * k for a, k in zip(x, k3, strict=True)], *u)
        return [a + h_s / 6 * (p + 2 * (q + r) + s) for a, p, q, r, s in zip(x, k1, k2, k3, k4, strict=True)]

    return hold


def _python_control(task: Task) -> Work:
    """Plant and law as two systems at the sample period, interconnected; the solver asks for the law's outputs as often as it likes."""
    import control

    hold, model, piece = rk4_hold(scalar_rates(task.bound)), task.bound.model, task.piece
    rows, steps = task.output_rows, np.array(task.bound.encoder_steps)
    inputs, outputs = [str(variable) for variable in model.inputs], list(model.outputs)
    references = [f"{output}_wanted" for output in outputs]

    def advance(t: float, x: Any, u: Any, params: Any) -> Any:
        return np.array(hold(x.tolist(), u.tolist(), task.period_s))

    def law(x: Any, u: Any) -> tuple[list[float], list[float]]:
        y = np.round(u[len(outputs) :] / steps) * steps
        return law_step(task.table, PlainNumbers, x.tolist(), u[: len(outputs)].tolist(), y.tolist())

    def remember(t: float, x: Any, u: Any, params: Any) -> Any:
        return np.array(law(x, u)[0])

    def command(t: float, x: Any, u: Any, params: Any) -> Any:
        return np.array(law(x, u)[1])

    clock = {"dt": task.period_s}
    plant = control.nlsys(
        advance, lambda t, x, u, params: x[rows],
        inputs=inputs, outputs=outputs, states=len(model.states), name="plant", **clock,
    )  # fmt: skip
    controller = control.nlsys(
        remember, command, inputs=[*references, *outputs], outputs=inputs, states=2 * LAW_STATES, name="law", **clock
    )
    loop = control.interconnect([plant, controller], inputs=references, outputs=outputs)
    start = [piece.x0, law_start(task.bound, piece)]
    return lambda: control.input_output_response(loop, piece.t_s, piece.reference_rad.T, start).outputs[:, -1]


PEERS: Mapping[str, Peer] = {
    "python-control interconnect": Peer(_python_control, "one RK4 step a sample in Python"),
    "SciPy solve_ivp per sample": Peer(_solve_ivp, "RK45, relative tolerance 1e-6"),
    "SciPy odeint per sample": Peer(_odeint, "LSODA, relative tolerance 1e-6"),
    "plain Python": Peer(_python_rk4, "one RK4 step a sample"),
}
