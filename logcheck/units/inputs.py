"""Percent, ticks or machine units where volt should be, by what the drive takes and what holds the plant."""

from collections.abc import Iterator

import numpy as np

from logcheck import thresholds
from logcheck.facts import PlantFacts
from logcheck.finding import Found
from logcheck.grid import some
from logcheck.units.slip import greatest_of, slip
from records.errors import BadInput
from records.log import RunLog
from sim.bind import BoundPlant
from sim.equilibrium import equilibrium


def input_unit(log: RunLog, name: str, facts: PlantFacts) -> Iterator[Found]:
    """Percent or ticks where volt should be: far beyond what the drive takes, in every input that moves."""
    for column in log.columns.inputs:
        low, high = facts.limits.get(column, (-np.inf, np.inf))
        widest = max(abs(low), abs(high))
        greatest = greatest_of(some(log.column(column)))
        if not np.isfinite(widest) or not greatest > 3.0 * widest:
            continue
        unit = "percent" if greatest <= thresholds.FULL_percent else "another unit"
        sentence = f"{column} is in {unit}, up to {greatest:.4g} where the plant takes {low:g}..{high:g}"
        yield slip(log, name, column, sentence, "the unit that the column's name states", "convert the column")


def machine_unit(log: RunLog, name: str, bound: BoundPlant, facts: PlantFacts) -> Iterator[Found]:
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
        yield slip(log, name, column, sentence, "volt", f"multiply the inputs by {widest:g}")
