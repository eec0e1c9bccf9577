"""The second rig's simulation (blind/second/c): built once, flown with any effects, with shadows that leave effects
out."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from blind.simulation.ce150 import Rig
from blind.simulation.native import pointer, set_fields, simulation
from blind.simulation.record import Model, Record

C_DIR = Path(__file__).resolve().parent / "c"
SOURCES = ("air.c", "driver.c", "bearing.c", "motion.c", "sensor.c", "control.c", "run.c")
STEP_S = 1.25e-4
SLOT_STEPS = 8  # a gust lasts 1 ms
STARTS_FROM_SHOWN, LOSES_FRAMES = 1, 2
ROUNDED, PRESLIDING, STICK_SLIP = 0, 1, 2
ROW_SHAPES = {"t_s": (), "u_V": (2,), "y_rad": (2,), "exact_rad": (2,), "apparent": (6,)}
Array = NDArray[np.float64]


@dataclass(frozen=True)
class Bearing:
    """How dry friction comes about on elevation and azimuth: a law each, with its width (rad/s; rad for presliding)."""

    law: tuple[int, int]
    width: tuple[float, float]


@dataclass(frozen=True, eq=False)
class Flight:
    """What a run is given, by row: steps, references (n, 2) rad, dither (n, 2) V, gusts (n, slots, 2) rad/s^2, lost
    frames."""

    settle: int
    steps: NDArray[np.int32]
    reference: Array
    dither_V: Array
    gust: Array
    lost: NDArray[np.uint8]


def library() -> tuple[Any, Any]:
    """(ffi, lib) of the compiled simulation."""
    return simulation("blind_second", C_DIR / "rig.h", SOURCES)


def fly(
    model: Model, bearing: Bearing, nominal: Rig, control: Any, flight: Flight, start: Array, shadows: Sequence[Model]
) -> Record:
    """One closed-loop run from the state `start` (6,); each shadow runs freely for a second at a time, on the same
    bearings."""
    ffi, lib = library()
    count, rows = len(shadows), len(flight.steps)
    arrays = {name: np.zeros((rows, *shape)) for name, shape in ROW_SHAPES.items()}
    arrays["shadow"] = np.zeros((rows, count, 2))
    out = ffi.new("record_t *", {name: pointer(ffi, array) for name, array in arrays.items()})
    rigs = ffi.new("rig_t[]", [shadow.rig.fields() for shadow in shadows])
    effects = ffi.new("effects_t[]", count)
    for index, shadow in enumerate(shadows):
        set_fields(effects[index], shadow.settings)
    own = ffi.new("effects_t *")
    set_fields(own, model.settings)
    mode = ffi.new("unsigned char[]", [STARTS_FROM_SHOWN * s.placed + LOSES_FRAMES * s.loses for s in shadows])
    period_s = control.period_s
    lib.fly(
        ffi.new("rig_t *", model.rig.fields()), _bearing(ffi, bearing), own,
        ffi.new("rig_t *", nominal.fields()), control,
        ffi.new("flight_t *", _flight_fields(ffi, flight)), pointer(ffi, start), count, rigs, effects, mode,
        round(1.0 / period_s), out,
    )  # fmt: skip
    log = {name: array[flight.settle :] for name, array in arrays.items()}
    return Record(
        **log,
        reference=flight.reference[flight.settle :],
        stop_share=out.at_stop / rows,
        failed=bool(out.failed),
        period_s=period_s,
    )


def predict(rig: Rig, bearing: Bearing, record: Record, step_s: float) -> Array:
    """Free runs of an effect-free rig on a record's commands, anew from its apparent state each second; angles (n, 2)
    in rad."""
    ffi, lib = library()
    out = np.zeros_like(record.y_rad)
    t_s, u_V, apparent = (np.ascontiguousarray(x) for x in (record.t_s, record.u_V, record.apparent))
    lib.predict(
        ffi.new("rig_t *", rig.fields()), _bearing(ffi, bearing), len(t_s), pointer(ffi, t_s), pointer(ffi, u_V),
        pointer(ffi, apparent), record.window_rows, step_s, pointer(ffi, out),
    )  # fmt: skip
    return out


def _bearing(ffi: Any, bearing: Bearing) -> Any:
    return ffi.new("bearing_t *", {"law": list(bearing.law), "width": list(bearing.width)})


def _flight_fields(ffi: Any, flight: Flight) -> dict[str, Any]:
    return {
        "rows": len(flight.steps),
        "settle": flight.settle,
        "step_s": STEP_S,
        "steps": ffi.cast("int *", flight.steps.ctypes.data),
        "reference": pointer(ffi, flight.reference),
        "dither_V": pointer(ffi, flight.dither_V),
        "slots": flight.gust.shape[1],
        "slot_steps": SLOT_STEPS,
        "gust": pointer(ffi, flight.gust),
        "lost": ffi.cast("unsigned char *", flight.lost.ctypes.data),
    }
