"""Runs of a plant whose inputs or outputs pass stages with memory on their way."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from records.errors import BadInput
from sim.bind import BoundPlant
from sim.kernel.kernel import kernel
from sim.kernel.law import law_struct
from sim.kernel.reading import reading
from sim.paths.path import Held, Trace, in_steps, passed
from sim.runs.compiled_run import Array, CController, Conditions, Drive, Runs, filled, run_equations
from sim.runs.stepped import SteppedPlant


@dataclass(frozen=True, eq=False)
class Arriving:
    """Inputs as they arrive: `u` (n, inputs) held from t_s (n,) on; `rows` are the places of the log's own samples in t_s."""

    t_s: Array
    u: Array
    rows: NDArray[np.intp]


def arriving(bound: BoundPlant, t_s: ArrayLike, u: ArrayLike) -> Arriving:
    """What arrives of the commands u (n, inputs), held from t_s (n,) on, with every instant at which it changes."""
    times, commands = np.asarray(t_s, dtype=float), np.asarray(u, dtype=float)
    if not bound.input_path:
        return Arriving(times, commands, np.arange(len(times)))
    end_s = times[-1] + (times[-1] - times[-2] if len(times) > 1 else 1.0)
    held, _ = passed(bound.input_path, Held(np.append(times, end_s), commands))
    rows = np.searchsorted(held.edges_s, times)
    count = rows[-1] + 1
    return Arriving(held.edges_s[:count], held.values[:count], rows)


def readings(bound: BoundPlant, t_s: Array, x: Array, p: Array) -> Array:
    """What arrives of the outputs (n, outputs) of the states x (n, states) at t_s (n,), before the encoders' steps."""
    y, rate = reading(bound.model)(t_s, x, p)
    for output in sorted({stage.output for stage in bound.output_path}):
        stages = [stage for stage in bound.output_path if stage.output == output]
        y[:, output] = passed(stages, Trace(t_s, y[:, output], rate[:, output]))[0].y
    return y


def run_open(bound: BoundPlant, t_s: ArrayLike, x0: Array, drive: Array, under: Conditions) -> Runs:
    """A run with given inputs (n, inputs) or (runs, n, inputs); arguments and errors as for simulate, x0 with all states."""
    if drive.ndim == 3:
        single = [_run_of(bound, t_s, x0, row, index, under) for index, row in enumerate(drive)]
        return Runs(single[0].t_s, *(_stacked([getattr(run, name) for run in single]) for name in "uyx"))
    times = np.ascontiguousarray(t_s, dtype=float)
    commands = filled("u", drive, (times.size, len(bound.model.inputs)))
    way = arriving(bound, times, commands)
    keep, given = under.keep, under.resolution
    steps = np.asarray(bound.encoder_steps if given is None else given, dtype=float)
    exact = np.zeros(steps.shape) if bound.output_path else steps
    wanted = "yx" if bound.output_path else keep.replace("u", "")
    runs = run_equations(bound, way.t_s, x0, way.u, replace(under, resolution=exact, keep=wanted))
    y = _measured(bound, way, runs, steps, under.p) if bound.output_path and "y" in keep else _rows(runs.y, way)
    shape = (*(runs.x if runs.x is not None else runs.y).shape[:-2], *commands.shape)  # type: ignore[union-attr]
    u = np.broadcast_to(commands, shape).copy() if "u" in keep else None
    return Runs(times, u, y, _rows(runs.x, way) if "x" in keep else None)


