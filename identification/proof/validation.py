"""Modules V1 and V2 of seed 000: a controller designed from the identified plant flies the real one, and both flights are compared."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from design.law import FloatLaw
from design.settings import read_settings
from design.table import design
from records.log import RunLog
from records.logs.sidecar import DOUBLE
from records.loops import LOOPS
from records.table import ControllerTable
from sim.bind import BoundPlant
from sim.kernel.law import is_kernel_s
from sim.loop import Wired, fly, fly_law
from sim.manoeuvres import Manoeuvre, flight, steps
from sim.wiring import wiring


@dataclass(frozen=True, eq=False)
class Comparison:
    """Logs of the same flight on the real plant and on the identified one; rms differences by column, in its unit."""

    real: RunLog
    identified: RunLog
    rms: Mapping[str, float]


def compare_flights(identified: BoundPlant, real: BoundPlant) -> Comparison:
    """Design from `identified`, fly the same on both; raises BadInput where no controller can be designed."""
    table, _ = design(identified, read_settings(identified))
    own_flight = flight(identified, table.sample_period_s) if table.loops == LOOPS else steps(identified, table)
    there, here = (_flown(bound, table, own_flight) for bound in (real, identified))
    names = (*there.columns.outputs, *there.columns.inputs)
    rms = {name: float(np.sqrt(np.mean((there.column(name) - here.column(name)) ** 2))) for name in names}
    return Comparison(there, here, rms)


def _flown(bound: BoundPlant, table: ControllerTable, manoeuvre: Manoeuvre) -> RunLog:
    if is_kernel_s(table):
        return fly_law(bound, table, manoeuvre)
    law = Wired(FloatLaw(table), wiring(bound, table.loops))
    return fly(bound, law, manoeuvre, table_digest=table.digest, arithmetic=DOUBLE)
