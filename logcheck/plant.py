"""What a log's numbers say against the plant that it names: stops, limits, encoder grids, units."""

from collections.abc import Iterator

import numpy as np

from logcheck import thresholds
from logcheck.facts import PlantFacts
from logcheck.finding import EXCLUDE, NOTE, REFUSE, Finding, Found, in_words
from logcheck.grid import grid_findings
from logcheck.leaps.motion import exchange_findings, motion_findings
from logcheck.leaps.turned import turned_findings
from logcheck.stands.standing import locked_findings, off_findings
from logcheck.units.angle import angle_unit
from logcheck.units.derived import rate_unit, reference_unit, rotor_unit
from logcheck.units.inputs import input_unit, machine_unit
from records.log import RunLog
from records.logs.clock import finer_unit
from sim.bind import BoundPlant


def plant_findings(log: RunLog, name: str, bound: BoundPlant, facts: PlantFacts) -> Iterator[Found]:
    """What is odd about the numbers of a log of this plant."""
    odd = [
        *_time_unit(log, name, bound),
        *_wider_period(log, name, bound),
        *exchange_findings(log, name, bound),
        *turned_findings(log, name, bound, facts),
    ]
    yield from odd
    if any(entry.finding.severity == REFUSE for entry in odd):
        return
    slips = [slip for column in log.columns.outputs for slip in angle_unit(log, name, column, bound, facts)]
    slips += [*input_unit(log, name, facts), *machine_unit(log, name, bound, facts)]
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


def _wider_period(log: RunLog, name: str, bound: BoundPlant) -> Iterator[Found]:
    """Rows of a closed loop whole periods of the plant's controller apart, where neither table nor number tells whether there were more."""
    own_s = bound.plant.design.get("sample_period_s")
    if (
        log.loop != "closed"
        or log.table_digest is not None
        or log.seq is not None
        or not isinstance(own_s, float)
        or own_s <= 0.0
    ):
        return
    times = log.sample_period_s / own_s
    if round(times) < 2 or abs(times / round(times) - 1.0) > thresholds.OF_SO_MANY:
        return
    wider_s = log.sample_period_s
    sentence = (
        f"rows are {wider_s:g} s apart, by the sidecar too, where the plant file's controller runs every {own_s:g} s: taken as all "
        f"samples of a loop of {wider_s:g} s, as nothing in the log tells; if only 1 in {round(times)} was written, state "
        f"sample_period_s = {own_s:g} in the sidecar"
    )
    span = (float(log.t_s[0]), float(log.t_s[-1]))
    yield Found(Finding("wider_period", name, "t_s", *span, sentence, NOTE, 0, "", ""))


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