def run_loop(bound: BoundPlant, t_s: ArrayLike, x0: Array, drive: Drive, under: Conditions) -> Runs:
    """A run with the loop closed sample by sample; arguments as for simulate, x0 (states,) with all states.

    Raises BadInput for several runs, for noise, and without a reference.
    """
    p = np.asarray(bound.p if under.p is None else under.p, dtype=float)
    if under.noise is not None or p.ndim != 1 or x0.ndim != 1:
        effects = ", ".join(bound.effects)
        raise BadInput("closed loop", effects, "noise or several runs", "one run without noise", "run them one by one")
    if under.reference is None:
        raise BadInput("reference", "simulation", "nothing", "references for the controller", "give reference=")
    times, model = np.ascontiguousarray(t_s, dtype=float), bound.model
    references = filled("reference", under.reference, (times.size, len(model.outputs)))
    own, first_s = replace(bound, p=p), float(times[0])
    plant = SteppedPlant(own, x0, first_s, resolution=under.resolution, locked=under.locked)
    control = _controller(bound, drive, plant.measured())
    u, y, x = (np.empty((times.size, len(kind))) for kind in (model.inputs, model.outputs, model.states))
    for k in range(times.size):
        x[k], y[k] = plant.x, plant.measured()
        u[k] = control(references[k], y[k])
        if k + 1 < times.size:
            plant.advance(u[k].tolist(), float(times[k + 1]), under.substeps)
    return Runs(
        times, **{name: array if name in under.keep else None for name, array in (("u", u), ("y", y), ("x", x))}
    )


def _controller(bound: BoundPlant, drive: Drive, y0: tuple[float, ...]) -> Any:
    """A function (reference, y) -> u of the law of a table, started at y0, or of compiled code."""
    compiled = kernel(bound.model)
    ffi, lib, u = compiled.ffi, compiled.lib, np.empty(len(bound.model.inputs))

    def pointer(array: Array) -> Any:
        return ffi.cast("double *", array.ctypes.data)

    if isinstance(drive, CController):
        function = ffi.cast("void (*)(void *, const double *, const double *, double *)", drive.function)
        context = ffi.cast("void *", drive.context)

        def by_code(reference: Array, y: Array) -> Array:
            function(context, pointer(reference), pointer(y), pointer(u))
            return u

        return by_code
    assert not isinstance(drive, np.ndarray)
    law, state = law_struct(compiled, drive), ffi.new("char[]", lib.law_state_size())
    lib.law_start_single(law, state, pointer(np.array(y0)))

    def by_law(reference: Array, y: Array) -> Array:
        lib.law_step_single(law, state, pointer(reference), pointer(y), pointer(u))
        return u

    return by_law


def _measured(bound: BoundPlant, way: Arriving, runs: Runs, steps: Array, p: ArrayLike | None) -> Array:
    """The outputs behind their way, with the noise that the run put on them, in the encoders' steps."""
    assert runs.x is not None
    assert runs.y is not None
    parameters = np.asarray(bound.p if p is None else p, dtype=float)
    x = runs.x.reshape(-1, *runs.x.shape[-2:])
    noisy = runs.y.reshape(-1, *runs.y.shape[-2:])
    result = np.empty((len(x), len(way.rows), noisy.shape[-1]))
    for index, states in enumerate(x):
        own = parameters if parameters.ndim == 1 else parameters[index]
        plain, _ = reading(bound.model)(way.t_s, states, own)
        result[index] = (readings(bound, way.t_s, states, own) + (noisy[index] - plain))[way.rows]
    return in_steps(result, steps).reshape(*runs.y.shape[:-2], *result.shape[-2:])


def _run_of(bound: BoundPlant, t_s: ArrayLike, x0: Array, row: Array, index: int, under: Conditions) -> Runs:
    """Run number `index` of a batch with inputs of its own."""
    p = under.p
    own = p if p is None or np.ndim(p) == 1 else np.asarray(p)[index]
    start = x0 if x0.ndim == 1 else x0[index]
    return run_open(bound, t_s, start, row, replace(under, p=own))


def _stacked(arrays: list[Array | None]) -> Array | None:
    whole = [array for array in arrays if array is not None]
    return np.stack(whole) if len(whole) == len(arrays) else None


def _rows(values: Array | None, way: Arriving) -> Array | None:
    return None if values is None else np.ascontiguousarray(values[..., way.rows, :])
