"""What a log's numbers say against the plant that it names: stops, limits, encoder grids, units."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from logcheck import thresholds
from logcheck.derived_units import rate_unit, reference_unit, rotor_unit
from logcheck.finding import EXCLUDE, NOTE, REFUSE, Array, Finding, Found, in_words
from logcheck.grid import are_whole, grid_findings, is_on, some
from logcheck.motion import exchange_findings, motion_findings
from logcheck.scale import misfit
from logcheck.standing import locked_findings, off_findings
from records.errors import BadInput
from records.log import RunLog
from records.logs.clock import finer_unit
from sim.bind import BoundPlant
from sim.equilibrium import equilibrium

DEGREE = np.degrees(1.0)


@dataclass(frozen=True)
class PlantFacts:
    """What a plant fixes about its logs: encoder steps by output, limits by input, stops by output, outputs that are an axis' position."""

    steps: Mapping[str, float]
    limits: Mapping[str, tuple[float, float]]
    stops: Mapping[str, tuple[float, float]]
    positions: frozenset[str]


def plant_facts(bound: BoundPlant) -> PlantFacts:
    """Steps, limits and stops of a bound plant; those that it has not are left out."""
    model = bound.model
    stops = {
        str(axis.position): (bound.number(axis.lower), bound.number(axis.upper))
        for axis in model.axes
        if axis.position is not None and axis.lower is not None and axis.upper is not None
    }
    limits = {str(variable): bound.limits(variable) for variable in model.inputs}
    axes = {str(axis.position) for axis in model.axes}
    positions = frozenset(output for output, expression in model.outputs.items() if str(expression) in axes)
    return PlantFacts(dict(bound.plant.sensors), limits, stops, positions)


def plant_findings(log: RunLog, name: str, bound: BoundPlant, facts: PlantFacts) -> Iterator[Found]:
    """What is odd about the numbers of a log of this plant."""
    slow = [*_time_unit(log, name, bound), *exchange_findings(log, name, bound)]
    yield from slow
    if any(entry.finding.severity == REFUSE for entry in slow):
        return
    slips = [slip for column in log.columns.outputs for slip in _angle_unit(log, name, column, bound, facts)]
    slips += [*_input_unit(log, name, facts), *_machine_unit(log, name, bound, facts)]
    yield from slips
    if slips:  # everything else would follow from the wrong unit
        return
    for column in log.columns.outputs:
        yield from _stops(log, name, column, facts)
        yield from grid_findings(log, name, column, facts.steps.get(column, 0.0))
        yield from reference_unit(log, name, column)
    yield from locked_findings(log, name, bound)
    yield from off_findings(log, name, bound, facts.steps)
    yield from motion_findings(log, name, bound)
    yield from rate_unit(log, name, bound.model)
    yield from rotor_unit(log, name, bound, facts.limits)


def _time_unit(log: RunLog, name: str, bound: BoundPlant) -> Iterator[Found]:
    """Rows so far apart that no axis shows its motion in them, by the sidecar too: both count in another unit."""
    period_s = log.sample_period_s
    if period_s < thresholds.SLOW_S or not bound.model.axes:
        return
    severity = REFUSE if period_s >= thresholds.STANDING_S else NOTE
    sentence = f"rows are {period_s:g} s apart, by the sidecar too: are these {finer_unit(period_s)[0]}?"
    span = (float(log.t_s[0]), float(log.t_s[-1]))
    expected, remedy = "t_s and sample_period_s in seconds", "convert both to seconds"
    yield Found(Finding("time_unit", name, "t_s", *span, sentence, severity, 0, expected, remedy))


def _angle_unit(log: RunLog, name: str, column: str, bound: BoundPlant, facts: PlantFacts) -> Iterator[Found]:
    """Degrees or counts where radians should be, where the numbers are an angle of the plant in that unit; else no angle at all.

    Steps of a sensor in degrees may be those of a coarser one in radians, and whole degrees counts: the plant's own motion tells.
    """
    values = some(log.column(column))
    if not column.endswith("_rad") or values.size < 2 or values.min() == values.max():
        return
    widest, greatest = _widest(column, facts), _greatest(values)
    is_beyond = np.isfinite(widest) and greatest > max(
        thresholds.FAR_BEYOND * widest, widest + 3.0 * thresholds.BEYOND_STOP_rad
    )
    unit = _unit_by_motion(log, column, bound, facts, is_beyond)
    if unit is not None:
        sentence = f"{column} is in {unit}: up to {greatest:.4g}"
        yield _slip(log, name, column, sentence, "radians", "convert the column to radians")
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
    if unit == "encoder counts":
        return unit if is_beyond or found[unit] <= in_radians else None
    way = _greatest(values) / DEGREE
    by_size = is_beyond and way > thresholds.LEAST_OF_STOP * _widest(column, facts)
    in_steps = step > 0.0 and is_on(values, step * DEGREE)
    by_steps = in_steps and (is_beyond or found[unit] < in_radians)
    return unit if by_size or by_steps or found[unit] * thresholds.MOTION_TELLS < in_radians else None


def _possible_units(values: Array, step: float, widest: float) -> dict[str, float]:
    """Units other than radians in which the numbers stay within the stops, with what of each is one radian."""
    greatest, found = _greatest(values), dict[str, float]()
    most = min(widest, thresholds.MOST_rad) + thresholds.BEYOND_STOP_rad
    if step > 0.0 and are_whole(values) and 3.0 < greatest <= most / step:
        found["encoder counts"] = 1.0 / step
    if greatest / DEGREE <= widest + thresholds.BEYOND_STOP_rad:
        found["degrees"] = DEGREE
    return found


