"""Runs of the compiled equations: with given inputs or with a controller in the loop, one or many side by side."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from records.errors import BadInput
from records.table import ControllerTable
from sim.bind import BoundPlant
from sim.kernel.kernel import Kernel, kernel
from sim.kernel.law import law_struct

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Runs:
    """Samples at t_s (n,): inputs commanded u (..., n, inputs), outputs measured y (..., n, outputs), true states x (..., n, states).

    "..." is absent for a single run and (runs,) for a batch; what was not asked for is None.
    """

    t_s: Array
    u: Array | None
    y: Array | None
    x: Array | None


@dataclass(frozen=True, eq=False)
class Noise:
    """Gaussian noise: `measurement_sd` (outputs,) before quantisation, `process_sd` (states,) per square root of a second.

    The numbers depend on (seed, run, sample, channel) alone.
    """

    seed: int
    measurement_sd: ArrayLike | None = None
    process_sd: ArrayLike | None = None


@dataclass(frozen=True, eq=False)
class CController:
    """A controller compiled elsewhere: address of `void f(void *context, const double *reference, const double *y, double *u)`."""

    function: int
    context: int = 0


Drive = ControllerTable | CController | Array


def run_equations(
    bound: BoundPlant,
    t_s: ArrayLike,
    x0: ArrayLike,
    drive: Drive,
    *,
    reference: ArrayLike | None = None,
    p: ArrayLike | None = None,
    resolution: ArrayLike | None = None,
    substeps: int = 1,
    noise: Noise | None = None,
    locked: tuple[str, ...] = (),
    keep: str = "uyx",
    batched: bool | None = None,
) -> Runs:
    """Sample the plant's equations; arguments and errors as for sim.simulate.simulate, but without what its signals pass on their way.

    x0 must have all states, (states,) or (runs, states).
    """
    compiled = kernel(bound.model)
    p, x0 = np.asarray(bound.p if p is None else p, dtype=float), np.asarray(x0, dtype=float)
    inputs = np.ascontiguousarray(drive, dtype=float) if isinstance(drive, np.ndarray) else None
    per_run = inputs is not None and inputs.ndim == 3
    single = p.ndim == 1 and x0.ndim == 1 and not per_run
    counts = [
        len(array)
        for array, many in ((p, p.ndim == 2), (x0, x0.ndim == 2), (inputs, per_run))
        if many and array is not None
    ]
    runs = max(counts, default=1)
    model, times = bound.model, np.ascontiguousarray(t_s, dtype=float)
    arrays: dict[str, NDArray[Any] | None] = {
        "t_s": times,
        "p": filled("p", p, (runs, len(bound.p))),
        "x0": filled("x0", x0, (runs, len(model.states))),
        "input": None
        if inputs is None
        else filled("u", inputs, (*((runs,) if per_run else ()), times.size, len(model.inputs))),
        "reference": None if reference is None else filled("reference", reference, (times.size, len(model.outputs))),
        "resolution": filled(
            "resolution", bound.encoder_steps if resolution is None else resolution, (len(model.outputs),)
        ),
        "measurement_sd": _optional("measurement_sd", noise.measurement_sd if noise else None, len(model.outputs)),
        "process_sd": _optional("process_sd", noise.process_sd if noise else None, len(model.states)),
        "locked": np.array([axis.name in locked for axis in model.axes], dtype=np.uint8),
    }
    sizes = {"u": len(model.inputs), "y": len(model.outputs), "x": len(model.states)}
    results = {name: np.empty((runs, times.size, sizes[name])) if name in keep else None for name in sizes}
    request, kept = _request(compiled, arrays | results)
    request.samples, request.runs, request.substeps, request.input_per_run = times.size, runs, substeps, per_run
    request.seed = 0 if noise is None else noise.seed
    kept.append(_drive(compiled, request, drive, reference is not None))
    batch = (not single if batched is None else batched) and not isinstance(drive, CController)
    (compiled.batch.run_batch if batch else compiled.lib.run_single)(request)
    return Runs(times, **{name: array[0] if single and array is not None else array for name, array in results.items()})


def filled(name: str, values: ArrayLike, shape: tuple[int, ...]) -> Array:
    """`values` repeated to `shape` and contiguous; raises BadInput when their shape does not broadcast to it or they are not finite."""
    array = np.asarray(values, dtype=float)
    try:
        array = np.ascontiguousarray(np.broadcast_to(array, shape))
    except ValueError as error:
        raise BadInput(
            name, "simulation", f"shape {array.shape}", f"shape {shape}", "one value for each sample and channel"
        ) from error
    if not np.all(np.isfinite(array)):
        raise BadInput(name, "simulation", "a number that is not finite", "finite numbers", "check the values")
    return array


def _optional(name: str, values: ArrayLike | None, size: int) -> Array | None:
    return None if values is None else filled(name, values, (size,))


def _request(compiled: Kernel, arrays: dict[str, NDArray[Any] | None]) -> tuple[Any, list[Any]]:
    """The C struct with its pointers, and what must stay alive while it is used."""
    request = compiled.ffi.new("run_request *")
    for name, array in arrays.items():
        setattr(request, name, compiled.pointer(array))
    return request, [arrays]


def _drive(compiled: Kernel, request: Any, drive: Drive, has_reference: bool) -> Any:
    """Put the controller into the request; returns what must stay alive."""
    if isinstance(drive, np.ndarray):
        return None
    if not has_reference:
        raise BadInput("reference", "simulation", "nothing", "references for the controller", "give reference=")
    if isinstance(drive, CController):
        signature = "void (*)(void *, const double *, const double *, double *)"
        request.controller = compiled.ffi.cast(signature, drive.function)
        request.context = compiled.ffi.cast("void *", drive.context)
        return None
    if (len(compiled.model.inputs), len(compiled.model.outputs)) != (2, 2):
        raise BadInput(
            "controller table",
            compiled.model.name,
            "a two-axis law",
            "a plant with two inputs and outputs",
            "use another controller",
        )
    law = law_struct(compiled, drive)
    request.law = law
    return law
