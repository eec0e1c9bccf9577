"""Angles that no mass could have: as far from row to row as over the whole run."""

from collections.abc import Iterator

import numpy as np

from logcheck import thresholds
from logcheck.finding import REFUSE, Finding, Found
from records.log import RunLog
from sim.bind import BoundPlant


def motion_findings(log: RunLog, name: str, bound: BoundPlant) -> Iterator[Found]:
    """Outputs that are an axis' position and whose rows know nothing of each other: noise, or rows that were shuffled."""
    positions = {str(axis.position) for axis in bound.model.axes if axis.position is not None}
    for column, expression in bound.model.outputs.items():
        read = log.column(column)[np.isfinite(log.column(column))]
        step = bound.plant.sensors.get(column, 0.0)
        if str(expression) not in positions or step <= 0.0 or read.size < 3:
            continue
        usual = float(np.median(np.abs(read - np.median(read))))
        jump = float(np.median(np.abs(np.diff(read))))
        if usual > thresholds.LEAST_MOTION_STEPS * step and jump > thresholds.JUMPS_RATIO * usual:
            span = (float(log.t_s[0]), float(log.t_s[-1]))
            sentence = (
                f"{column} jumps by {jump:.3g} from row to row, as far as it is from its middle: rows without order"
            )
            remedy = f"check the order of the rows and what was read as {column}"
            yield Found(Finding("no_motion", name, column, *span, sentence, REFUSE, 0, "an angle that moves", remedy))