def _no_angle(log: RunLog, name: str, column: str, facts: PlantFacts) -> Found:
    """An output far beyond its stops in no unit that is known: exchanged with another where both would fit, else only that."""
    widest, greatest = _widest(column, facts), _greatest(some(log.column(column)))
    sentence = f"{column} is up to {greatest:.4g}, far beyond its axis' stop at {widest:.4g}"
    span = (float(log.t_s[0]), float(log.t_s[-1]))
    for other in log.columns.outputs:
        others = some(log.column(other))
        fits = greatest <= _widest(other, facts) + thresholds.BEYOND_STOP_rad if other in facts.stops else False
        if fits and others.size and _greatest(others) <= widest + thresholds.BEYOND_STOP_rad:
            sentence += f", and {other} up to {_greatest(others):.4g}: each would fit in the other's place"
            expected, remedy = "columns that are what they are called", f"exchange {column} and {other}"
            return Found(Finding("exchanged_columns", name, column, *span, sentence, REFUSE, 0, expected, remedy))
    sentence += ": no angle of this plant"
    remedy = "see whether it is another column, another unit or another plant's log"
    return Found(Finding("no_angle", name, column, *span, sentence, REFUSE, 0, "an angle within the stops", remedy))


def _widest(column: str, facts: PlantFacts) -> float:
    """The farther of an output's stops from zero; infinite where it has none."""
    low, high = facts.stops.get(column, (-np.inf, np.inf))
    return max(abs(low), abs(high))


def _greatest(values: Array) -> float:
    """How far values are from zero, but for single rows, which may be wrong in any unit."""
    return float(np.quantile(np.abs(values), thresholds.UNIT_QUANTILE))


def _input_unit(log: RunLog, name: str, facts: PlantFacts) -> Iterator[Found]:
    """Percent or ticks where volt should be: far beyond what the drive takes, in every input that moves."""
    for column in log.columns.inputs:
        low, high = facts.limits.get(column, (-np.inf, np.inf))
        widest = max(abs(low), abs(high))
        greatest = _greatest(some(log.column(column)))
        if not np.isfinite(widest) or not greatest > 3.0 * widest:
            continue
        unit = "percent" if greatest <= thresholds.FULL_percent else "another unit"
        sentence = f"{column} is in {unit}, up to {greatest:.4g} where the plant takes {low:g}..{high:g}"
        yield _slip(log, name, column, sentence, "the unit that the column's name states", "convert the column")


def _machine_unit(log: RunLog, name: str, bound: BoundPlant, facts: PlantFacts) -> Iterator[Found]:
    """Machine units, 1 at full scale: an input within -1..1 that holds the plant with a tenth of what it needs."""
    arm = next((axis for axis in bound.model.axes if axis.position is not None), None)
    if not log.columns.inputs or arm is None or str(arm.position) != log.columns.outputs[0]:
        return
    column = log.columns.inputs[0]
    low, high = facts.limits.get(column, (-np.inf, np.inf))
    widest = max(abs(low), abs(high))
    present = np.isfinite(log.y[:, 0])
    if not np.isfinite(widest) or np.abs(log.u[:, 0]).max() > 1.05 or widest < 5.0 or not present.any():
        return
    try:
        needed = float(equilibrium(bound, float(np.median(log.y[present, 0]))).u0[0])
    except BadInput:
        return
    held = float(np.median(log.u[present, 0])) * widest
    if abs(needed) > 0.2 * widest and 1.0 / thresholds.MACHINE_CLOSE < held / needed < thresholds.MACHINE_CLOSE:
        sentence = f"{column} is in machine units, 1 for {widest:g} V: the plant needs {needed:.3g} V to hold its angle"
        yield _slip(log, name, column, sentence, "volt", f"multiply the inputs by {widest:g}")


def _slip(log: RunLog, name: str, column: str, sentence: str, expected: str, remedy: str) -> Found:
    span = (float(log.t_s[0]), float(log.t_s[-1]))
    return Found(Finding("unit_slip", name, column, *span, sentence, REFUSE, 0, expected, remedy))


def _stops(log: RunLog, name: str, column: str, facts: PlantFacts) -> Iterator[Found]:
    """Rows beyond a stop: a little is a matter of the sensor, much is no measurement."""
    if column not in facts.stops:
        return
    (low, high), values = facts.stops[column], log.column(column)
    margin = thresholds.BEYOND_STOP_rad + facts.steps.get(column, 0.0)
    with np.errstate(invalid="ignore"):
        far = (values < low - margin) | (values > high + margin)
        near = ((values < low - facts.steps.get(column, 0.0)) | (values > high + facts.steps.get(column, 0.0))) & ~far
    for kind, rows, severity, what in (
        ("beyond_stops", far, EXCLUDE, "; left out"),
        ("beyond_stops", near, NOTE, ": the sensor's zero or scale is not the plant's"),
    ):
        if rows.any():
            at, count = log.t_s[rows], int(rows.sum())
            sentence = f"{column} is beyond its stops {low:.4g}..{high:.4g} in {in_words(count, 'row')}, first at {at[0]:g} s{what}"
            left_out = rows if severity == EXCLUDE else None
            finding = Finding(
                kind, name, column, float(at[0]), float(at[-1]), sentence, severity, count * (left_out is not None)
            )
            yield Found(finding, left_out)
