"""How often the truth lies within the intervals: flights of one plant with other noise each, matched from other starts each."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from identification.frequency.flights.helicopter import sweep_flights
from identification.frequency.flights.sweep import Sweep
from identification.frequency.match.fit import match
from identification.frequency.models.lateral_record import lateral_model, lateral_records
from records.plant import Plant

FACTOR = 1.96  # sd, half of a 95 % interval of a normal distribution


@dataclass(frozen=True, eq=False)
class Repetition:
    """One set of flights: estimates and their sd by parameter, and whether the truth lies within 95 %."""

    seed: int
    J: float
    value: Mapping[str, float]
    sd: Mapping[str, float]
    inside: Mapping[str, bool]


def repetition(plant: Plant, sweep: Sweep, amplitudes: tuple[float, float], repeats: int, seed: int) -> Repetition:
    """Fly and match; the search never begins at the truth, but where `seed` draws it from the file's sd."""
    logs = {k: v for k, v in sweep_flights(plant, sweep, amplitudes, repeats, seed).items() if k != "doublets"}
    model = lateral_model(plant)
    found = match(model, lateral_records(logs, plant), (sweep.low_rad_s, sweep.high_rad_s), seed=seed, from_start=False)
    inside = np.abs(found.theta - model.start) <= FACTOR * found.sd
    return Repetition(
        seed,
        found.J,
        dict(zip(model.names, found.theta.tolist(), strict=True)),
        dict(zip(model.names, found.sd.tolist(), strict=True)),
        dict(zip(model.names, inside.tolist(), strict=True)),
    )


@dataclass(frozen=True)
class FlightOrder:
    """What a repetition depends on; see `repetition`."""

    plant: Plant
    sweep: Sweep
    amplitudes: tuple[float, float]
    repeats: int
    seed: int


def repeat(order: FlightOrder) -> dict[str, Any]:
    """A repetition as plain data, for a worker."""
    return asdict(repetition(order.plant, order.sweep, order.amplitudes, order.repeats, order.seed))
