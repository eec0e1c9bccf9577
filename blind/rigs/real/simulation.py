"""The real rigs' simulation (`c/`): midpoint steps of at most 0.1 ms, dry friction by one of three laws, several plants."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from threading import Lock
from typing import Any

import numpy as np
from numpy.typing import NDArray

from blind.effects.effect import effects_struct
from blind.rigs.real.catalogue import ALL
from blind.rigs.real.plant import RealPlant
from blind.simulation.ce150 import Rig
from blind.simulation.native import COMMON_DIR, DECLARATIONS, FLAGS, OF_EVERY_RIG, pointer, set_fields
from blind.simulation.record import Model, Record
from toolchain.host import CText, build_shared, load_shared

Array = NDArray[np.float64]
FOLDER = Path(__file__).resolve().parent / "c"
SOURCES = ("driver.c", "plants.c", "sensor.c", "motion.c")
STEP_S = 1e-4
STARTS_FROM_SHOWN, LOSES_FRAMES = 1, 2  # of motion.c
ARC_TANGENT, DAHL, LUGRE = 0, 1, 2
OPENING = Lock()


@dataclass(frozen=True)
class Body:
    """What a rig is beside its plant file's numbers: law of dry friction with its widths by axis (rad/s or rad; m), time of the filter
    of its readings by axis in s."""

    law: int
    width: tuple[float, float]
    filter_s: tuple[float, float] = (0.0, 0.0)


@dataclass(frozen=True, eq=False)
class RealInputs:
    """What a run is given, n rows: references (n, 2), commands of an open loop or what a closed one adds (n, 2) V, accelerations that
    disturb the axes (n + 1, 2), errors of the readings (n, 2), lost frames (n,); a row kept in the log (n - settle,).

    `gain` (2, 3): of angle, integral, rate in V. `clock`: the logger's seconds in a true one.
    """

    settle: int
    period_s: float
    closed: bool
    locked: tuple[bool, bool]
    gain: Array
    rate_filter_s: float
    bit_V: tuple[float, float]
    reference: Array
    base_V: Array
    push: Array
    misread: Array
    lost: NDArray[np.uint8]
    kept: NDArray[np.bool_]
    clock: float
    start: Array


def opened() -> tuple[Any, Any]:
    """(ffi, lib), opened once for all threads."""
    with OPENING:
        return _opened()


def declarations() -> str:
    """Text of simulation.h, for the compiler and for cffi."""
    headers = (
        COMMON_DIR / "line.h",
        FOLDER / "rig.h",
        FOLDER / "state.h",
        COMMON_DIR / "stages.h",
        COMMON_DIR / "predict.h",
    )
    line, rig, state, stages, predict = (path.read_text(encoding="utf-8") for path in headers)
    return "\n".join([line, rig, effects_struct(ALL), "", state, stages, predict])


@cache
def _opened() -> tuple[Any, Any]:
    text = declarations()
    common = [COMMON_DIR / name for name in OF_EVERY_RIG]
    sources: list[Path | CText] = [CText(DECLARATIONS, text), *(FOLDER / name for name in SOURCES), *common]
    return load_shared(text, build_shared("blind_real", sources, flags=FLAGS))


def fly(plant: RealPlant, body: Body, model: Model, shadows: Sequence[Model], inputs: RealInputs) -> Record:
    """One run; each shadow runs freely for a second at a time."""
    ffi, lib = opened()
    rows, count = len(inputs.reference), len(shadows)
    shapes = {"t_s": (), "u_V": (2,), "y": (2,), "exact": (2,), "apparent": (6,), "shadow": (count, 2)}
    arrays = {name: np.zeros((rows, *shape)) for name, shape in shapes.items()}
    out = ffi.new("record_t *", {name: pointer(ffi, array) for name, array in arrays.items()})
    models = ffi.new("model_t[]", count + 1)
    for each, entry in zip(models, (model, *shadows), strict=True):
        _fill(each, plant, body, entry, inputs.locked)
    mode = ffi.new("unsigned char[]", [STARTS_FROM_SHOWN * s.placed + LOSES_FRAMES * s.loses for s in shadows])
    run = ffi.new("run_t *", _run_fields(ffi, model.rig, inputs))
    window = round(1.0 / inputs.period_s)
    lib.fly(models, run, pointer(ffi, inputs.start), count, models + 1, mode, window, out)
    log = {name: array[inputs.settle :] for name, array in arrays.items()}
    outputs = len(plant.outputs)
    return Record(
        t_s=log["t_s"],
        u_V=log["u_V"][:, : len(plant.inputs)],
        y_rad=log["y"][:, :outputs],
        exact_rad=log["exact"][:, :outputs],
        apparent=log["apparent"],
        shadow=log["shadow"][:, :, :outputs],
        reference=inputs.reference[inputs.settle :, : len(plant.axes)],
        stop_share=out.at_stop / rows,
        failed=bool(out.failed),
        period_s=inputs.period_s,
        loop="closed" if inputs.closed else "open",
        locked=tuple(axis for axis, held in zip(plant.axes, inputs.locked, strict=False) if held),
        kept=inputs.kept,
        clock=inputs.clock,
    )


def predict(plant: RealPlant, body: Body, rig: Rig, record: Record, step_s: float) -> Array:
    """Free runs of an effect-free rig on a record's commands, anew from its apparent state each second; angles (n, axes)."""
    ffi, lib = opened()
    rows = len(record.t_s)
    out = np.zeros((rows, 2))
    u_V = np.zeros((rows, 2))
    u_V[:, : record.u_V.shape[1]] = record.u_V
    model = ffi.new("model_t *")
    locked = tuple(axis in record.locked for axis in plant.axes)
    _fill(model, plant, Body(body.law, body.width), Model(rig, {}), locked)
    t_s, apparent = np.ascontiguousarray(record.t_s), np.ascontiguousarray(record.apparent)
    lib.predict(
        model, rows, pointer(ffi, t_s), pointer(ffi, u_V), pointer(ffi, apparent), record.window_rows, step_s,
        pointer(ffi, out),
    )  # fmt: skip
    return out[:, : len(plant.outputs)]


def _run_fields(ffi: Any, rig: Rig, inputs: RealInputs) -> dict[str, Any]:
    steps = max(1, round(inputs.period_s / STEP_S))
    return {
        "rows": len(inputs.reference),
        "settle": inputs.settle,
        "closed": int(inputs.closed),
        "step_s": inputs.period_s / steps,
        "steps": steps,
        "period_s": inputs.period_s,
        "gain": inputs.gain.tolist(),
        "rate_filter_s": inputs.rate_filter_s,
        "bit_V": list(inputs.bit_V),
        "resolution": [*rig.resolution_rad, 1.0][:2],
        "reference": pointer(ffi, inputs.reference),
        "base_V": pointer(ffi, inputs.base_V),
        "push": pointer(ffi, inputs.push),
        "misread": pointer(ffi, inputs.misread),
        "lost": ffi.cast("unsigned char *", inputs.lost.ctypes.data),
    }


def _fill(struct: Any, plant: RealPlant, body: Body, model: Model, locked: Sequence[bool]) -> None:
    struct.rig = plant.fields(model.rig)
    struct.law, struct.width, struct.filter_s = body.law, list(body.width), list(body.filter_s)
    struct.locked = [int(held) for held in locked]
    set_fields(struct.effects, model.settings)
