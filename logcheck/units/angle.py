"""Degrees or counts where radians should be, by the stops, the sensor's grid and how the plant moves."""

from collections.abc import Iterator

import numpy as np

from logcheck import thresholds
from logcheck.facts import PlantFacts
from logcheck.finding import REFUSE, Array, Finding, Found
from logcheck.grid import are_whole, is_on, some
from logcheck.units.scale import misfit
from logcheck.units.slip import greatest_of, slip
from records.log import RunLog
from sim.bind import BoundPlant

DEGREE = np.degrees(1.0)
COUNTS = "encoder counts"


def angle_unit(log: RunLog, name: str, column: str, bound: BoundPlant, facts: PlantFacts) -> Iterator[Found]:
    """Degrees or counts where radians should be, where the numbers are an angle of the plant in that unit; else no angle at all.

    Steps of a sensor in degrees may be those of a coarser one in radians, and whole degrees counts: the plant's own motion tells.
    """
    values = some(log.column(column))
    if not column.endswith("_rad") or values.size < 2 or values.min() == values.max():
        return
    widest, greatest = _widest(column, facts), greatest_of(values)
    is_beyond = np.isfinite(widest) and greatest > max(
        thresholds.FAR_BEYOND * widest, widest + 3.0 * thresholds.BEYOND_STOP_rad
    )
    unit = _unit_by_motion(log, column, bound, facts, is_beyond)
    if unit is not None:
        sentence = f"{column} is in {unit}: up to {greatest:.4g}"
        yield slip(log, name, column, sentence, "radians", "convert the column to radians")
    elif is_beyond:
        yield _no_angle(log, name, column, facts)


def _unit_by_motion(log: RunLog, column: str, bound: BoundPlant, facts: PlantFacts, is_beyond: bool) -> str | None:
    """The unit of an angle's numbers, None for radians and for none that is known; `is_beyond` of its stops as radians.

    Readings on the sensor's grid are radians, unless they are as round as degrees are. Counts are whole, and degrees of the size of the
    axis' way, or on the sensor's grid in degrees, or such as the plant clearly moves by.
    """
    values, step = some(log.column(column)), facts.steps.get(column, 0.0)
    if step > 0.0 and is_on(values, step) and not are_whole(values / thresholds.ROUND_deg):
        return None
    possible = _possible_units(values, step, _widest(column, facts))

    def of(scale: float) -> float:
        return misfit(log, bound, column, scale) if column in facts.positions else np.inf

    if not possible:
        return None
    in_radians, found = of(1.0), {unit: of(scale) for unit, scale in possible.items()}
    unit = min(found, key=lambda each: found[each])
    if unit == COUNTS:
        return unit if is_beyond or found[unit] <= in_radians else None
    way = greatest_of(values) / DEGREE
    by_size = is_beyond and way > thresholds.LEAST_OF_STOP * _widest(column, facts)
    in_steps = step > 0.0 and is_on(values, step * DEGREE)
    by_steps = in_steps and (is_beyond or found[unit] < in_radians)
    return unit if by_size or by_steps or found[unit] * thresholds.MOTION_TELLS < in_radians else None


def _possible_units(values: Array, step: float, widest: float) -> dict[str, float]:
    """Units other than radians in which the numbers stay within the stops, with what of each is one radian."""
    greatest, found = greatest_of(values), dict[str, float]()
    most = min(widest, thresholds.MOST_rad) + thresholds.BEYOND_STOP_rad
    if step > 0.0 and are_whole(values) and 3.0 < greatest <= most / step:
        found[COUNTS] = 1.0 / step
    if greatest / DEGREE <= widest + thresholds.BEYOND_STOP_rad:
        found["degrees"] = DEGREE
    return found


def _no_angle(log: RunLog, name: str, column: str, facts: PlantFacts) -> Found:
    """An output far beyond its stops in no unit that is known: exchanged with another where both would fit, else only that."""
    widest, greatest = _widest(column, facts), greatest_of(some(log.column(column)))
    sentence = f"{column} is up to {greatest:.4g}, far beyond its axis' stop at {widest:.4g}"
    span = (float(log.t_s[0]), float(log.t_s[-1]))
    for other in log.columns.outputs:
        others = some(log.column(other))
        fits = greatest <= _widest(other, facts) + thresholds.BEYOND_STOP_rad if other in facts.stops else False
        if fits and others.size and greatest_of(others) <= widest + thresholds.BEYOND_STOP_rad:
            sentence += f", and {other} up to {greatest_of(others):.4g}: each would fit in the other's place"
            expected, remedy = "columns that are what they are called", f"exchange {column} and {other}"
            return Found(Finding("exchanged_columns", name, column, *span, sentence, REFUSE, 0, expected, remedy))
    sentence += ": no angle of this plant"
    remedy = "see whether it is another column, another unit or another plant's log"
    return Found(Finding("no_angle", name, column, *span, sentence, REFUSE, 0, "an angle within the stops", remedy))


def _widest(column: str, facts: PlantFacts) -> float:
    """The farther of an output's stops from zero; infinite where it has none."""
    low, high = facts.stops.get(column, (-np.inf, np.inf))
    return max(abs(low), abs(high))
