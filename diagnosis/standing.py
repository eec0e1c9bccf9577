"""Readings that stand while an axis rests: what they are worth under the nominal plant, so that play is not believed for ignoring them."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from diagnosis.case import Case
from diagnosis.filter import Pass
from diagnosis.hypothesis import Supposed, passes
from diagnosis.sensors import standing_rows


def with_usual(case: Case, nominal: Supposed) -> Case:
    """The case with each reading's log likelihood under the fitted nominal plant.

    Leaving standing readings out makes the others more likely even without play, as rounding at rest is no white noise: that gain is
    taken off what the standing ones count.
    """
    runs = passes(case, nominal)
    if runs is None:
        return case
    case = _usual(case, runs)
    kit = case.kit
    for place, sensor in kit.bound.model.places.sensors.items():
        name = f"{place}.backlash"
        if name not in kit.effects or name in nominal.effects:
            continue
        without = passes(case, nominal.with_effects({**nominal.effects, name: {"width": 0.0}}))
        if without is not None:
            case = _levelled(case, kit.outputs.index(sensor.output), runs, without)
    return case


def _usual(case: Case, runs: Sequence[Pass]) -> Case:
    flights = []
    for flight, run in zip(case.flights, runs, strict=True):
        usual = flight.tape.usual.copy()
        for place, slot in enumerate(case.slots):
            if slot >= 0:
                own = -0.5 * (run.w[:, slot] ** 2 + np.log(run.s[:, slot]))
                usual[:, place] = np.where(np.isfinite(own), own, 0.0)
        flights.append(replace(flight, tape=replace(flight.tape, usual=usual)))
    return case.with_flights(flights)


def _levelled(case: Case, output: int, runs: Sequence[Pass], without: Sequence[Pass]) -> Case:
    flights = []
    for flight, run, other in zip(case.flights, runs, without, strict=True):
        usual, rows = flight.tape.usual.copy(), standing_rows(flight.tape, output)
        usual[rows, output] -= (other.log_likelihood - run.log_likelihood) / max(len(rows), 1)
        flights.append(replace(flight, tape=replace(flight.tape, usual=usual)))
    return case.with_flights(flights)
