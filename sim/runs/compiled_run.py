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


@dataclass(frozen=True, eq=False)
class Conditions:
    """Under what a run is made, beside its start and what drives it: `reference` (n, outputs) of a controller, parameters `p` (k,) or
    (runs, k), by default the plant's own, encoder steps `resolution` (outputs,), by default the plant file's, where 0 leaves an output as
    it is, `substeps` of RK4 a sample, axes `locked` mechanically, and which of "uyx" to `keep`."""

    reference: ArrayLike | None = None
    p: ArrayLike | None = None
    resolution: ArrayLike | None = None
    substeps: int = 1
    noise: Noise | None = None
    locked: tuple[str, ...] = ()
    keep: str = "uyx"


PLAIN = Conditions()


def run_equations(
    bound: BoundPlant,
    t_s: ArrayLike,
    x0: ArrayLike,
    drive: Drive,
    under: Conditions,
    *,
    batched: bool | None = None,
) -> Runs:
    """Sample the plant's equations; arguments and errors as for sim.simulate.simulate, but without what its signals pass on their way.

    x0 must have all states, (states,) or (runs, states); `batched` forces one of the two kernels.
    """
    compiled, model, times = kernel(bound.model), bound.model, np.ascontiguousarray(t_s, dtype=float)
    arrays, single = _given(bound, times, x0, drive, under)
    assert arrays["p"] is not None
    runs = len(arrays["p"])
    sizes = {"u": len(model.inputs), "y": len(model.outputs), "x": len(model.states)}
    results = {name: np.empty((runs, times.size, sizes[name])) if name in under.keep else None for name in sizes}
    request, kept = _request(compiled, arrays | results)
    request.samples, request.runs, request.substeps = times.size, runs, under.substeps
    request.input_per_run = arrays["input"] is not None and arrays["input"].ndim == 3
    request.seed = 0 if under.noise is None else under.noise.seed
    kept.append(_drive(compiled, request, drive, under.reference is not None))
    batch = (not single if batched is None else batched) and not isinstance(drive, CController)
    (compiled.batch.run_batch if batch else compiled.lib.run_single)(request)
    return Runs(times, **{name: array[0] if single and array is not None else array for name, array in results.items()})


def _given(
    bound: BoundPlant, times: Array, x0: ArrayLike, drive: Drive, under: Conditions
) -> tuple[dict[str, NDArray[Any] | None], bool]:
    """The arrays that a request points to, each with all its runs where these differ, and whether it is a single run without that axis."""
    model, noise = bound.model, under.noise
    p, start = np.asarray(bound.p if under.p is None else under.p, dtype=float), np.asarray(x0, dtype=float)
    inputs = np.ascontiguousarray(drive, dtype=float) if isinstance(drive, np.ndarray) else None
    several = [array for array, one in ((p, 1), (start, 1), (inputs, 2)) if array is not None and array.ndim == one + 1]
    runs = max((len(array) for array in several), default=1)
    per_run = (runs,) if inputs is not None and inputs.ndim == 3 else ()
    inputs_shape, outputs = (*per_run, times.size, len(model.inputs)), len(model.outputs)
    resolution = bound.encoder_steps if under.resolution is None else under.resolution
    arrays: dict[str, NDArray[Any] | None] = {
        "t_s": times,
        "p": filled("p", p, (runs, len(bound.p))),
        "x0": filled("x0", start, (runs, len(model.states))),
        "input": _optional("u", inputs, inputs_shape),
        "reference": _optional("reference", under.reference, (times.size, outputs)),
        "resolution": filled("resolution", resolution, (outputs,)),
        "measurement_sd": _optional("measurement_sd", noise.measurement_sd if noise else None, (outputs,)),
        "process_sd": _optional("process_sd", noise.process_sd if noise else None, (len(model.states),)),
        "locked": np.array([axis.name in under.locked for axis in model.axes], dtype=np.uint8),
    }
    return arrays, p.ndim == 1 and start.ndim == 1 and not per_run


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


def _optional(name: str, values: ArrayLike | None, shape: tuple[int, ...]) -> Array | None:
    return None if values is None else filled(name, values, shape)


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
