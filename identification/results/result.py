"""What an identification hands on: a plant file with earned sd and correlations, and all that is to be told about how it came about."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

from identification.experiments.table import aid_unit
from identification.fit.belief import Belief
from identification.results.notes import bound_warning, relative, stage_notes
from identification.results.plant_file import numbers, with_belief, with_values
from identification.results.told import by_data, combined, of_file
from identification.stages.estimate import Data, Estimate, counting, interval_factor, interval_factors
from identification.uncertainty.residuals import ResidualTest
from records.plant import Plant, coefficient_names
from sim.model import Model

FILE_COUNTS = "what the plant file knows of it counts beside the data, in every estimate and interval"
INTERRUPTED = "the best so far of a fit that was interrupted"
NORMAL = 1.96  # half the width of a 95 % interval of a normal distribution, in standard deviations
MOST_POWERS = 50.0  # of e: an interval that reaches over more factors says nothing more


@dataclass(frozen=True)
class Estimated:
    """One coefficient: where its fit started; value, sd and 95 % interval as plant.toml holds them; whether the data told it at all.

    What must be positive, a time constant or an inertia, is taken as normal by its logarithm, so its interval ends above zero: where
    the sd is a small share of the value it is the usual one, value -+ so many sd. That of what must not be negative, a dry friction,
    ends at 0.
    One that they did not tell (`identified` false) counts with what the plant file knows of it (`identification.results.told`);
    `by_data` and `by_data_sd` are what the data alone say of each.
    """

    name: str
    unit: str
    start: float
    value: float
    sd: float
    lower: float
    upper: float
    identified: bool
    by_data: float
    by_data_sd: float


@dataclass(frozen=True, eq=False)
class Identification:
    """The whole result; `stages` are (data, estimate) in the order in which they were made, `aids` what experiments needed besides,
    `holdout` how the identified plant predicts logs that were not used. `unfinished` are the values that a fit which was interrupted had
    come to; they are in the plant, without sd of their own. `remarks` tell what is odd in the data themselves, `flags` what makes
    the estimates doubtful, `doubt` what makes all of them so: columns that may be others, a clock, commands not known.
    """

    plant: Plant
    estimates: tuple[Estimated, ...]
    belief: Belief
    stages: tuple[tuple[Data, Estimate], ...]
    aids: tuple[Estimated, ...] = ()
    holdout: tuple[ResidualTest, ...] = ()
    unfinished: Mapping[str, float] = field(default_factory=dict)
    remarks: tuple[str, ...] = ()
    flags: tuple[str, ...] = ()
    doubt: str = ""

    def stage_of(self, kind: str) -> Estimate:
        """The stage of this kind of experiment; raises StopIteration where there is none."""
        return next(stage for data, stage in self.stages if data.kind == kind)

    @property
    def at_bound(self) -> tuple[str, ...]:
        """Coefficients whose last fit ended at a bound of their range."""
        last = {name: name in stage.at_bound for _, stage in self.stages for name in stage.belief.names}
        return tuple(name for name, ended in last.items() if ended)

    @property
    def warning(self) -> str:
        """What is to be read before any number; empty where nothing is."""
        return "; ".join(filter(None, (bound_warning(self.at_bound), self.doubt)))

    @property
    def notes(self) -> tuple[str, ...]:
        """One sentence for each thing that the data cannot tell or tell twice in different ways."""
        units = {entry.name: entry.unit for entry in (*self.estimates, *self.aids)}
        return (
            *self.remarks,
            *self.flags,
            *self._interrupted(),
            *self._unidentified(),
            *(note for data, stage in self.stages for note in stage_notes(data, stage, units)),
        )

    def _interrupted(self) -> tuple[str, ...]:
        if not self.unfinished:
            return ()
        return (f"{', '.join(self.unfinished)}: {INTERRUPTED}, without interval",)

    def _unidentified(self) -> tuple[str, ...]:
        poor = [f"{entry.name} (sd {_share(entry)})" for entry in self.estimates if not entry.identified]
        if not poor:
            return ()
        remedy = "free fewer of them (--free), or add experiments that tell them apart"
        return (f"these data are too poor for {', '.join(poor)}; {FILE_COUNTS}: {remedy}",)


def _share(entry: Estimated) -> str:
    return relative(entry.by_data_sd / abs(entry.by_data)) if entry.by_data else f"{entry.by_data_sd:.2g} {entry.unit}"


@dataclass(frozen=True)
class Matched:
    """A fit without stages: where it started, by name, and what its belief becomes with what is known besides."""

    begun: Mapping[str, float]
    settled: Callable[[Belief, Belief], Belief] = combined


def identification(
    plant: Plant,
    stages: Sequence[tuple[Data, Estimate]],
    belief: Belief,
    aids: Sequence[tuple[Belief, float]] = (),
    signs: Mapping[str, str] | None = None,
    matched: Matched | None = None,
) -> Identification:
    """Put the final belief into the plant, with what the file knows of what the data do not tell (`identification.results.told`).

    `signs` are `signs_of` the plant's model, `matched` tells of a fit that is none of the `stages`.
    """
    factors = dict.fromkeys(belief.names, NORMAL) | interval_factors(stage for _, stage in stages)
    began = _begun(stages) if matched is None else matched.begun
    alone = by_data(plant, belief, _loose_sds(stages, belief), factors)
    known = of_file(plant, [name for name, entry in alone.items() if not entry.told], stages)
    if known.names and stages:
        stages = (*stages[:-1], (stages[-1][0], counting(stages[-1][1], known)))
        aids = [(_of_last(part, stages[-1][1]), dof) for part, dof in aids]
        belief = stages[-1][1].belief.part(belief.names)
    elif known.names:
        belief = (matched.settled if matched else combined)(belief, known)
    units, sign = numbers(plant), signs or {}

    def estimated(name: str) -> Estimated:
        data, factor = alone[name], NORMAL if name in known.names else factors[name]
        value, sd = _told(name, belief)
        ends = interval(value, factor * sd, sign.get(name, "any"))
        by_data_sd = data.sd if data.told else data.loose_sd
        return Estimated(name, units[name][2], began[name], value, sd, *ends, data.told, data.value, by_data_sd)

    estimates = tuple(map(estimated, belief.names))
    aided = tuple(_aid(name, began[name], part, interval_factor(dof)) for part, dof in aids for name in part.names)
    return Identification(with_belief(plant, belief, belief.names), estimates, belief, tuple(stages), aided)


def _of_last(part: Belief, last: Estimate) -> Belief:
    """What the last fit needed besides, as it is by now; that of one before stays as it is."""
    return last.belief.part(part.names) if set(part.names) <= set(last.belief.names) else part


def _begun(stages: Sequence[tuple[Data, Estimate]]) -> dict[str, float]:
    """Where the first fit of each coefficient started, by name."""
    return {name: value for _, stage in reversed(stages) for name, value in stage.start.items()}


def _loose_sds(stages: Sequence[tuple[Data, Estimate]], belief: Belief) -> dict[str, float]:
    """The sd of each were it not held by its own size, by the stage that it belongs to, less what later ones told of it."""
    final = dict(zip(belief.names, belief.sd.tolist(), strict=True))
    loose = dict(final)
    for _, stage in stages:
        for name in final.keys() & set(stage.own) & stage.loose_sd.keys():
            loose[name] = stage.loose_sd[name] * final[name] / float(stage.belief.sd[stage.belief.names.index(name)])
    return loose


def signs_of(model: Model) -> dict[str, str]:
    """What the model demands of each coefficient's sign: "positive", "non-negative" or "any"."""
    return {str(symbol): spec.sign for spec in model.parameters for symbol in spec.symbols}


