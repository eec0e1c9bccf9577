"""Modules V1 and V2 of seed 000: a controller designed from the identified plant flies the real one, and both flights are compared."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from design.settings import read_settings
from design.table import design
from records.log import RunLog
from sim.bind import BoundPlant
from sim.loop import fly_law
from sim.manoeuvres import flight


@dataclass(frozen=True, eq=False)
class Comparison:
    """Logs of the same flight on the real plant and on the identified one; rms differences by column, in its unit."""

    real: RunLog
    identified: RunLog
    rms: Mapping[str, float]


def compare_flights(identified: BoundPlant, real: BoundPlant) -> Comparison:
    """Design from `identified`, fly the project's flight on both; raises BadInput where no controller can be designed."""
    table, _ = design(identified, read_settings(identified))
    manoeuvre = flight(identified, table.sample_period_s)
    there, here = fly_law(real, table, manoeuvre), fly_law(identified, table, manoeuvre)
    names = (*there.columns.outputs, *there.columns.inputs)
    rms = {name: float(np.sqrt(np.mean((there.column(name) - here.column(name)) ** 2))) for name in names}
    return Comparison(there, here, rms)
