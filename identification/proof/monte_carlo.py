"""Many rigs with other true parameters, each identified anew: do the intervals hold what they promise?"""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from identification.experiments.table import kinds_of, perform
from identification.runs.run import coefficient_names
from identification.stages.estimate import interval_factors
from identification.stages.staged import Stage, identify_staged
from records.plant import Plant
from sim.bind import BoundPlant, bind

Array = NDArray[np.float64]
MOST_SPREAD = 0.2  # no parameter is drawn further off than its nominal value times exp(+-0.2 n), n standard normal


@dataclass(frozen=True, eq=False)
class Repetition:
    """One rig: its true parameters and what its experiments gave, each a mapping by name; `inside` its 95 % interval."""

    seed: int
    truth: Mapping[str, float]
    value: Mapping[str, float]
    sd: Mapping[str, float]
    inside: Mapping[str, bool]

    @property
    def all_inside(self) -> bool:
        """Every parameter within its own interval."""
        return all(self.inside.values())


def other_rig(bound: BoundPlant, seed: int) -> BoundPlant:
    """A rig whose parameters differ from the plant file's by what the file says is not known of them; what is 0 stays 0."""
    rng, parameters = np.random.default_rng([seed, 27]), dict(bound.plant.parameters)
    for name, entry in parameters.items():
        values, sds = np.array(entry.values), np.array(entry.sds)
        share = np.divide(sds, np.abs(values), out=np.zeros(values.size), where=values != 0.0)
        values = values * np.exp(np.minimum(share, MOST_SPREAD) * rng.standard_normal(values.size))
        drawn = tuple(values.tolist()) if isinstance(entry.value, tuple) else float(values[0])
        parameters[name] = replace(entry, value=drawn)
    return bind(replace(bound.plant, parameters=parameters))


def repetition(bound: BoundPlant, seed: int) -> Repetition:
    """Perform the plant's experiments on `other_rig` and identify it from the plant file's values."""
    truth = other_rig(bound, seed)
    stages = identify_staged(bound, [perform(kind, truth, seed) for kind in kinds_of(bound.model.name)])
    return judged(seed, truth, stages)


def judged(seed: int, truth: BoundPlant, stages: Sequence[Stage]) -> Repetition:
    """What the stages of one rig say, beside its true parameters."""
    belief, factors = stages[-1].belief, interval_factors(stage.result for stage in stages)
    known = dict(zip(coefficient_names(truth.model), truth.p.tolist(), strict=True))
    value = dict(zip(belief.names, belief.mean.tolist(), strict=True))
    sd = dict(zip(belief.names, belief.sd.tolist(), strict=True))
    inside = {name: abs(value[name] - known[name]) <= factors[name] * sd[name] for name in belief.names}
    return Repetition(seed, {name: known[name] for name in belief.names}, value, sd, inside)


@dataclass(frozen=True)
class RigOrder:
    """What a repetition depends on: the plant as stated, and the seed of rig and readings."""

    plant: Plant
    seed: int


def repeat(order: RigOrder) -> dict[str, Any]:
    """A repetition as plain data, for a worker."""
    return asdict(repetition(bind(order.plant), order.seed))


class Covered(Protocol):
    """A repetition that tells of each parameter whether the truth lies within its interval."""

    @property
    def inside(self) -> Mapping[str, bool]:
        """By parameter."""


def coverage(repetitions: Sequence[Covered]) -> dict[str, float]:
    """Share of the repetitions in which each parameter lies within its interval."""
    names = repetitions[0].inside
    return {name: float(np.mean([entry.inside[name] for entry in repetitions])) for name in names}