def interval(value: float, reach: float, sign: str = "any") -> tuple[float, float]:
    """Both ends of an interval of half the width `reach` about a value, without what its `sign` rules out.

    Of one that must be positive the reach is in shares of it, by factors; one that must not be negative is cut off at 0.
    """
    if sign == "non-negative" and value >= 0.0:
        return max(value - reach, 0.0), value + reach
    if sign != "positive" or value <= 0.0:
        return value - reach, value + reach
    factor = math.exp(min(reach / value, MOST_POWERS))
    return value / factor, value * factor


def _aid(name: str, start: float, belief: Belief, factor: float) -> Estimated:
    """What the plant file does not have."""
    value, sd = _told(name, belief)
    return Estimated(name, aid_unit(name), start, value, sd, *interval(value, factor * sd), True, value, sd)


def _told(name: str, belief: Belief) -> tuple[float, float]:
    return belief.value(name), float(belief.sd[belief.names.index(name)])


def interrupted(result: Identification, values: Mapping[str, float]) -> Identification:
    """The result with the best values so far of the fit at hand, of the coefficients that no finished fit has estimated."""
    known = coefficient_names(result.plant.parameters)
    own = {name: value for name, value in values.items() if name in known and name not in result.belief.names}
    return replace(result, plant=with_values(result.plant, own, INTERRUPTED), unfinished=own)
