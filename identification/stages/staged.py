"""The stages of the paper: each subsystem from the experiment made for it, what is known handed on with its covariance."""

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from identification.experiments.kind import Kind
from identification.experiments.table import EXCITED_BY, informed, kind_of
from identification.fit.belief import NOTHING, Belief
from identification.fit.problem import Told
from identification.fit.ranges import Range, ranges_of
from identification.runs.run import Run, coefficient_names, known_names
from identification.search.methods import Search
from identification.stages.estimate import Data, Estimate, estimate
from identification.stages.setup import check_mount, check_setup
from records.experiment import Experiment
from sim.bind import BoundPlant

ANGLE_SIZE_RAD = 0.1


@dataclass(frozen=True, eq=False)
class Stage:
    """One experiment's estimate; `belief` is over the plant's parameters alone, `aids` over what the experiment needed besides."""

    kind: str
    result: Estimate
    belief: Belief
    aids: Belief


def identify_staged(bound: BoundPlant, experiments: Sequence[Experiment]) -> tuple[Stage, ...]:
    """All stages in order, from the plant's values; raises BadInput for a wrong plant, mount or lock."""
    stages: list[Stage] = []
    for experiment in in_order(experiments):
        belief = stages[-1].belief if stages else NOTHING
        stages.append(identify_stage(bound, experiment, belief))
    return tuple(stages)


def in_order(experiments: Sequence[Experiment]) -> tuple[Experiment, ...]:
    """The experiments in the order of the paper's numbers; raises BadInput for an unknown kind."""
    return tuple(sorted(experiments, key=lambda entry: kind_of(entry).number))


def data_of(experiment: Experiment) -> Data:
    """Number and name of an experiment."""
    kind = kind_of(experiment)
    return Data(f"experiment {kind.number}, {kind.heading}", kind.symbol or kind.title, experiment.kind)


@dataclass(frozen=True)
class AskedOfStage:
    """What is asked of a stage: limits of coefficients, a search over the whole range of its parameters first (`wanted`), which are `free`
    (None: all that the plant does not state as exact), and who is `told` of better parameters as soon as there are any."""

    limits: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    wanted: Search | None = None
    free: Collection[str] | None = None
    told: Told | None = None


NOTHING_MORE = AskedOfStage()


def identify_stage(
    bound: BoundPlant, experiment: Experiment, belief: Belief, asked: AskedOfStage = NOTHING_MORE
) -> Stage:
    """One experiment added to what is known.

    A parameter that it needs but none before has informed is estimated with it from the plant's value, so a set of experiments with
    gaps works and says what it cannot tell. Raises BadInput for a wrong plant, mount or lock, also where only the motion shows it.
    """
    check_setup(experiment, bound)
    kind = kind_of(experiment)
    run = kind.run(experiment, bound)
    own = tuple(name for name in needed(run, kind, belief) if _is_free(name, bound, asked.free))
    ranges = ranges_of(bound, [*belief.names, *own], _limits(kind, asked)) | _aid_ranges(kind, experiment)
    wanted = asked.wanted
    coded = None if wanted is None else replace(wanted, bits={name: bits for name, (_, _, bits) in kind.code.items()})
    before = _with_aids(belief, kind, experiment)
    unknown = tuple(name for name, facts in kind.aids.items() if facts is None)
    result = estimate([run], (*own, *unknown), ranges, before, asked.told, coded)
    check_mount(run, kind, result, ranges, before)
    names = tuple(name for name in result.belief.names if name not in kind.aids)
    return Stage(experiment.kind, result, result.belief.part(names), result.belief.part(tuple(kind.aids)))


def needed(run: Run, kind: Kind, belief: Belief) -> tuple[str, ...]:
    """The experiment's own parameters, and those of the paper that its model has but no stage before has informed."""
    every = informed(run.bound.plant.model)
    has = {every[place] for place, _ in known_names(run, every)}
    excited = {name for name in every if name in has and _excited(run, name)}
    return tuple(name for name in every if name in kind.own or (name in excited and name not in belief.names))


def _is_free(name: str, bound: BoundPlant, free: Collection[str] | None) -> bool:
    """Whether a parameter is to be estimated: as the user says, else unless the plant states it as exact."""
    if free is not None:
        return name in free
    place = coefficient_names(bound.model).index(name)
    return bool(bound.sd[place] > 0.0 or bound.p[place] == 0.0)


def _limits(kind: Kind, asked: AskedOfStage) -> Mapping[str, tuple[float, float]]:
    """The user's limits; a search has those of the experiment's code where the user says nothing."""
    own = {} if asked.wanted is None else {name: (lower, upper) for name, (lower, upper, _) in kind.code.items()}
    return {**own, **asked.limits}


def _excited(run: Run, name: str) -> bool:
    """Whether the run's inputs move what the parameter acts on: without voltage a rotor's parameters are not asked for."""
    inputs = [str(variable) for variable in run.bound.model.inputs]
    column = EXCITED_BY.get(name)
    return column not in inputs or bool(np.any(run.u[:, inputs.index(column)]))


def _aid_ranges(kind: Kind, experiment: Experiment) -> dict[str, Range]:
    found = {}
    for name, facts in kind.aids.items():
        start = experiment.facts[facts[0]] if facts else 0.0
        size = abs(start) or ANGLE_SIZE_RAD
        found[name] = Range(start, -math.inf, math.inf, size)
    return found


def _with_aids(belief: Belief, kind: Kind, experiment: Experiment) -> Belief:
    """The belief with what was measured beside the record, independent of all before."""
    known = [(name, facts) for name, facts in kind.aids.items() if facts]
    if not known:
        return belief
    size = belief.mean.size
    covariance = np.zeros((size + len(known), size + len(known)))
    covariance[:size, :size] = belief.covariance
    for place, (_, (_, sd)) in enumerate(known, start=size):
        covariance[place, place] = experiment.facts[sd] ** 2
    mean = np.array([experiment.facts[value] for _, (value, _) in known])
    return Belief((*belief.names, *(name for name, _ in known)), np.concatenate([belief.mean, mean]), covariance)
