"""Effects put into a rig: a model with its settings, a run with its shadows."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from blind.effects.effect import Effect, Shape
from blind.rigs.bench import Bench
from blind.simulation.record import Loss, Model, Record

Array = NDArray[np.float64]
STOP_SHARE = 0.1  # of a run's time at most on an elevation stop
ALL = -1  # every effect left out
COARSE = ("count_rad", "count")  # fields of the rigs


@dataclass(frozen=True)
class Injected:
    """An effect with its size and shape, and how severe it was alone on a short run."""

    effect: Effect
    m: float
    shape: Shape
    trial_severity: float


def fly_with_shadows(bench: Bench, injected: Sequence[Injected], inputs: Any) -> Record:
    """A run; shadows: the rig itself, without any effect, then without each effect where there are several."""
    whole = _model(bench, injected)
    single = range(len(injected)) if len(injected) > 1 else ()
    shadows = [whole, _model(bench, injected, ALL), *(_model(bench, injected, i) for i in single)]
    return bench.lab.fly(whole, shadows, inputs)


def _model(bench: Bench, injected: Sequence[Injected], left_out: int | None = None) -> Model:
    """The rig with its effects, less one of them, or less ALL."""
    kept = [] if left_out == ALL else [entry for i, entry in enumerate(injected) if i != left_out]
    settings: dict[tuple[str, int], float] = {}
    own = {}
    for entry in kept:
        settings |= entry.effect.settings(entry.m, entry.shape)
        if entry.effect.hides:
            own[entry.effect.hides] = np.array([entry.effect.size.at(entry.m)])
    lacks_sensor = any(entry.effect.sensor and entry not in kept for entry in injected)
    loses = any(entry.effect.loses_frames for entry in kept)
    return Model(bench.true.with_values(own), settings, placed=lacks_sensor, loses=loses)


def within_range(record: Record) -> bool:
    """Whether the rig stayed off its stops, and no number was lost."""
    return not record.failed and record.stop_share <= STOP_SHARE


def loss(injected: Sequence[Injected]) -> Loss:
    """The frames that these effects lose."""
    share = sum(entry.effect.size.at(entry.m) for entry in injected if entry.effect.loses_frames)
    return Loss(share, max((entry.shape.get("burst_frames", 1.0) for entry in injected), default=1.0))


def coarse_rad(injected: Sequence[Injected], outputs: int = 2) -> Array:
    """Encoder steps that the effects bring, by output (outputs,) in rad; in m on a carriage."""
    settings = [entry.effect.settings(entry.m, entry.shape) for entry in injected]
    steps = [sum(s.get((name, axis), 0.0) for s in settings for name in COARSE) for axis in range(outputs)]
    return np.array(steps)
