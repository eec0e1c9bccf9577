"""What one supposes of a plant: its coefficients, effects with their parameters, and how restless it is; and how the logs fit that."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from diagnosis.case import Case, Flight
from diagnosis.filter import Noise, Pass
from diagnosis.inputs import commanded
from diagnosis.kit import Kit
from diagnosis.sensors import sensed
from diagnosis.tape import Tape
from sim.effects.effect import Values

Array = NDArray[np.float64]
LEAST_PROCESS = 1e-12  # of the noise intensity of states that are none of an axis' speeds, times their square


@dataclass(frozen=True, eq=False)
class Supposed:
    """Steps `theta` (free,) of the plant's uncertain coefficients in standard deviations, `effects` with their values by symbol, and
    `unrest` (axes,): log10 of the noise on each axis' speed per square root of a second."""

    theta: Array
    effects: Mapping[str, Values]
    unrest: Array

    def with_effects(self, effects: Mapping[str, Values]) -> "Supposed":
        """The same with other effects."""
        return replace(self, effects=effects)


def nothing_supposed(case: Case, unrest: float) -> Supposed:
    """The plant as stated."""
    return Supposed(np.zeros(len(case.free)), {}, np.full(len(case.kit.filter.axes), unrest))


def coefficients(case: Case, supposed: Supposed) -> Array:
    """The vector p of the kit's filter; coefficients that cannot be negative stay where they can be."""
    kit = case.kit
    p = kit.p.copy()
    p[case.free] = kit.bound.p[case.free] + supposed.theta * case.sd
    for place in case.nonnegative:
        p[place] = max(p[place], 1e-3 * kit.bound.p[place])
    for name, values in supposed.effects.items():
        if name in kit.names:
            for symbol, value in values.items():
                p[kit.place(name, symbol)] = value
    return p


def tape_under(case: Case, flight: Flight, effects: Mapping[str, Values]) -> Tape:
    """The flight's tape with what the effects do on the way of the signals."""
    further = {name: values for name, values in effects.items() if name not in case.kit.names}
    if not further:
        return flight.tape
    return _sent(case.kit, flight, tuple((name, tuple(values.items())) for name, values in further.items()))


@lru_cache(maxsize=64)
def _sent(kit: Kit, flight: Flight, effects: tuple[tuple[str, tuple[tuple[str, float], ...]], ...]) -> Tape:
    given = {name: dict(values) for name, values in effects}
    return sensed(kit, commanded(kit, flight.tape, given), given)


def noise_of(case: Case, flight: Flight, supposed: Supposed, rub_s: float) -> Noise:
    """The filter's noise: on each axis' speed its unrest, next to none elsewhere."""
    kit = case.kit
    q = LEAST_PROCESS * np.maximum(np.abs(flight.x0), 1.0) ** 2
    for axis, unrest in zip(kit.bound.model.axes, supposed.unrest, strict=True):
        q[kit.states.index(str(axis.velocity))] = 10.0 ** (2.0 * unrest)
    return Noise(q, np.full(max(1, len(kit.filter.axes)), rub_s), flight.p0)


def passes(
    case: Case,
    supposed: Supposed,
    columns: Sequence[int] = (),
    *,
    slopes: bool = False,
    gains: bool = False,
    rub_s: float = 0.02,
) -> list[Pass] | None:
    """The filter over all flights; None where it left all bounds on one."""
    kit, p = case.kit, coefficients(case, supposed)
    plain = not any(name in kit.names for name in supposed.effects) and all(place < kit.own for place in columns)
    found = []
    for flight in case.flights:
        tape = tape_under(case, flight, supposed.effects)
        noise = noise_of(case, flight, supposed, rub_s)
        chosen, given = (kit.plain, p[: kit.own]) if plain else (kit.filter, p)
        run = chosen.run(
            tape,
            given,
            flight.x0,
            noise,
            case.slots,
            columns=columns,
            keep_slopes=slopes,
            locked=flight.locked,
            keep_gains=gains,
        )
        if run is None or not np.isfinite(run.log_likelihood):
            return None
        found.append(run)
    return found
