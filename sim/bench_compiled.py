"""The closed loop in tools that compile plant and law together: CasADi, numba and diffrax, each where it is installed."""

import importlib
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import sympy

from records.table import ControllerTable
from sim.bench_law import LAW_STATES, law_start, law_step
from sim.bench_peers import Peer, Work, smooth_rates
from sim.bind import BoundPlant
from sim.loop import Controller
from sim.manoeuvres import Manoeuvre
from toolchain.host import FAST_FLAGS, CText, build_shared


def _module(name: str) -> Any:
    """A tool's module, or None where it is not installed."""
    try:
        return importlib.import_module(name)
    except ImportError:
        return None


def _rates(bound: BoundPlant, modules: Any) -> Any:
    arguments = [*bound.model.states, *bound.model.inputs]
    return sympy.lambdify(arguments, tuple(smooth_rates(bound)), modules=modules, cse=True)


def _readings(bound: BoundPlant) -> list[tuple[int, float]]:
    """State and encoder step of each output."""
    model = bound.model
    return [(model.states.index(state), bound.plant.sensors[output]) for output, state in model.outputs.items()]


def _moved(x: Any, k: Any, h_s: float) -> list[Any]:
    return [x[i] + h_s * k[i] for i in range(len(k))]


def _sample(
    bound: BoundPlant, table: ControllerTable, ops: Any, rates: Callable[..., Any], h_s: float
) -> Callable[..., Any]:
    """One sample, quantise, law, RK4: (x, law state, reference) -> (x, law state) on any tool's scalars."""

    def step(x: Any, state: Any, reference: Any) -> tuple[list[Any], list[Any]]:
        y = [ops.floor(x[row] / width + 0.5) * width for row, width in _readings(bound)]
        state, u = law_step(table, ops, state, reference, y)
        k1 = rates(*x, *u)
        k2 = rates(*_moved(x, k1, h_s / 2), *u)
        k3 = rates(*_moved(x, k2, h_s / 2), *u)
        k4 = rates(*_moved(x, k3, h_s), *u)
        return _moved(x, [k1[i] + 2 * (k2[i] + k3[i]) + k4[i] for i in range(len(k1))], h_s / 6), state

    return step


def _casadi(bound: BoundPlant, table: ControllerTable, _: Callable[[], Controller], piece: Manoeuvre) -> Work | None:
    """The sample as a CasADi function, accumulated over the run, as the C that CasADi generates."""
    casadi = _module("casadi")
    if casadi is None:
        return None

    class Ops:
        minimum, maximum, floor = casadi.fmin, casadi.fmax, casadi.floor

    names = {name: getattr(casadi, name) for name in ("sin", "cos", "tanh", "sign")} | {"Abs": casadi.fabs}
    size, samples = len(bound.model.states), piece.t_s.size - 1
    both, reference = casadi.SX.sym("both", size + 2 * LAW_STATES), casadi.SX.sym("r", 2)
    step = _sample(bound, table, Ops, _rates(bound, [names]), float(piece.t_s[1] - piece.t_s[0]))
    x, state = step(casadi.vertsplit(both[:size]), casadi.vertsplit(both[size:]), casadi.vertsplit(reference))
    loop = casadi.Function("sample", [both, reference], [casadi.vertcat(*x, *state)]).mapaccum("loop", samples)
    generated = casadi.CodeGenerator("loop.c")
    generated.add(loop)
    path = build_shared("casadi-loop", [CText("loop.c", generated.dump())], flags=FAST_FLAGS)
    compiled = casadi.external("loop", str(path))
    start, references = np.concatenate([piece.x0, law_start(bound, piece)]), piece.reference_rad[:-1].T.copy()

    def work() -> float:
        compiled(start, references)
        return float(piece.t_s[-1])

    return work


def _numba(bound: BoundPlant, table: ControllerTable, _: Callable[[], Controller], piece: Manoeuvre) -> Work | None:
    """Plant and law as scalar functions that numba compiles; states travel as tuples."""
    numba = _module("numba")
    if numba is None:
        return None

    class Ops:
        minimum, maximum = sympy.Min, sympy.Max

    def compiled(arguments: Any, results: Any) -> Any:
        return numba.njit(sympy.lambdify(arguments, tuple(results), modules="math", cse=True))

    x, own, k = bound.model.states, sympy.symbols(f"l:{2 * LAW_STATES}"), sympy.symbols(f"k:{len(bound.model.states)}")
    r, y, h = sympy.symbols("r:2"), sympy.symbols("y:2"), sympy.Symbol("h")
    state, u = law_step(table, Ops, own, r, y)
    law, moved = compiled([*r, *y, *own], [*u, *state]), compiled([h, *x, *k], _moved(x, k, h))
    rates = compiled([*x, *bound.model.inputs], smooth_rates(bound))
    measured = compiled(x, [sympy.floor(x[row] / width + 0.5) * width for row, width in _readings(bound)])
    h_s = float(piece.t_s[1] - piece.t_s[0])

    @numba.njit
    def fly(x, own, references):  # type: ignore[no-untyped-def]
        for k in range(len(references)):
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

    def work() -> float:
        fly(start, law_state, piece.reference_rad)
        return float(piece.t_s[-1])

    return work


def _diffrax(bound: BoundPlant, table: ControllerTable, _: Callable[[], Controller], piece: Manoeuvre) -> Work | None:
    """Tsit5 with adaptive steps within each sample, the samples in a compiled scan."""
    jax, diffrax = _module("jax"), _module("diffrax")
    if jax is None or diffrax is None:
        return None
    jax.config.update("jax_enable_x64", True)
    jnp, h_s = jax.numpy, float(piece.t_s[1] - piece.t_s[0])
    rates = _rates(bound, "jax")
    term = diffrax.ODETerm(lambda t, x, u: jnp.stack(rates(*x, *u)))
    control = diffrax.PIDController(rtol=1e-6, atol=1e-8)

    def sample(carry: Any, reference: Any) -> Any:
        x, own = carry
        y = [jnp.floor(x[row] / width + 0.5) * width for row, width in _readings(bound)]
        own, u = law_step(table, jnp, own, reference, y)
        ends = {"t0": 0.0, "t1": h_s, "dt0": h_s}
        x = diffrax.diffeqsolve(term, diffrax.Tsit5(), y0=x, args=u, stepsize_controller=control, **ends).ys[-1]
        return (x, jnp.stack(own)), None

    fly = jax.jit(lambda carry, references: jax.lax.scan(sample, carry, references)[0])
    carry = jnp.array(piece.x0), jnp.array(law_start(bound, piece))

    def work() -> float:
        jax.block_until_ready(fly(carry, piece.reference_rad))
        return float(piece.t_s[-1])

    return work


PEERS: Mapping[str, Peer] = {
    "CasADi generated C": Peer(_casadi, "one RK4 step a sample, compiled with the kernel's flags"),
    "numba": Peer(_numba, "one RK4 step a sample"),
    "diffrax": Peer(_diffrax, "Tsit5, relative tolerance 1e-6"),
}
