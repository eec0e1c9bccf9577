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
from sim.paths.input_stages import DroppedFrames, Lag, SlewLimit
from sim.paths.path import InputStage
from toolchain.host import build_shared, load_shared

Array = NDArray[np.float64]
SHORTEST_S = 1e-6
AVERAGED = (
    DroppedFrames,
    SlewLimit,
    Lag,
)  # stages whose mean over each step is known; all others come with their own instants
DECLARATIONS = """
void lag_means(int64_t steps, const double *h_s, const double *wanted, double tau_s, double second, double *mean);
void slew_means(int64_t steps, const double *h_s, const double *wanted, double rate, double *mean);
void lossy_means(int64_t steps, const double *lost, const double *wanted, double *mean);
"""


def commanded(library: EffectLibrary, filter_input: FilterInput, effects: Mapping[str, Values]) -> FilterInput:
    """The filter input with its inputs sent through the stages of `effects`; those that need instants of their own bring them."""
    stages = {name: stage for name, values in effects.items() if (stage := _stage(library, name, values)) is not None}
    for stage in stages.values():
        if isinstance(stage, DroppedFrames):
            filter_input = _arrived(filter_input, stage.p)
    further = {name: effects[name] for name in effects if not isinstance(stages.get(name), AVERAGED)}
    if further:
        others, _ = paths_with(library.bound.nominal, further)
        filter_input = with_inputs(filter_input, others)
    for stage in stages.values():
        if isinstance(stage, SlewLimit):
            filter_input = _behind(filter_input, stage.column, "slew_means", stage.rate)
        elif isinstance(stage, Lag) and stage.tau_s > SHORTEST_S:
            filter_input = _behind(filter_input, stage.column, "lag_means", stage.tau_s, stage.second)
    return filter_input


def _stage(library: EffectLibrary, name: str, values: Values) -> InputStage | None:
    """The stage that an effect is on the way of the inputs; None for others."""
    on_input = library.effects[name].on_input
    return None if on_input is None else on_input(values)


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


def _behind(filter_input: FilterInput, column: int, stage: str, *values: float) -> FilterInput:
    """The filter input with one input sent through a stage of input_effects.c, `values` its numbers in their order there."""
    _, lib = _library()
    u, h = filter_input.u.copy(), np.append(np.diff(filter_input.t_s), filter_input.t_s[-1] - filter_input.t_s[-2])
    u[:, column] = _means(
        h,
        filter_input.u[:, column],
        lambda steps, h_s, wanted, mean: getattr(lib, stage)(steps, h_s, wanted, *values, mean),
    )
    return replace(filter_input, u=u)


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
