"""Models between identified conditions: each element of A, B, C, D straight over the speed (seed 003, 4.4)."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from identification.envelope.flights.conditions import Condition
from identification.envelope.output_equation.outputs import Linear
from identification.envelope.state_equation.free_run import Model
from records.errors import BadInput

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class GlobalModel:
    """State and output equation of one condition, for deviations from its trim."""

    state: Model
    output: Linear


def neighbours(known: Collection[Condition], wanted: Condition) -> tuple[Condition, Condition]:
    """The conditions of the same loading and altitude next below and above in speed; raises BadInput outside their range."""
    row = sorted(at for at in known if (at.loading, at.altitude_ft) == (wanted.loading, wanted.altitude_ft))
    speeds = [at.speed_kts for at in row]
    if not row or not speeds[0] <= wanted.speed_kts <= speeds[-1]:
        have = f"{speeds[0]} to {speeds[-1]} kts" if row else "no condition of this loading and altitude"
        raise BadInput("speed", wanted.name, have, "identified conditions on both sides", "identify one beyond it")
    upper = int(np.searchsorted(speeds, wanted.speed_kts))
    return (row[upper], row[upper]) if speeds[upper] == wanted.speed_kts else (row[upper - 1], row[upper])


def between(models: Mapping[Condition, GlobalModel], wanted: Condition) -> GlobalModel:
    """The model at `wanted` from its neighbours in speed; raises BadInput outside their range."""
    lower, upper = neighbours(models.keys(), wanted)
    if lower == upper:
        return models[lower]
    share = (wanted.speed_kts - lower.speed_kts) / (upper.speed_kts - lower.speed_kts)
    return _mixed(models[lower], models[upper], share)


def nearest(models: Mapping[Condition, GlobalModel], wanted: Condition) -> GlobalModel:
    """Without interpolation: the model of the nearest speed of the same loading and altitude."""
    row = [at for at in models if (at.loading, at.altitude_ft) == (wanted.loading, wanted.altitude_ft)]
    return models[min(row, key=lambda at: (abs(at.speed_kts - wanted.speed_kts), at.speed_kts))]


def _mixed(a: GlobalModel, b: GlobalModel, share: float) -> GlobalModel:
    def mix(first: Array, second: Array) -> Array:
        return (1.0 - share) * first + share * second

    return GlobalModel(
        Model(mix(a.state.A, b.state.A), mix(a.state.B, b.state.B), a.state.sample_period_s),
        Linear(mix(a.output.C, b.output.C), mix(a.output.D, b.output.D)),
    )
