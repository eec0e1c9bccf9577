"""Effects with memory on the way of the inputs, as their mean over each step of a filter input: right to third
order, with no further instants."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from diagnosis.filter.filter_input import FilterInput, with_inputs
from diagnosis.library.effect_library import EffectLibrary
from sim.composition.build import paths_with
from sim.effect import Values
from sim.plants import MODELS
from toolchain.host import build_shared, load_shared

Array = NDArray[np.float64]
SHORTEST_S = 1e-6
LOST_FRAMES = "loop.dropped_frames"
DECLARATIONS = """
void lag_means(int64_t steps, const double *h_s, const double *wanted, double tau_s, double *mean);
void slew_means(int64_t steps, const double *h_s, const double *wanted, double rate, double *mean);
void lossy_means(int64_t steps, const double *lost, const double *wanted, double *mean);
"""


def commanded(library: EffectLibrary, filter_input: FilterInput, effects: Mapping[str, Values]) -> FilterInput:
    """The filter input with its inputs sent through the stages of `effects`; those that need instants of their own bring them."""
    quick = {name: values for name, values in effects.items() if _quick(name)}
    others = {name: values for name, values in effects.items() if name not in (*quick, LOST_FRAMES)}
    if LOST_FRAMES in effects:
        filter_input = _arrived(filter_input, effects[LOST_FRAMES]["p"])
    if others:
        stages, _ = paths_with(MODELS[library.bound.plant.model](), others)
        filter_input = with_inputs(filter_input, stages)
    for name, values in quick.items():
        place, kind = name.split(".")
        places = library.bound.model.places
        variable = (places.inputs.get(place) or places.rotors[place]).variable
        column = library.bound.model.inputs.index(variable)
        u = filter_input.u.copy()
        if kind == "slew_limit":
            u[:, column] = _behind(filter_input, column, "slew_means", values["r"])
        elif values["tau"] > SHORTEST_S:
            u[:, column] = _behind(filter_input, column, "lag_means", values["tau"])
        filter_input = replace(filter_input, u=u)
    return filter_input


def _quick(name: str) -> bool:
    return name.endswith((".lag", ".slew_limit")) and not name.endswith("_sensor.lag")


def _arrived(filter_input: FilterInput, share: float) -> FilterInput:
    """The filter input with what arrives where a `share` of the frames is lost: the mean over what is then known of each frame.

    What the readings say of single frames counts in the likelihood less the information that it takes, sum of KL(after, before), and
    less the spread about that mean: a line that loses frames is none that delays them all.
    """
    from scipy.special import rel_entr  # half a second, which whoever loses no frames is spared

    lost = lost_with(filter_input.lost, share)
    arrived = np.stack([_lossy(lost, filter_input.u[:, column]) for column in range(filter_input.u.shape[1])], axis=1)
    taken = lost[filter_input.lost != 0.0]
    information = float(np.sum(rel_entr(taken, share) + rel_entr(1.0 - taken, 1.0 - share)))
    spread = 0.5 * float(np.sum(filter_input.loss_power * lost * (1.0 - lost)))
    return replace(filter_input, u=arrived, known=filter_input.known - information - spread)


def share_slopes(filter_input: FilterInput, share: float) -> tuple[float, float]:
    """Slope and curvature of the log likelihood by the share of lost frames, what the readings say of each frame being held."""
    lost = lost_with(filter_input.lost, share)[filter_input.lost != 0.0]
    spread = share * (1.0 - share)
    return float(np.sum(lost - share)) / spread, -len(lost) / spread


def lost_with(ratios: Array, share: float) -> Array:
    """Probabilities (m,) that frames were lost, `share` before their readings and the log likelihood ratios after them."""
    odds = share * np.exp(np.clip(ratios, -200.0, 200.0))
    return np.asarray(odds / (1.0 - share + odds))


def _behind(filter_input: FilterInput, column: int, stage: str, value: float) -> Array:
    _, lib = _library()
    h = np.append(np.diff(filter_input.t_s), filter_input.t_s[-1] - filter_input.t_s[-2])
    return _means(
        h,
        filter_input.u[:, column],
        lambda steps, h_s, wanted, mean: getattr(lib, stage)(steps, h_s, wanted, value, mean),
    )


def _lossy(lost: Array, wanted: Array) -> Array:
    return _means(lost, wanted, _library()[1].lossy_means)


def _means(beside: Array, wanted: Array, stage: Callable[..., None]) -> Array:
    """What a stage of input_effects.c makes of commands (m,), with the numbers (m,) that it is told beside them."""
    ffi, _ = _library()
    told, given = np.ascontiguousarray(beside), np.ascontiguousarray(wanted)
    found = np.empty_like(given)
    stage(len(given), *(ffi.cast("double *", array.ctypes.data) for array in (told, given, found)))
    return found


@cache
def _library() -> tuple[Any, Any]:
    path = build_shared("inputs", [Path(__file__).with_name("input_effects.c")])
    return load_shared(DECLARATIONS, path)
