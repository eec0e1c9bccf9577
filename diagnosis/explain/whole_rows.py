"""A delay of whole sample periods: a plant that is so late, and columns that stand so many rows from their time, give the same log."""

from collections.abc import Iterator

import numpy as np

from diagnosis import decisions
from diagnosis.explain.improved import estimates
from diagnosis.fit.evidence import FittedHypothesis
from diagnosis.hypothesis.case import Case
from records.diagnosis import Estimate, Firmware
from records.reasons import Note
from sim.effect import Effect, Role

COUNTED = {
    1: ("one row", "one sample period"),
    2: ("two rows", "two sample periods"),
    3: ("three rows", "three sample periods"),
}


def whole_rows(case: Case, chosen: FittedHypothesis, firmware: Firmware | None) -> Iterator[Note]:
    """A doubt for each delay of what was `chosen` that may as well be a slip of the log; none where the controller's own code gives the
    log's commands to the bit, as then each stands in the row of its time."""
    if firmware is not None and firmware.bit_exact:
        return
    periods_s = {round(float(np.median(np.diff(flight.filter_input.t_s))), 9) for flight in case.flights}
    if len(periods_s) > 1:  # no one time is whole rows of each log
        return
    (period_s,) = periods_s
    own = estimates(case, chosen)
    for effect in (case.library.effects[name] for name in chosen.effects):
        late = [entry.symbol for entry in effect.parameters if entry.role is Role.LATENESS]
        rows = _rows(own[effect.name][late[0]], period_s) if late else 0
        if rows:
            yield _note(case, effect, own[effect.name][late[0]], rows, period_s, firmware)


def _rows(late: Estimate, period_s: float) -> int:
    """How many whole sample periods an estimate is, 0 where it is none or too unsure to be told from half of one."""
    rows, within_s = round(late.value / period_s), decisions.BEYOND_CHANCE * late.sd
    sure = within_s < period_s / 2.0 and abs(late.value - rows * period_s) <= within_s
    return rows if sure and rows in COUNTED else 0


def _note(case: Case, effect: Effect, late: Estimate, rows: int, period_s: float, firmware: Firmware | None) -> Note:
    count, time = COUNTED[rows]
    tells = "a controller.json beside the log would tell" if firmware is None else "these logs do not tell which"
    said = (
        f"perhaps {_standing(case, effect, count)} in the log, or the plant is so late: the delay that was found, {late.value:.4g} s, "
        f"is {time}; {tells}"
    )
    numbers = {"rows": rows, "delay_s": late.value, "sample_period_s": period_s}
    return Note("columns_early", effect.name, numbers, said)


def _standing(case: Case, effect: Effect, count: str) -> str:
    """Where the columns would stand: readings late, or commands early."""
    places = case.library.bound.model.places
    if effect.place in places.sensors:
        return f"{places.sensors[effect.place].output} stands {count} late"
    names = [str(entry.variable) for place, entry in places.inputs.items() if effect.place in (place, "loop")]
    return f"{' and '.join(names)} {'stands' if len(names) == 1 else 'stand'} {count} early"
