"""What an identification hands on: a plant file with earned sd and correlations, and all that is to be told about how it came about."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from identification.experiments.table import AID_UNITS
from identification.fit.belief import Belief
from identification.results.notes import bound_warning, relative, stage_notes
from identification.results.plant_file import numbers, with_belief, with_values
from identification.stages.estimate import Estimate, interval_factor, interval_factors
from identification.uncertainty.residuals import ResidualTest
from records.plant import Plant, coefficient_names

INTERRUPTED = "the best so far of a fit that was interrupted"
FARTHEST = 0.6  # of a size: a parameter whose interval reaches farther is held by having been given one, not by data


@dataclass(frozen=True)
class Estimated:
    """One coefficient: where it started, its estimate with sd and 95 % interval, and whether the data told it at all."""

    name: str
    unit: str
    start: float
    value: float
    sd: float
    lower: float
    upper: float
    identified: bool


@dataclass(frozen=True, eq=False)
class Identification:
    """The whole result; `stages` are (title, estimate) in the order in which they were made, `aids` what experiments needed besides,
    `holdout` how the identified plant predicts logs that were not used. `unfinished` are the values that a fit which was interrupted had
    come to; they are in the plant, without sd of their own. `remarks` tell what is odd in the data themselves.
    """

    plant: Plant
    estimates: tuple[Estimated, ...]
    belief: Belief
    stages: tuple[tuple[str, Estimate], ...]
    aids: tuple[Estimated, ...] = ()
    holdout: tuple[ResidualTest, ...] = ()
    unfinished: Mapping[str, float] = field(default_factory=dict)
    remarks: tuple[str, ...] = ()

    @property
    def at_bound(self) -> tuple[str, ...]:
        """Coefficients whose last fit ended at a bound of their range."""
        last = {name: name in stage.at_bound for _, stage in self.stages for name in stage.belief.names}
        return tuple(name for name, ended in last.items() if ended)

    @property
    def warning(self) -> str:
        """What is to be read before any number; empty where nothing is."""
        return bound_warning(self.at_bound)

    @property
    def notes(self) -> tuple[str, ...]:
        """One sentence for each thing that the data cannot tell or tell twice in different ways."""
        return (
            *self.remarks,
            *self._interrupted(),
            *self._unidentified(),
            *(note for title, stage in self.stages for note in stage_notes(title, stage)),
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
        return (f"these data are too poor for {', '.join(poor)}; the plant file's value is kept: {remedy}",)


def _share(entry: Estimated) -> str:
    return relative(entry.sd / abs(entry.value)) if entry.value else f"{entry.sd:.2g} {entry.unit}"


def identification(
    plant: Plant, stages: Sequence[tuple[str, Estimate]], belief: Belief, aids: Sequence[tuple[Belief, float]] = ()
) -> Identification:
    """Put the final belief into the plant; what the data do not tell keeps the file's value and sd."""
    starts = numbers(plant)
    factors = interval_factors(stage for _, stage in stages)
    scales = {name: max(abs(starts[name][0]), abs(belief.value(name)), starts[name][1]) for name in belief.names}
    begun = _begun(stages)
    estimates = tuple(
        _estimated(
            name,
            starts[name][2],
            begun.get(name, starts[name][0]),
            belief,
            factors.get(name, 1.96),
            FARTHEST * scales[name],
        )
        for name in belief.names
    )
    found = tuple(
        _estimated(name, _aid_unit(name), 0.0, part, interval_factor(dof), np.inf)
        for part, dof in aids
        for name in part.names
    )
    told = with_belief(plant, belief, [entry.name for entry in estimates if entry.identified])
    return Identification(told, estimates, belief, tuple(stages), found)


def _begun(stages: Sequence[tuple[str, Estimate]]) -> dict[str, float]:
    """Where fits started that a search looked ahead for, by name."""
    return {
        name: value
        for _, stage in stages
        for found in stage.searched[:1]
        for name, value in zip(found.names, found.values.tolist(), strict=True)
    }


def _aid_unit(name: str) -> str:
    """An input's offset bears the unit of its input, "offset.u_T_V"."""
    return name.rpartition("_")[2] if name.startswith("offset.") and "_" in name else AID_UNITS.get(name, "")


def _estimated(name: str, unit: str, start: float, belief: Belief, factor: float, reach: float) -> Estimated:
    value, sd = belief.value(name), float(belief.sd[belief.names.index(name)])
    told = factor * sd < reach or start == 0.0
    return Estimated(name, unit, start, value, sd, value - factor * sd, value + factor * sd, told)


def interrupted(result: Identification, values: Mapping[str, float]) -> Identification:
    """The result with the best values so far of the fit at hand, of the coefficients that no finished fit has estimated."""
    known = coefficient_names(result.plant.parameters)
    own = {name: value for name, value in values.items() if name in known and name not in result.belief.names}
    return replace(result, plant=with_values(result.plant, own, INTERRUPTED), unfinished=own)
