"""What an arithmetic makes of a table's controllers, from which poles and margins of the law that flies are computed."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from design.analysis.migration import STORAGES, stored
from design.direct_form import DeltaForm
from design.schedule import evaluate, schedule_of
from records.table import ControllerTable

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Rounding:
    """An arithmetic by its `name`; `controllers` gives those of a table's axis at the elevations psi_rad (angles,) as they fly."""

    name: str
    controllers: Callable[[ControllerTable, str, Array], tuple[DeltaForm, ...]]


def _float32(table: ControllerTable, axis: str, psi_rad: Array) -> tuple[DeltaForm, ...]:
    rounded = stored(schedule_of(table.axis(axis)), STORAGES["float32"])
    return tuple(evaluate(rounded, float(psi)) for psi in psi_rad)


FLOAT32 = Rounding("float32", _float32)
