"""Are columns what they are called? As a diagnosis asks it, before parameters are bent to what is not there."""

from collections.abc import Mapping

from diagnosis.decide.rows import EARLY, LATE, demand_rows
from diagnosis.decide.wiring import demand_wiring
from diagnosis.fit.nominal import plain_fit
from diagnosis.hypothesis.case import make_case
from diagnosis.library.effect_library import effect_library
from records.log import RunLog
from sim.added_effects import without_effects
from sim.bind import BoundPlant


def demand_columns(bound: BoundPlant, logs: Mapping[str, RunLog]) -> None:
    """Raise BadInput where the plant as stated follows the logs once a column is turned, exchanged with another, or moved by rows."""
    if not logs:
        return
    library = effect_library(without_effects(bound) if bound.effects else bound)
    library.prepare()
    case, where = make_case(library, list(logs.values()), stated=bound), ", ".join(logs)
    demand_wiring(case, plain_fit(case), plain_fit, where)
    demand_rows(case, plain_fit, where, (LATE, EARLY))
