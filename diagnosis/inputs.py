"""Effects with memory on the way of the inputs, as their mean over each step of a tape: right to third order, with no further instants."""

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

from diagnosis.kit import Kit
from diagnosis.tape import Tape, with_inputs
from sim.effects.build import paths_with
from sim.effects.effect import Values
from sim.plants import MODELS
from toolchain.host import build_shared, load_shared

Array = NDArray[np.float64]
SHORTEST_S = 1e-6
DECLARATIONS = """
void lag_means(int64_t steps, const double *h_s, const double *wanted, double tau_s, double *mean);
void slew_means(int64_t steps, const double *h_s, const double *wanted, double rate, double *mean);
"""


def commanded(kit: Kit, tape: Tape, effects: Mapping[str, Values]) -> Tape:
    """The tape with its inputs sent through the stages of `effects`; those that need instants of their own bring them."""
    quick = {name: values for name, values in effects.items() if _quick(name)}
    others = {name: values for name, values in effects.items() if name not in quick}
    if others:
        stages, _ = paths_with(MODELS[kit.bound.plant.model](), others)
        tape = with_inputs(tape, stages)
    for values in (values for name, values in quick.items() if name == "loop.dropped_frames"):
        kept = lfilter([1.0 - values["p"]], [1.0, -values["p"]], tape.u - tape.u[0], axis=0) + tape.u[0]
        tape = replace(tape, u=kept)
    for name, values in quick.items():
        if name == "loop.dropped_frames":
            continue
        place, kind = name.split(".")
        places = kit.bound.model.places
        variable = (places.inputs.get(place) or places.rotors[place]).variable
        column = kit.bound.model.inputs.index(variable)
        u = tape.u.copy()
        if kind == "slew_limit":
            u[:, column] = _behind(tape, column, "slew_means", values["r"])
        elif values["tau"] > SHORTEST_S:
            u[:, column] = _behind(tape, column, "lag_means", values["tau"])
        tape = replace(tape, u=u)
    return tape


def _quick(name: str) -> bool:
    """Which frames were lost is not known: what arrives on average is their geometric mean."""
    late = name.endswith((".lag", ".slew_limit")) and not name.endswith("_sensor.lag")
    return late or name == "loop.dropped_frames"


def _behind(tape: Tape, column: int, stage: str, value: float) -> Array:
    ffi, lib = _library()
    h = np.ascontiguousarray(np.append(np.diff(tape.t_s), tape.t_s[-1] - tape.t_s[-2]))
    wanted = np.ascontiguousarray(tape.u[:, column])
    found = np.empty_like(wanted)
    h_s, given, mean = (ffi.cast("double *", array.ctypes.data) for array in (h, wanted, found))
    getattr(lib, stage)(len(h), h_s, given, value, mean)
    return found


@cache
def _library() -> tuple[Any, Any]:
    path = build_shared("inputs", [Path(__file__).parent / "c" / "inputs.c"])
    return load_shared(DECLARATIONS, path)
