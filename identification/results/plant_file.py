"""A plant file's content with what was identified put in, and its coefficients read out."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from identification.fit.belief import Belief
from records.correlation import Correlation
from records.plant import Parameter, Plant, coefficient_names

CORRELATION_DIGITS = 9
IDENTIFIED = "identified from recorded experiments; see the section [correlation]"


def numbers(plant: Plant) -> dict[str, tuple[float, float, str]]:
    """Value, sd and unit of each coefficient."""
    values = [value for entry in plant.parameters.values() for value in entry.values]
    sds = [sd for entry in plant.parameters.values() for sd in entry.sds]
    units = [unit for entry in plant.parameters.values() for unit in entry.units]
    return dict(zip(coefficient_names(plant.parameters), zip(values, sds, units, strict=True), strict=True))


def with_belief(plant: Plant, belief: Belief, names: Sequence[str]) -> Plant:
    """The plant with estimates, sd and correlation of the coefficients `names`."""
    told = belief.part(names)
    values, sds = (dict(zip(told.names, of.tolist(), strict=True)) for of in (told.mean, told.sd))
    rows = np.round(told.correlation, CORRELATION_DIGITS)
    correlation = Correlation(told.names, tuple(tuple(row) for row in rows.tolist())) if names else None
    return replace(with_values(plant, values, IDENTIFIED, sds), correlation=correlation)


def with_values(
    plant: Plant, values: Mapping[str, float], source: str, sds: Mapping[str, float] | None = None
) -> Plant:
    """The plant with other values of some coefficients, and `sds` where they are given; `source` is where these come from."""
    found = dict(plant.parameters)
    for name, entry in plant.parameters.items():
        keys = [f"{name}_{k}" for k in range(len(entry.values))] if isinstance(entry.value, tuple) else [name]
        if any(key in values for key in keys):
            value, sd = _replaced(entry.values, keys, values), _replaced(entry.sds, keys, sds or {})
            many = isinstance(entry.value, tuple)
            found[name] = Parameter(value if many else value[0], sd if many else sd[0], entry.unit, source)
    return replace(plant, parameters=found)


def _replaced(old: Sequence[float], keys: Sequence[str], new: Mapping[str, float]) -> tuple[float, ...]:
    return tuple(new.get(key, number) for key, number in zip(keys, old, strict=True))
