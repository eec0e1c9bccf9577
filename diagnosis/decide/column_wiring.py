"""Another wiring of the columns: a sign turned, in all rows or in some, or two in each other's place; and a case that is read so."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray

from diagnosis.hypothesis.case import Case, FilteredLog
from diagnosis.hypothesis.initial_state import start_of

Stretch = tuple[int, int]  # rows of a log: from which on, and until before which


@dataclass(frozen=True)
class ColumnWiring:
    """Another reading of the columns: which of the recorded inputs and outputs each one is, and with which sign. Where a sign is turned in
    some rows alone, `rows` says in which of each log, by its number, and `cost` is what their choice costs, in nats."""

    what: str
    remedy: str
    inputs: Sequence[int]
    outputs: Sequence[int]
    input_signs: Sequence[float]
    output_signs: Sequence[float]
    rows: Mapping[int, Stretch] | None = None
    cost: float = 0.0


def wirings(case: Case) -> Iterator[ColumnWiring]:
    """Every single slip of a sign and every pair of columns of one unit in each other's place."""
    yield from turned_signs(case)
    inputs, outputs, straight = _straight(case)
    for one, other in _alike(inputs):
        yield replace(_swapped(straight, inputs[one], inputs[other]), inputs=_exchanged(len(inputs), one, other))
    for one, other in _alike(outputs):
        yield replace(_swapped(straight, outputs[one], outputs[other]), outputs=_exchanged(len(outputs), one, other))


def turned_signs(case: Case) -> Iterator[ColumnWiring]:
    """Every single slip of a sign, the inputs' first."""
    inputs, outputs, straight = _straight(case)
    for place, name in enumerate(inputs):
        yield replace(_turned(straight, name), input_signs=_one_turned(len(inputs), place))
    for place, name in enumerate(outputs):
        yield replace(_turned(straight, name), output_signs=_one_turned(len(outputs), place))


def _straight(case: Case) -> tuple[list[str], list[str], ColumnWiring]:
    """The names of the inputs and of the outputs, and the reading by which each is what it is called."""
    model = case.library.bound.model
    inputs, outputs = [str(u) for u in model.inputs], list(model.outputs)
    signs = [1.0] * len(inputs), [1.0] * len(outputs)
    return inputs, outputs, ColumnWiring("", "", range(len(inputs)), range(len(outputs)), *signs)


def _turned(straight: ColumnWiring, name: str) -> ColumnWiring:
    return replace(straight, what=f"{name} has the wrong sign", remedy=f"turn the sign of {name}")


def silenced(sign: ColumnWiring) -> ColumnWiring:
    """The same with the column whose sign is turned read as 0."""
    inputs, outputs = ([max(one, 0.0) for one in signs] for signs in (sign.input_signs, sign.output_signs))
    return replace(sign, input_signs=inputs, output_signs=outputs)


def _swapped(straight: ColumnWiring, one: str, other: str) -> ColumnWiring:
    return replace(straight, what=f"{one} and {other} stand in each other's place", remedy=f"swap {one} and {other}")


def _one_turned(count: int, place: int) -> list[float]:
    return [-1.0 if other == place else 1.0 for other in range(count)]


def _exchanged(count: int, one: int, other: int) -> list[int]:
    order = list(range(count))
    order[one], order[other] = other, one
    return order


def _alike(names: Sequence[str]) -> list[tuple[int, int]]:
    """Pairs of columns of one unit."""
    units = [name.rsplit("_", 1)[-1] for name in names]
    return [(one, other) for one, other in combinations(range(len(names)), 2) if units[one] == units[other]]


def rewired(case: Case, wiring: ColumnWiring) -> Case:
    """The case with its columns read the other way."""
    return case.with_flights([_read_otherwise(case, flight, wiring) for flight in case.flights])


def _read_otherwise(case: Case, flight: FilteredLog, wiring: ColumnWiring) -> FilteredLog:
    filter_input, count = flight.filter_input, len(wiring.outputs)
    places = [*wiring.outputs, *range(count, filter_input.y.shape[1])]
    signs = np.array([*wiring.output_signs, *_rate_signs(case, wiring)])
    readings: dict[str, Any] = {name: getattr(filter_input, name)[:, places] for name in ("r", "standing", "usual")}
    here = _where_read_so(flight, wiring)
    turned = np.where(here, signs, 1.0)
    filter_input = replace(
        filter_input,
        u=filter_input.u[:, list(wiring.inputs)] * np.where(here, wiring.input_signs, 1.0),
        y=filter_input.y[:, places] * turned,
        read=filter_input.read[:, places] * turned,
        single=filter_input.single[places],
        **readings,
    )
    x0, p0 = start_of(case.library, filter_input, flight.locked)
    return replace(flight, filter_input=filter_input, x0=x0, p0=p0)


def _where_read_so(flight: FilteredLog, wiring: ColumnWiring) -> NDArray[np.bool_]:
    """At which instants (n, 1) of the filter input the columns are read so."""
    t_s = flight.filter_input.t_s
    if wiring.rows is None:
        return np.ones((len(t_s), 1), dtype=bool)
    since, until = np.append(flight.log.t_s, np.inf)[list(wiring.rows[flight.number])]
    return np.asarray((t_s >= since) & (t_s < until))[:, None]


def _rate_signs(case: Case, wiring: ColumnWiring) -> list[float]:
    """Signs of the states that a log may carry: a rate turns with its angle."""
    model, library = case.library.bound.model, case.library
    outputs = {str(expression): place for place, expression in enumerate(model.outputs.values())}
    angles = {str(axis.velocity): outputs.get(str(axis.position)) for axis in model.axes}
    places = [angles.get(name) for name in library.outputs[len(model.outputs) :]]
    return [1.0 if place is None else wiring.output_signs[place] for place in places]
