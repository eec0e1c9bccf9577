"""Columns that are not what they are called: one with its sign turned, or two in each other's place. Then the plant is not at fault."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Any

import numpy as np

from diagnosis import decisions
from diagnosis.decide.columns import (
    fitted_or_none,
    is_as_good,
    is_refused,
    is_strained,
    is_told,
    looked_at,
)
from diagnosis.fit.gauss_newton import Fit, likelihood_of
from diagnosis.fit.nominal import gain_over
from diagnosis.fit.process_noise import with_process_noise
from diagnosis.hypothesis.case import Case, FilteredLog
from diagnosis.hypothesis.hypothesis import nominal_hypothesis
from diagnosis.hypothesis.initial_state import start_of
from jobs.thread_map import thread_map
from records.errors import BadInput
from records.reasons import Note


@dataclass(frozen=True)
class ColumnWiring:
    """Another reading of the columns: which of the recorded inputs and outputs each one is, and with which sign."""

    what: str
    remedy: str
    inputs: Sequence[int]
    outputs: Sequence[int]
    input_signs: Sequence[float]
    output_signs: Sequence[float]


def demand_wiring(case: Case, nominal: Fit, fitted: Callable[[Case], Fit], where: str) -> tuple[Note, ...]:
    """What is to be known of the columns: that one may be another, or that these logs do not tell the sign of an input.

    Raises BadInput where turning one column's sign, or swapping two columns, lets the plant as stated follow the logs. `nominal` is the
    plant's fit to the logs as they are; `fitted` makes such a fit, and is asked only where that one is strained. `where` says which logs
    they are.
    """
    found = likelier_wiring(case, fitted) if is_strained(case, nominal) else None
    if found is None:
        return _blind_signs(case, nominal)
    wiring, gain = found
    got = f"{wiring.what}: read so, the plant follows them {gain:.0f} nats better"
    if not is_refused(gain):
        return (Note("columns_doubted", "columns", {"gain_nats": gain}, f"perhaps {got}"),)
    raise BadInput("columns", where, got, "columns that are what they are called", wiring.remedy)


def likelier_wiring(case: Case, fitted: Callable[[Case], Fit]) -> tuple[ColumnWiring, float] | None:
    """Another reading of the columns under which the plant is likelier, as stated and as fitted, and what it gains in nats; None where
    there is none."""
    short = looked_at(case)
    least = as_stated(short)
    slips = [(wiring, read) for wiring in wirings(case) if as_stated(read := _rewired(short, wiring)) > least]
    usual = fitted_or_none(short, fitted) if slips else None
    fits = thread_map(lambda slip: fitted_or_none(slip[1], fitted), slips)
    found = [(wiring, fit) for (wiring, _), fit in zip(slips, fits, strict=True) if fit is not None]
    if usual is None or not found:
        return None
    best, fit = max(found, key=lambda entry: entry[1].log_posterior)
    gain = gain_over(short, usual, fit)
    if not (is_told(gain) and is_told(_gain_alone(short, best, fitted, gain))):
        return None
    alike = [other for other, own in found if is_as_good(own.log_posterior, fit.log_posterior)]
    return _either(best, alike), gain


def _gain_alone(case: Case, wiring: ColumnWiring, fitted: Callable[[Case], Fit], together: float) -> float:
    """What another reading of the columns, which gains so many nats of all logs `together`, gains of each by itself: a slip is one in
    every log, but a start that the model does not foresee looks like one where calmer logs keep the noise that is shared too small."""
    if len(case.flights) == 1:
        return together
    alone = [case.with_flights([flight]) for flight in case.flights]
    usual = thread_map(lambda own: fitted_or_none(own, fitted), alone)
    read = thread_map(lambda own: fitted_or_none(_rewired(own, wiring), fitted), alone)
    found = zip(alone, usual, read, strict=True)
    return sum(gain_over(own, one, other) for own, one, other in found if one is not None and other is not None)


def _blind_signs(case: Case, nominal: Fit) -> tuple[Note, ...]:
    """That the plant answers alike to either sign of an input that moves it."""
    inputs = [str(u) for u in case.library.bound.model.inputs]
    blind = [
        name
        for place, (name, wiring) in enumerate(zip(inputs, wirings(case), strict=False))
        if any(np.any(flight.filter_input.u[:, place]) for flight in case.flights)
        and not is_told(abs(likelihood_of(_rewired(case, wiring), nominal.hypothesis) - nominal.log_likelihood))
    ]
    if not blind:
        return ()
    names = " and ".join(blind)
    said = f"the sign of {names} cannot be seen in these logs: the plant as stated answers alike to either"
    return (Note("sign_unseen", names, {}, said),)


def as_stated(case: Case) -> float:
    """The log likelihood of the plant as it is stated, with the white noise that it then needs: what cannot follow the logs better so is no
    reading that anybody meant."""
    return likelihood_of(case, with_process_noise(case, nominal_hypothesis(case, float(decisions.FIRST_PROCESS_NOISE))))


def _either(best: ColumnWiring, alike: Sequence[ColumnWiring]) -> ColumnWiring:
    """The best reading, told with those that the logs cannot tell from it: of a plant that is the same both ways round, either sign."""
    first = sorted(alike, key=lambda wiring: wiring is not best)
    return replace(
        best,
        what=", or ".join(wiring.what for wiring in first),
        remedy=", or ".join(wiring.remedy for wiring in first),
    )


def wirings(case: Case) -> Iterator[ColumnWiring]:
    """Every single slip of a sign and every pair of columns of one unit in each other's place."""
    model = case.library.bound.model
    inputs, outputs = [str(u) for u in model.inputs], list(model.outputs)
    straight = ColumnWiring("", "", range(len(inputs)), range(len(outputs)), [1.0] * len(inputs), [1.0] * len(outputs))
    for place, name in enumerate(inputs):
        yield replace(_turned(straight, name), input_signs=_one_turned(len(inputs), place))
    for place, name in enumerate(outputs):
        yield replace(_turned(straight, name), output_signs=_one_turned(len(outputs), place))
    for one, other in _alike(inputs):
        yield replace(_swapped(straight, inputs[one], inputs[other]), inputs=_exchanged(len(inputs), one, other))
    for one, other in _alike(outputs):
        yield replace(_swapped(straight, outputs[one], outputs[other]), outputs=_exchanged(len(outputs), one, other))


