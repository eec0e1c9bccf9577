"""Commands that stand in other rows than those of their time: logged a row or two late, or early.

A plant that answers before its command was logged is against all causes, so the log is wrong. One that answers late may be so itself.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from diagnosis import decisions
from diagnosis.decide.wiring import as_stated, fitted_or_none, is_strained
from diagnosis.filter.filter_input import beginning
from diagnosis.fit.nominal import gain_over, plain_fit, settled
from diagnosis.hypothesis.case import Case
from jobs.thread_map import thread_map
from records.errors import BadInput
from records.reasons import Note

LATE, EARLY = 1, -1
NUMBERS = {1: "one row", 2: "two rows", 3: "three rows"}
Array = NDArray[np.float64]


@dataclass(frozen=True)
class Misplaced:
    """Inputs, by their place, that stand so many rows late in the logs (below zero: early)."""

    inputs: tuple[int, ...]
    rows: int


def demand_rows(case: Case, where: str, ways: Sequence[int] = (LATE,)) -> None:
    """Raise BadInput where the plant as stated follows the logs once their commands are moved by whole rows.

    `where` says which logs they are, `ways` whether late or early commands are looked for.
    """
    found = misplaced(case, ways)
    if found is None:
        return
    slip, gain = found
    names, rows = _names(case, slip), NUMBERS[abs(slip.rows)]
    remedy = f"move {names} {'up' if slip.rows > 0 else 'down'} by {rows}"
    if slip.rows < 0:
        remedy += "; where the rig itself is late, `twinlaw diagnose` adds that to its model"
    raise BadInput(
        what="columns",
        where=where,
        got=f"{_in_words(case, slip)}: moved by that, the plant follows {gain:.0f} nats better",
        expected="commands in the rows of their time",
        remedy=remedy,
    )


def early_note(case: Case) -> tuple[Note, ...]:
    """That the commands may stand some rows early in the logs, where moving them explains these; none where it does not."""
    found = misplaced(case, (EARLY,))
    if found is None:
        return ()
    slip, gain = found
    said = f"{_in_words(case, slip)}: moved by that, the plant follows {gain:.0f} nats better"
    return (Note("commands_early", _names(case, slip), {"rows": -slip.rows, "gain_nats": gain}, said),)


def _in_words(case: Case, slip: Misplaced) -> str:
    verb, rows = "stands" if len(slip.inputs) == 1 else "stand", NUMBERS[abs(slip.rows)]
    late = f"{rows} late in the log" if slip.rows > 0 else f"{rows} early in the log, or the plant is so late"
    return f"{_names(case, slip)} {verb} {late}"


def _names(case: Case, slip: Misplaced) -> str:
    return " and ".join(str(case.library.bound.model.inputs[place]) for place in slip.inputs)


def misplaced(case: Case, ways: Sequence[int]) -> tuple[Misplaced, float] | None:
    """The inputs that stand in other rows than those of their time, and what it gains in nats to move them; None where none do."""
    short = case.with_flights(
        [replace(flight, filter_input=beginning(flight.filter_input, decisions.ROWS_S)) for flight in case.flights]
    )
    tried = list(_by_one_row(len(case.library.bound.model.inputs), ways))
    least, *stated = thread_map(as_stated, [short, *(moved(short, slip) for slip in tried)])
    slips = [slip for slip, value in zip(tried, stated, strict=True) if value > least]
    usual = fitted_or_none(short, plain_fit) if slips else None
    if usual is None:
        return None
    start = usual.hypothesis

    def followed(slip: Misplaced) -> tuple[float, bool]:
        fit = fitted_or_none(moved(short, slip), lambda case: settled(case, start))
        return (-np.inf, False) if fit is None else (gain_over(short, usual, fit), not is_strained(case, fit))

    found = zip(slips, thread_map(followed, slips), strict=True)
    for slip, told in sorted(found, key=lambda entry: -entry[1][0]):
        slip, (gain, follows) = _furthest(slip, told, followed)
        if follows and gain > decisions.ROWS_GAIN:
            return slip, gain
    return None


def _furthest(
    slip: Misplaced, told: tuple[float, bool], followed: Callable[[Misplaced], tuple[float, bool]]
) -> tuple[Misplaced, tuple[float, bool]]:
    """A slip by as many rows more as each gains, with what it gains and whether the plant then follows."""
    while told[0] > 0.0 and abs(slip.rows) < max(NUMBERS):
        further = replace(slip, rows=slip.rows + int(np.sign(slip.rows)))
        more = followed(further)
        if more[0] <= told[0]:
            break
        slip, told = further, more
    return slip, told


def _by_one_row(inputs: int, ways: Sequence[int]) -> Iterator[Misplaced]:
    """All inputs, and each by itself, a row late or early."""
    together = tuple(range(inputs))
    for way in ways:
        yield Misplaced(together, way)
        if inputs > 1:
            yield from (Misplaced((place,), way) for place in together)


def moved(case: Case, slip: Misplaced) -> Case:
    """The case with commands in the rows to which they belong."""
    flights = []
    for flight in case.flights:
        u = flight.filter_input.u.copy()
        source = np.clip(np.arange(len(u)) + slip.rows, 0, len(u) - 1)
        for place in slip.inputs:
            u[:, place] = flight.filter_input.u[source, place]
        flights.append(replace(flight, filter_input=replace(flight.filter_input, u=u)))
    return case.with_flights(flights)
