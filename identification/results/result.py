"""What an identification hands on: a plant file with earned sd and correlations, and all that is to be told about how it came about."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from typing import Any

import numpy as np

from identification.experiments.table import AID_UNITS
from identification.fit.belief import Belief
from identification.results.notes import relative, stage_notes
from identification.search.methods import Searched
from identification.stages.estimate import Estimate, interval_factor
from identification.uncertainty.residuals import ResidualTest
from records.correlation import Correlation
from records.plant import Parameter, Plant, coefficient_names

SCHEMA = "identification/1"
CORRELATION_DIGITS = 9
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
        return (f"{', '.join(self.unfinished)}: the best so far of a fit that was interrupted, without interval",)

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
    starts = _numbers(plant)
    factors: dict[str, float] = {}
    for _, stage in stages:
        for name in stage.own:
            factors.setdefault(name, interval_factor(stage.dof))
    scales = {name: max(abs(starts[name][0]), abs(belief.value(name)), starts[name][1]) for name in belief.names}
    estimates = tuple(
        _estimated(name, starts[name][2], starts[name][0], belief, factors.get(name, 1.96), FARTHEST * scales[name])
        for name in belief.names
    )
    found = tuple(
        _estimated(name, _aid_unit(name), 0.0, part, interval_factor(dof), np.inf)
        for part, dof in aids
        for name in part.names
    )
    return Identification(_with_belief(plant, estimates, belief), estimates, belief, tuple(stages), found)


def _aid_unit(name: str) -> str:
    """An input's offset bears the unit of its input, "offset.u_T_V"."""
    return name.rpartition("_")[2] if name.startswith("offset.") and "_" in name else AID_UNITS.get(name, "")


def _estimated(name: str, unit: str, start: float, belief: Belief, factor: float, reach: float) -> Estimated:
    value, sd = belief.value(name), float(belief.sd[belief.names.index(name)])
    told = factor * sd < reach or start == 0.0
    return Estimated(name, unit, start, value, sd, value - factor * sd, value + factor * sd, told)


def _numbers(plant: Plant) -> dict[str, tuple[float, float, str]]:
    """Value, sd and unit of each coefficient."""
    values = [value for entry in plant.parameters.values() for value in entry.values]
    sds = [sd for entry in plant.parameters.values() for sd in entry.sds]
    units = [unit for entry in plant.parameters.values() for unit in _units(entry)]
    return dict(zip(coefficient_names(plant.parameters), zip(values, sds, units, strict=True), strict=True))


def _units(entry: Parameter) -> list[str]:
    parts = entry.unit.strip("[]").split(",") if entry.unit.startswith("[") else [entry.unit]
    return [part.strip() for part in parts] * (len(entry.values) // len(parts))


def _with_belief(plant: Plant, estimates: Sequence[Estimated], belief: Belief) -> Plant:
    """The plant file's content with estimates, sd and correlation of what was identified."""
    told = {entry.name: entry for entry in estimates if entry.identified}
    parameters = {name: _parameter(name, entry, told) for name, entry in plant.parameters.items()}
    names = tuple(told)
    rows = np.round(belief.part(names).correlation, CORRELATION_DIGITS)
    correlation = Correlation(names, tuple(tuple(row) for row in rows.tolist()))
    return replace(plant, parameters=parameters, correlation=correlation if names else None)


def _parameter(name: str, entry: Parameter, told: Mapping[str, Estimated]) -> Parameter:
    """A parameter with the estimates of those of its coefficients that were identified."""
    keys = [f"{name}_{k}" for k in range(len(entry.values))] if isinstance(entry.value, tuple) else [name]
    if not any(key in told for key in keys):
        return entry
    values = tuple(told[key].value if key in told else old for key, old in zip(keys, entry.values, strict=True))
    sds = tuple(told[key].sd if key in told else old for key, old in zip(keys, entry.sds, strict=True))
    many = isinstance(entry.value, tuple)
    source = "identified from recorded experiments; see the section [correlation]"
    return Parameter(values if many else values[0], sds if many else sds[0], entry.unit, source)


def interrupted(result: Identification, values: Mapping[str, float]) -> Identification:
    """The result with the best values so far of the fit at hand, of the coefficients that no finished fit has estimated."""
    known = coefficient_names(result.plant.parameters)
    own = {name: value for name, value in values.items() if name in known and name not in result.belief.names}
    return replace(result, plant=with_values(result.plant, own, INTERRUPTED), unfinished=own)


def with_values(plant: Plant, values: Mapping[str, float], source: str) -> Plant:
    """The plant with other values of some coefficients and `source` as where they come from; sd as they were."""
    found = dict(plant.parameters)
    for name, entry in plant.parameters.items():
        keys = [f"{name}_{k}" for k in range(len(entry.values))] if isinstance(entry.value, tuple) else [name]
        if any(key in values for key in keys):
            new = tuple(values.get(key, old) for key, old in zip(keys, entry.values, strict=True))
            found[name] = replace(entry, value=new if isinstance(entry.value, tuple) else new[0], source=source)
    return replace(plant, parameters=found)


def facts(result: Identification) -> dict[str, Any]:
    """The result as plain values for identification.json."""
    return {
        "schema": SCHEMA,
        "plant": result.plant.name,
        "model": result.plant.model,
        "estimates": [asdict(entry) for entry in result.estimates],
        "aids": [asdict(entry) for entry in result.aids],
        "correlation": {"names": list(result.belief.names), "rows": result.belief.correlation.round(9).tolist()},
        "stages": [_stage_facts(title, stage) for title, stage in result.stages],
        "unfinished": dict(result.unfinished),
        "holdout": [asdict(test) for test in result.holdout],
        "notes": list(result.notes),
    }


def _stage_facts(title: str, stage: Estimate) -> dict[str, Any]:
    return {
        "data": title,
        "parameters": list(stage.own),
        "degrees_of_freedom": stage.dof,
        "cost": stage.cost,
        "residuals": [{**asdict(test), "white": test.white} for test in stage.residuals],
        "not_identifiable": [
            {"weights": dict(entry.weights), "relative_sd": entry.relative_sd} for entry in stage.unseen
        ],
        "at_bound": list(stage.at_bound),
        "contradictions": [asdict(entry) for entry in stage.contradictions],
        "discords": [asdict(entry) for entry in stage.discords],
        "searches": [_search_facts(entry) for entry in stage.searched],
    }


def _search_facts(found: Searched) -> dict[str, Any]:
    """What one method found over the whole range; `error` is sum |e| with angles in degrees."""
    return {
        "method": found.method,
        "values": dict(zip(found.names, found.values.tolist(), strict=True)),
        "ranges": {
            name: [float(lower), float(upper)]
            for name, lower, upper in zip(found.names, found.lower, found.upper, strict=True)
        },
        "bits": dict(zip(found.names, found.bits, strict=False)),
        "error": found.error,
        "best_by_generation": list(found.best),
        "cpu_s": found.cpu_s,
    }