def _turned(straight: ColumnWiring, name: str) -> ColumnWiring:
    return replace(straight, what=f"{name} has the wrong sign", remedy=f"turn the sign of {name}")


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


def _rewired(case: Case, wiring: ColumnWiring) -> Case:
    """The case with its columns read the other way."""
    return case.with_flights([_read_otherwise(case, flight, wiring) for flight in case.flights])


def _read_otherwise(case: Case, flight: FilteredLog, wiring: ColumnWiring) -> FilteredLog:
    filter_input, count = flight.filter_input, len(wiring.outputs)
    places = [*wiring.outputs, *range(count, filter_input.y.shape[1])]
    signs = np.array([*wiring.output_signs, *_rate_signs(case, wiring)])
    readings: dict[str, Any] = {name: getattr(filter_input, name)[:, places] for name in ("r", "standing", "usual")}
    u = filter_input.u[:, list(wiring.inputs)] * np.array(wiring.input_signs)
    filter_input = replace(
        filter_input,
        u=u,
        y=filter_input.y[:, places] * signs,
        read=filter_input.read[:, places] * signs,
        single=filter_input.single[places],
        **readings,
    )
    x0, p0 = start_of(case.library, filter_input, flight.locked)
    return replace(flight, filter_input=filter_input, x0=x0, p0=p0)


def _rate_signs(case: Case, wiring: ColumnWiring) -> list[float]:
    """Signs of the states that a log may carry: a rate turns with its angle."""
    model, library = case.library.bound.model, case.library
    outputs = {str(expression): place for place, expression in enumerate(model.outputs.values())}
    angles = {str(axis.velocity): outputs.get(str(axis.position)) for axis in model.axes}
    places = [angles.get(name) for name in library.outputs[len(model.outputs) :]]
    return [1.0 if place is None else wiring.output_signs[place] for place in places]
