"""The closed loop in tools that call Python for the plant or the law: python-control and SciPy."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import sympy

from records.table import ControllerTable
from sim.bind import BoundPlant
from sim.loop import Controller
from sim.manoeuvres import Manoeuvre

SLIP_RAD_S = 0.005
Work = Callable[[], float]
Prepare = Callable[[BoundPlant, ControllerTable, Callable[[], Controller], Manoeuvre], Work | None]
Rates = Callable[..., Sequence[float]]


@dataclass(frozen=True)
class Peer:
    """A tool: what makes its run ready (None when it is not installed), and what it does differently."""

    prepare: Prepare
    note: str


def smooth_rates(bound: BoundPlant) -> list[sympy.Expr]:
    """dx/dt with the parameters' numbers put in and dry friction b_c tanh(v / SLIP_RAD_S), for tools without events."""
    model = bound.model
    values = dict(zip(model.parameter_symbols, bound.p.tolist(), strict=True))
    slips = {
        sign: sympy.tanh(axis.velocity / SLIP_RAD_S)
        for sign, axis in zip(model.friction_signs, model.axes, strict=True)
    }
    return [rate.subs(slips).subs(values) for rate in model.state_rates()]


def scalar_rates(bound: BoundPlant) -> Rates:
    """f(x_1, ..., x_n, u_1, ..., u_m) on plain floats, which for six states is much faster in Python than on arrays."""
    arguments = [*bound.model.states, *bound.model.inputs]
    return sympy.lambdify(arguments, smooth_rates(bound), modules="math", cse=True)  # type: ignore[no-any-return]


def _sampled(
    bound: BoundPlant,
    controller: Callable[[], Controller],
    manoeuvre: Manoeuvre,
    hold: Callable[[Any, Any, float], Any],
) -> Work:
    """A loop over the samples in Python; `hold` advances x under constant u by a time."""
    rows = [bound.model.states.index(output) for output in bound.model.outputs.values()]
    steps = [bound.plant.sensors[output] for output in bound.model.outputs]
    references, times = manoeuvre.reference_rad.tolist(), manoeuvre.t_s.tolist()

    def measured(x: Any) -> list[float]:
        return [round(x[row] / step) * step for row, step in zip(rows, steps, strict=True)]

    def work() -> float:
        law, x = controller(), manoeuvre.x0
        law.reset(*measured(x))
        for k in range(len(times) - 1):
            x = hold(x, law.step(*references[k], *measured(x)), times[k + 1] - times[k])
        return float(times[-1] - times[0])

    return work


def _solve_ivp(bound: BoundPlant, _: ControllerTable, controller: Callable[[], Controller], piece: Manoeuvre) -> Work:
    from scipy.integrate import solve_ivp

    rates = scalar_rates(bound)

    def hold(x: Any, u: Any, h_s: float) -> Any:
        return solve_ivp(lambda t, x: rates(*x, *u), (0.0, h_s), x, rtol=1e-6, atol=1e-8).y[:, -1]

    return _sampled(bound, controller, piece, hold)


def _odeint(bound: BoundPlant, _: ControllerTable, controller: Callable[[], Controller], piece: Manoeuvre) -> Work:
    from scipy.integrate import odeint

    rates = scalar_rates(bound)

    def hold(x: Any, u: Any, h_s: float) -> Any:
        return odeint(lambda x, t: rates(*x, *u), x, [0.0, h_s], rtol=1e-6, atol=1e-8)[-1]

    return _sampled(bound, controller, piece, hold)


def _python_rk4(bound: BoundPlant, _: ControllerTable, controller: Callable[[], Controller], piece: Manoeuvre) -> Work:
    return _sampled(bound, controller, piece, rk4_hold(scalar_rates(bound)))


def rk4_hold(rates: Rates) -> Callable[[Any, Any, float], list[float]]:
    """One Runge-Kutta step on plain floats."""

    def hold(x: Any, u: Any, h_s: float) -> list[float]:
        k1 = rates(*x, *u)
        k2 = rates(*[a + h_s / 2 * k for a, k in zip(x, k1, strict=True)], *u)
        k3 = rates(*[a + h_s / 2 * k for a, k in zip(x, k2, strict=True)], *u)
        k4 = rates(*[a + h_s * k for a, k in zip(x, k3, strict=True)], *u)
        return [a + h_s / 6 * (p + 2 * (q + r) + s) for a, p, q, r, s in zip(x, k1, k2, k3, k4, strict=True)]

    return hold


def _python_control(
    bound: BoundPlant, _: ControllerTable, controller: Callable[[], Controller], piece: Manoeuvre
) -> Work:
    """Plant and law as two systems at the sample period, interconnected; the law, which has memory of its own, as an output map."""
    import control

    hold, model = rk4_hold(scalar_rates(bound)), bound.model
    period_s = float(piece.t_s[1] - piece.t_s[0])
    rows = [model.states.index(output) for output in model.outputs.values()]
    inputs, outputs = [str(variable) for variable in model.inputs], list(model.outputs)
    plant = control.nlsys(
        lambda t, x, u, params: np.array(hold(x.tolist(), u.tolist(), period_s)),
        lambda t, x, u, params: x[rows],
        inputs=inputs, outputs=outputs, states=len(model.states), dt=period_s, name="plant",
    )  # fmt: skip
    references = [f"{output}_wanted" for output in outputs]
    steps = np.array([bound.plant.sensors[output] for output in outputs])

    def work() -> float:
        law = controller()
        law.reset(*(np.round(piece.x0[rows] / steps) * steps).tolist())
        memory: dict[float, tuple[float, float]] = {}  # the solver asks for the outputs of one instant more than once

        def command(t: float, _x: Any, u: Any, _params: Any) -> np.ndarray:
            if t not in memory:
                y = np.round(u[len(outputs) :] / steps) * steps
                memory[t] = law.step(*u[: len(outputs)].tolist(), *y.tolist())
            return np.array(memory[t])

        system = control.nlsys(None, command, inputs=[*references, *outputs], outputs=inputs, dt=period_s, name="law")
        loop = control.interconnect([plant, system], inputs=references, outputs=outputs)
        control.input_output_response(loop, piece.t_s, piece.reference_rad.T, piece.x0)
        return float(piece.t_s[-1])

    return work


PEERS: Mapping[str, Peer] = {
    "python-control interconnect": Peer(_python_control, "one RK4 step a sample in Python"),
    "SciPy solve_ivp per sample": Peer(_solve_ivp, "RK45, relative tolerance 1e-6"),
    "SciPy odeint per sample": Peer(_odeint, "LSODA, relative tolerance 1e-6"),
    "plain Python": Peer(_python_rk4, "one RK4 step a sample"),
}
