"""The benchmark's own simulation (blind/c): built once, flown with any effects, with shadows that leave effects out."""

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
SOURCES = ("driver.c", "body.c", "sensor.c", "pilot.c", "flight.c")
PERIOD_S = 0.01
WINDOW_ROWS = 100
SUBSTEPS = 100
GUSTS_PER_ROW = 10
PLACED, LOSES = 1, 2
ROW_SHAPES = {"t_s": (), "u_V": (2,), "y_rad": (2,), "exact_rad": (2,), "apparent": (6,)}
Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Flight:
    """What a run is given, by row of 10 ms: references (n, 2) rad, dither (n, 2) V, gusts (n, 10, 2) N m, lost frames, sub-steps."""

    settle: int
    substeps: NDArray[np.int32]
    reference: Array
    dither_V: Array
    gust_Nm: Array
    lost: NDArray[np.uint8]

    @property
    def rows(self) -> int:
        """Rows in all, those before the log's time 0 included."""
        return len(self.substeps)


def library() -> tuple[Any, Any]:
    """(ffi, lib) of the compiled simulation."""
    return simulation("blind_truth", C_DIR / "truth.h", SOURCES)


def fly(model: Model, nominal: Rig, pilot: Any, flight: Flight, start: Array, shadows: Sequence[Model]) -> Record:
    """One closed-loop run from the state `start` (6,), 10 ms rows, 100 us steps; each shadow runs freely for a second at a time."""
    ffi, lib = library()
    count, rows = len(shadows), flight.rows
    arrays = {name: np.zeros((rows, *shape)) for name, shape in ROW_SHAPES.items()}
    arrays["shadow"] = np.zeros((rows, count, 2))
    out = ffi.new("record_t *", {name: pointer(ffi, array) for name, array in arrays.items()})
    given = ffi.new("flight_t *", _flight_fields(ffi, flight))
    rigs = ffi.new("rig_t[]", [shadow.rig.fields() for shadow in shadows])
    effects = ffi.new("effects_t[]", count)
    for index, shadow in enumerate(shadows):
        set_fields(effects[index], shadow.settings)
    own = ffi.new("effects_t *")
    set_fields(own, model.settings)
    mode = ffi.new("unsigned char[]", [PLACED * s.placed + LOSES * s.loses for s in shadows])
    lib.fly(
        ffi.new("rig_t *", model.rig.fields()), own, ffi.new("rig_t *", nominal.fields()), pilot, given,
        pointer(ffi, start), count, rigs, effects, mode, WINDOW_ROWS, out,
    )  # fmt: skip
    log = {name: array[flight.settle :] for name, array in arrays.items()}
    reference = flight.reference[flight.settle :]
    return Record(
        **log, reference=reference, stop_share=out.at_stop / rows / SUBSTEPS, failed=bool(out.failed), period_s=PERIOD_S
    )


def predict(rig: Rig, record: Record, step_s: float) -> Array:
    """Free runs of an effect-free rig on a record's commands, anew from its apparent state each second; angles (n, 2) in rad."""
    ffi, lib = library()
    out = np.zeros_like(record.y_rad)
    t_s, u_V, apparent = (np.ascontiguousarray(x) for x in (record.t_s, record.u_V, record.apparent))
    lib.predict(
        ffi.new("rig_t *", rig.fields()), len(t_s), pointer(ffi, t_s), pointer(ffi, u_V), pointer(ffi, apparent),
        WINDOW_ROWS, step_s, pointer(ffi, out),
    )  # fmt: skip
    return out


def _flight_fields(ffi: Any, flight: Flight) -> dict[str, Any]:
    return {
        "rows": flight.rows,
        "settle": flight.settle,
        "substeps": ffi.cast("int *", flight.substeps.ctypes.data),
        "reference": pointer(ffi, flight.reference),
        "dither_V": pointer(ffi, flight.dither_V),
        "gust_Nm": pointer(ffi, flight.gust_Nm),
        "lost": ffi.cast("unsigned char *", flight.lost.ctypes.data),
    }
