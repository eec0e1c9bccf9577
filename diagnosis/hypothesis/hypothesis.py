"""What one supposes of a plant: its coefficients, effects with their parameters, and how restless it is; and how the logs fit that."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from diagnosis.filter.filter_input import Tape
from diagnosis.filter.kalman import Noise, Pass
from diagnosis.hypothesis.case import Case, Flight
from diagnosis.hypothesis.initial_state import RUB_S
from diagnosis.library.effect_library import Kit, Variant, is_gust, is_lag
from diagnosis.library.gust_state import gust_state
from diagnosis.library.input_effects import commanded
from diagnosis.library.sensor_effects import sensed
from jobs.thread_map import each
from sim.effect import Values

Array = NDArray[np.float64]
SHORTEST_LAG_S = 4e-3  # a shorter one is too stiff for the filter's steps
START_SD = 0.05  # of states that effects brought, in their own units
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
    """The plant as stated, with the effects that its file states."""
    return Supposed(np.zeros(len(case.free)), case.stated, np.full(len(case.kit.bound.model.axes), unrest))


def coefficients(case: Case, variant: Variant, supposed: Supposed) -> Array:
    """The vector p of a variant, whose other effects are off; coefficients that cannot be negative stay where they can be."""
    kit = case.kit
    p = variant.p.copy()
    p[case.free] = kit.bound.p[case.free] + supposed.theta * case.sd
    for place in case.nonnegative:
        p[place] = max(p[place], 1e-3 * kit.bound.p[place])
    p[list(variant.switches.values())] = 0.0
    p[[place for name, place in variant.switches.items() if name in supposed.effects]] = 1.0
    for name, values in supposed.effects.items():
        if name in variant.names:
            for symbol, value in values.items():
                p[variant.place(name, symbol)] = max(value, SHORTEST_LAG_S) if is_lag(name) else value
    return p


def tape_under(case: Case, variant: Variant, flight: Flight, effects: Mapping[str, Values]) -> Tape:
    """The flight's tape with what the effects do on the way of the signals."""
    further = {name: values for name, values in effects.items() if name not in variant.names}
    if not further:
        return flight.tape
    return _sent(case.kit, flight, tuple((name, tuple(values.items())) for name, values in further.items()))


@lru_cache(maxsize=32)
def _sent(kit: Kit, flight: Flight, effects: tuple[tuple[str, tuple[tuple[str, float], ...]], ...]) -> Tape:
    given = {name: dict(values) for name, values in effects}
    return sensed(kit, commanded(kit, flight.tape, given), given)


def noise_of(case: Case, variant: Variant, flight: Flight, supposed: Supposed) -> Noise:
    """The filter's noise: on each axis' speed its unrest, on gusts their own, next to none elsewhere."""
    x0, p0 = start_under(variant, flight)
    q = LEAST_PROCESS * np.maximum(np.abs(x0), 1.0) ** 2
    q[list(case.kit.velocities)] = 10.0 ** (2.0 * supposed.unrest)
    for name in filter(is_gust, supposed.effects):
        place, values = variant.states.index(gust_state(name)), supposed.effects[name]
        q[place], p0[place] = 2.0 * values["sigma"] ** 2 / values["T"], values["sigma"] ** 2
    drive = np.append(flight.drive, np.zeros(len(q) - len(flight.drive)))
    return Noise(q, np.full(max(1, len(variant.filter.axes)), RUB_S), p0, drive, flight.step_s)


def start_under(variant: Variant, flight: Flight) -> tuple[Array, Array]:
    """Where a flight starts and its variances, with what effects brought: a lag at what was read, all else at rest."""
    further = variant.states[len(flight.x0) :]
    own = {f"{name}_read": place for place, name in enumerate(flight.log.columns.outputs)}
    read = [flight.first_read[own[s]] if s in own else 0.0 for s in further]
    sure = [flight.tape.r[0, own[s]] if s in own else START_SD**2 for s in further]
    return np.append(flight.x0, read), np.append(flight.p0, sure)


def passes(
    case: Case,
    supposed: Supposed,
    columns: Sequence[int] = (),
    *,
    slopes: bool = False,
    gains: bool = False,
) -> list[Pass] | None:
    """The filter over all flights; None where it left all bounds on one."""
    variant = case.kit.variant(supposed.effects)
    p = coefficients(case, variant, supposed)

    def over(flight: Flight) -> Pass | None:
        tape = tape_under(case, variant, flight, supposed.effects)
        x0, noise = start_under(variant, flight)[0], noise_of(case, variant, flight, supposed)
        run = variant.filter.run(
            tape,
            p,
            x0,
            noise,
            case.slots,
            columns=columns,
            keep_slopes=slopes,
            locked=flight.locked,
            keep_gains=gains,
        )
        return None if run is None else replace(run, log_likelihood=run.log_likelihood + tape.known)

    runs = each(over, case.flights)
    found = [run for run in runs if run is not None and np.isfinite(run.log_likelihood)]
    return found if len(found) == len(runs) else None
