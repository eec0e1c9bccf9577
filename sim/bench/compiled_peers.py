"""The closed loop in tools that compile plant and law together: CasADi, numba and diffrax, each where it is installed."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import sympy

from sim.bench.peers import Peer, Task, Work, module, smooth_rates, symbolic_rates
from sim.bench.plain_law import LAW_STATES, law_start, law_step
from toolchain.host import FAST_FLAGS, CText, build_shared


def _measured(task: Task, floor: Callable[[Any], Any], x: Any) -> list[Any]:
    """What the encoders read."""
    return [
        floor(x[row] / step + 0.5) * step for row, step in zip(task.output_rows, task.bound.encoder_steps, strict=True)
    ]


def _moved(x: Any, k: Any, h_s: float) -> list[Any]:
    return [x[i] + h_s * k[i] for i in range(len(k))]


def sample_step(task: Task, ops: Any, rates: Callable[..., Any]) -> Callable[..., Any]:
    """One sample, quantise, law, RK4: (x, law state, reference) -> (x, law state) on any tool's scalars."""
    h_s = task.period_s

    def step(x: Any, state: Any, reference: Any) -> tuple[list[Any], list[Any]]:
        state, u = law_step(task.table, ops, state, reference, _measured(task, ops.floor, x))
        k1 = rates(*x, *u)
        k2 = rates(*_moved(x, k1, h_s / 2), *u)
        k3 = rates(*_moved(x, k2, h_s / 2), *u)
        k4 = rates(*_moved(x, k3, h_s), *u)
        return _moved(x, [k1[i] + 2 * (k2[i] + k3[i]) + k4[i] for i in range(len(k1))], h_s / 6), state

    return step


def _casadi(task: Task) -> Work | None:
    """The sample as a CasADi function, accumulated over the run, as the C that CasADi generates."""
    casadi = module("casadi")
    if casadi is None:
        return None

    class Ops:
        minimum, maximum, floor = casadi.fmin, casadi.fmax, casadi.floor

    names = {name: getattr(casadi, name) for name in ("sin", "cos", "tanh", "sign")} | {"Abs": casadi.fabs}
    model, piece = task.bound.model, task.piece
    size, samples = len(model.states), piece.t_s.size - 1
    both, reference = casadi.SX.sym("both", size + 2 * LAW_STATES), casadi.SX.sym("r", 2)
    arguments = [*model.states, *model.inputs]
    rates = sympy.lambdify(arguments, tuple(smooth_rates(task.bound)), modules=[names], cse=True)
    step = sample_step(task, Ops, rates)
    x, state = step(casadi.vertsplit(both[:size]), casadi.vertsplit(both[size:]), casadi.vertsplit(reference))
    loop = casadi.Function("sample", [both, reference], [casadi.vertcat(*x, *state)]).mapaccum("loop", samples)
    generated = casadi.CodeGenerator("loop.c")
    generated.add(loop)
    path = build_shared("casadi-loop", [CText("loop.c", generated.dump())], flags=FAST_FLAGS)
    compiled = casadi.external("loop", str(path))
    start, references = np.concatenate([piece.x0, law_start(task.bound, piece)]), piece.reference_rad[:-1].T.copy()

    def work() -> list[float]:
        every = compiled(start, references)
        return [float(every[row, -1]) for row in task.output_rows]

    return work


