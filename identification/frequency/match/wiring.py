"""Are the columns of swept records what they are called? A turned column turns the responses of its input or its output, two that are
exchanged exchange theirs; the plant as stated tells, by the cost (7), before anything is searched."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from identification import thresholds
from identification.frequency.match.cost import residual, target
from identification.frequency.models.linear_model import LinearModel
from identification.frequency.responses.conditioned import Responses
from records.errors import BadInput

Complex = NDArray[np.complex128]


@dataclass(frozen=True, eq=False)
class _Reading:
    """The responses read in another way: what is said of the columns then, and what to do."""

    what: str
    remedy: str
    responses: Responses


def demand_wiring(model: LinearModel, T_stated: Complex, measured: Responses, names: Sequence[str]) -> None:
    """Raise BadInput where the plant as stated is far from the responses, and near once a column is turned or two are exchanged."""
    usual = _cost(measured, T_stated)
    costs = [(_cost(entry.responses, T_stated), entry) for entry in _readings(model, measured)]
    least = min(cost for cost, _ in costs)
    if usual <= thresholds.POOR_J * T_stated[0].size or least * thresholds.COLUMNS_TIMES >= usual:
        return
    alike = [entry for cost, entry in costs if cost <= 2.0 * least]
    what, remedy = ", or ".join(entry.what for entry in alike), ", or ".join(entry.remedy for entry in alike)
    got = f"{what}: read so, the cost J of the plant as stated is {least:.0f}, not {usual:.0f}"
    raise BadInput("columns", ", ".join(names), got, "columns that are what they are called", remedy)


def _readings(model: LinearModel, measured: Responses) -> Iterator[_Reading]:
    for axis, names in ((1, model.outputs), (2, model.inputs)):
        for place, name in enumerate(names):
            signs = np.where(np.arange(len(names)) == place, -1.0, 1.0)
            T = measured.T * (signs if axis == 2 else signs[:, None])
            yield _Reading(f"{name} with its sign turned", f"turn {name}", replace(measured, T=T))
        for one, other in combinations(range(len(names)), 2):
            order = np.arange(len(names))
            order[[one, other]] = other, one
            told = f"{names[one]} and {names[other]}"
            yield _Reading(f"{told} in each other's place", f"exchange {told}", _ordered(measured, order, axis))


def _ordered(of: Responses, order: NDArray[np.int64], axis: int) -> Responses:
    T, coherence, error = np.take(of.T, order, axis), np.take(of.coherence, order, axis), np.take(of.error, order, axis)
    return replace(of, T=T, coherence=coherence, error=error)


def _cost(measured: Responses, T: Complex) -> float:
    return float(np.sum(residual(target(measured), T) ** 2))
