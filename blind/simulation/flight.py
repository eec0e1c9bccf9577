"""Runs of a compiled rig: a model with its shadows on a controller and drawn inputs, or free on a record's commands."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from blind.simulation.ce150 import Rig
from blind.simulation.native import Program, opened, pointer, set_fields
from blind.simulation.record import Model, Record

STARTS_FROM_SHOWN, LOSES_FRAMES = 1, 2  # of run.c
ROW_SHAPES = {"t_s": (), "u_V": (2,), "y_rad": (2,), "exact_rad": (2,), "apparent": (6,)}
Array = NDArray[np.float64]
Bearing = Mapping[str, Sequence[float]]  # the content of the rig's C structure bearing_t


@dataclass(frozen=True, eq=False)
class RunInputs:
    """What a run is given, n rows: steps of `step_s` until the next row (n,), references (n, 2) rad, dither (n, 2) V, gusts (n, gusts, 2)
    in the rig's unit with the steps that each lasts, lost frames (n,). The first `settle` rows come before the log's first."""

    settle: int
    step_s: float
    steps: NDArray[np.int32]
    reference: Array
    dither_V: Array
    gust: Array
    gust_steps: int
    lost: NDArray[np.uint8]

    def fields(self, ffi: Any) -> dict[str, Any]:
        """The content of the C structure inputs_t; this object must outlive it."""
        return {
            "rows": len(self.steps),
            "settle": self.settle,
            "step_s": self.step_s,
            "steps": ffi.cast("int *", self.steps.ctypes.data),
            "reference": pointer(ffi, self.reference),
            "dither_V": pointer(ffi, self.dither_V),
            "gusts": self.gust.shape[1],
            "gust_steps": self.gust_steps,
            "gust": pointer(ffi, self.gust),
            "lost": ffi.cast("unsigned char *", self.lost.ctypes.data),
        }


@dataclass(frozen=True, eq=False)
class Apparatus:
    """What all runs of a rig have in common: its compiled program, its bearings, its controller `control` (the C structure control_t), and
    `nominal`, what that takes the rig for."""

    program: Program
    bearing: Bearing
    nominal: Rig
    control: Any


def fly(apparatus: Apparatus, model: Model, inputs: RunInputs, start: Array, shadows: Sequence[Model]) -> Record:
    """One closed-loop run from the state `start` (6,); each shadow runs freely for a second at a time, on the same bearings."""
    control = apparatus.control
    ffi, lib = opened(apparatus.program)
    count, rows = len(shadows), len(inputs.steps)
    arrays = {name: np.zeros((rows, *shape)) for name, shape in ROW_SHAPES.items()}
    arrays["shadow"] = np.zeros((rows, count, 2))
    out = ffi.new("record_t *", {name: pointer(ffi, array) for name, array in arrays.items()})
    models = ffi.new("model_t[]", count + 1)
    for each, entry in zip(models, (model, *shadows), strict=True):
        _fill(each, entry, apparatus.bearing)
    mode = ffi.new("unsigned char[]", [STARTS_FROM_SHOWN * s.placed + LOSES_FRAMES * s.loses for s in shadows])
    lib.fly(
        models, ffi.new("rig_t *", apparatus.nominal.fields()), control, ffi.new("inputs_t *", inputs.fields(ffi)),
        pointer(ffi, start), count, models + 1, mode, round(1.0 / control.period_s), out,
    )  # fmt: skip
    log: dict[str, Any] = {name: array[inputs.settle :] for name, array in arrays.items()}
    return Record(
        **log,
        reference=inputs.reference[inputs.settle :],
        stop_share=out.at_stop / rows,
        failed=bool(out.failed),
        period_s=control.period_s,
    )


def predict(program: Program, rig: Rig, bearing: Bearing, record: Record, step_s: float) -> Array:
    """Free runs of an effect-free rig on a record's commands, anew from its apparent state each second; angles (n, 2) in rad."""
    ffi, lib = opened(program)
    out = np.zeros_like(record.y_rad)
    t_s, u_V, apparent = (np.ascontiguousarray(x) for x in (record.t_s, record.u_V, record.apparent))
    model = ffi.new("model_t *")
    _fill(model, Model(rig, {}), bearing)
    lib.predict(
        model, len(t_s), pointer(ffi, t_s), pointer(ffi, u_V), pointer(ffi, apparent), record.window_rows, step_s,
        pointer(ffi, out),
    )  # fmt: skip
    return out


def _fill(struct: Any, model: Model, bearing: Bearing) -> None:
    struct.rig = model.rig.fields()
    struct.bearing = {name: list(values) for name, values in bearing.items()}
    set_fields(struct.effects, model.settings)