def _numba(task: Task) -> Work | None:
    """Plant and law as scalar functions that numba compiles; states travel as tuples, and no quotient is looked at for a divisor of 0."""
    numba = module("numba")
    if numba is None:
        return None

    class Ops:
        minimum, maximum = sympy.Min, sympy.Max

    compile_ = numba.njit(error_model="numpy")  # an eighth faster than with Python's

    def compiled(arguments: Any, results: Any) -> Any:
        return compile_(sympy.lambdify(arguments, tuple(results), modules="math", cse=True))

    bound, piece = task.bound, task.piece
    x, own, k = bound.model.states, sympy.symbols(f"l:{2 * LAW_STATES}"), sympy.symbols(f"k:{len(bound.model.states)}")
    r, y, h = sympy.symbols("r:2"), sympy.symbols("y:2"), sympy.Symbol("h")
    state, u = law_step(task.table, Ops, own, r, y)
    law, moved = compiled([*r, *y, *own], [*u, *state]), compiled([h, *x, *k], _moved(x, k, h))
    rates = compiled([*x, *bound.model.inputs], smooth_rates(bound))
    measured, h_s = compiled(x, _measured(task, sympy.floor, x)), task.period_s

    @compile_
    def fly(x, own, references):  # type: ignore[no-untyped-def]
        for k in range(len(references) - 1):
            result = law(references[k, 0], references[k, 1], *(measured(*x) + own))
            u, own = result[:2], result[2:]
            k1 = rates(*(x + u))
            k2 = rates(*(moved(h_s / 2, *(x + k1)) + u))
            k3 = rates(*(moved(h_s / 2, *(x + k2)) + u))
            k4 = rates(*(moved(h_s, *(x + k3)) + u))
            outer, inner = moved(1.0, *(k1 + k4)), moved(1.0, *(k2 + k3))
            x = moved(h_s / 6, *(x + moved(2.0, *(outer + inner))))
        return x

    start, law_state = tuple(piece.x0.tolist()), tuple(law_start(bound, piece).tolist())

    def work() -> list[float]:
        end = fly(start, law_state, piece.reference_rad)
        return [end[row] for row in task.output_rows]

    return work


def _diffrax(task: Task) -> Work | None:
    """Tsit5 with adaptive steps within each sample, the samples in a compiled scan."""
    fly = _diffrax_flight(task)
    return None if fly is None else lambda: fly(task.bound.p)


def _diffrax_batch(task: Task) -> Work | None:
    """The same for all parameter sets at once, by JAX's vectorising map."""
    jax, fly = module("jax"), _diffrax_flight(task)
    if fly is None:
        return None
    together = jax.jit(jax.vmap(fly))
    return lambda: together(task.p)


def _diffrax_flight(task: Task) -> Callable[[Any], Any] | None:
    """The outputs at the end of the task as a compiled function of the parameters."""
    jax, diffrax = module("jax"), module("diffrax")
    if jax is None or diffrax is None:
        return None
    jax.config.update("jax_enable_x64", True)
    jnp, model, h_s = jax.numpy, task.bound.model, task.period_s
    arguments = [*model.states, *model.inputs, *model.parameter_symbols]
    rates = sympy.lambdify(arguments, tuple(symbolic_rates(model)), modules="jax", cse=True)
    term = diffrax.ODETerm(lambda t, x, given: jnp.stack(rates(*x, *given[0], *given[1])))
    control = diffrax.PIDController(rtol=1e-6, atol=1e-8)
    start = jnp.array(task.piece.x0), jnp.array(law_start(task.bound, task.piece))
    references = jnp.array(task.piece.reference_rad[:-1])

    def fly(p: Any) -> Any:
        def sample(carry: Any, reference: Any) -> Any:
            x, own = carry
            own, u = law_step(task.table, jnp, own, reference, _measured(task, jnp.floor, x))
            ends = {"t0": 0.0, "t1": h_s, "dt0": h_s}
            x = diffrax.diffeqsolve(term, diffrax.Tsit5(), y0=x, args=(u, p), stepsize_controller=control, **ends).ys[
                -1
            ]
            return (x, jnp.stack(own)), None

        (x, _), _ = jax.lax.scan(sample, start, references)
        return x[jnp.array(task.output_rows)]

    return jax.jit(fly)  # type: ignore[no-any-return]


PEERS: Mapping[str, Peer] = {
    "CasADi generated C": Peer(_casadi, "one RK4 step a sample, compiled with the kernel's flags"),
    "numba": Peer(_numba, "one RK4 step a sample"),
    "diffrax": Peer(_diffrax, "Tsit5, relative tolerance 1e-6"),
    "diffrax vmap": Peer(_diffrax_batch, "the same, all parameter sets at once", batched=True),
}
