"""Columns that stand in other rows than those of their time: logged a row or two late, or early.

A plant that answers before its command was logged is against all causes, so the log is wrong. One that answers late may be so itself.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import chain
from typing import Any

import numpy as np
from numpy.typing import NDArray

from diagnosis import decisions
from diagnosis.decide.columns import (
    is_as_good,
    is_refused,
    is_strained,
    is_told,
    looked_at,
    settled_or_none,
    with_usual_forces,
)
from diagnosis.detect.linearisation import linearised
from diagnosis.detect.score_tests import score_effects
from diagnosis.filter.filter_input import READINGS, FilterInput
from diagnosis.fit.evidence import FittedHypothesis
from diagnosis.fit.gauss_newton import fit
from diagnosis.fit.linear_problem import Fit
from diagnosis.fit.nominal import fitted_from, gain_over
from diagnosis.hypothesis.case import Case, FilteredLog
from diagnosis.hypothesis.hypothesis import nominal_hypothesis
from diagnosis.hypothesis.initial_state import start_of
from jobs.thread_map import thread_map
from records.errors import BadInput
from records.reasons import Note

LATE, EARLY = 1, -1
NUMBERS = {1: "one row", 2: "two rows", 3: "three rows"}
OTHER_ROWS = ("columns_late", "columns_early")  # kinds of notes
Array = NDArray[np.float64]


@dataclass(frozen=True)
class Misplaced:
    """Inputs, and outputs, by their place, that stand so many rows late in the logs (below zero: early)."""

    inputs: tuple[int, ...]
    rows: int
    outputs: tuple[int, ...] = ()

    @property
    def way(self) -> int:
        """LATE where the plant would have to answer before its commands, EARLY where it may be late itself."""
        return int(np.sign(self.rows)) * (LATE if self.inputs else EARLY)

    def further(self) -> "Misplaced":
        """The same by a row more."""
        return replace(self, rows=self.rows + int(np.sign(self.rows)))


@dataclass(frozen=True)
class ColumnShift:
    """What it gains, in nats, to move columns, and whether the plant then follows the logs; which other moves gain about as much; and
    where the plant's fit to the moved columns ended."""

    slip: Misplaced
    gain: float
    follows: bool
    alike: tuple[Misplaced, ...] = ()
    end: Fit | None = None


def demand_rows(
    case: Case, nominal: Fit, where: str, ways: Sequence[int] = (LATE,), beaten: float = 0.0
) -> tuple[Note, ...]:
    """What is to be known of the rows in which columns stand: that some may be others, or that these logs do not tell.

    Raises BadInput where the plant follows the logs once columns are moved by whole rows, in one of the `ways` that are no plant's own,
    and by more than LOGS_DOUBTED better; but where an effect promises more than that, the logs are those of a rig that has it.
    `nominal` is the plant's fit to the logs as they are, or to a part; `where` says which logs they are. `beaten` are the nats by which
    another reading of the inputs between rows is likelier than this one: a move must be likelier than that too; nothing else is told then.
    """
    short = looked_at(case)
    plain = settled_or_none(short, nominal.hypothesis)
    if plain is None:
        return ()
    usual = with_usual_forces(short, plain)
    found, commands = misplaced(Asked(short, usual))
    if beaten and (found is None or found.gain < beaten + decisions.TAKEN_IN):
        return ()
    if found is None:
        return _unseen(commands)
    if not (found.follows and found.slip.way in ways and is_refused(found.gain - beaten)):
        return (_note(case, found),)
    if most_by_an_effect(short, _from_the_moved(short, usual, found)) > found.gain - beaten:
        return ()
    remedy = ", or ".join(_move(case, slip) for slip in (found.slip, *found.alike))
    if found.slip.way == EARLY:
        remedy += "; where the rig itself is late, `twinlaw diagnose` adds that to its model"
    raise BadInput(
        what="columns",
        where=where,
        got=_in_words(case, found),
        expected="columns in the rows of their time",
        remedy=remedy,
    )


def _from_the_moved(case: Case, usual: Fit, found: ColumnShift) -> Fit:
    """The plant's fit to the logs as they are from where that to the moved columns ended, where that is the better one: where the plant
    follows the logs by nothing, slopes promise anything."""
    assert found.end is not None
    there = fitted_from(case, found.end)
    return there if there is not None and there.log_posterior > usual.log_posterior else usual


def most_by_an_effect(case: Case, usual: Fit) -> float:
    """What the best effect gains beside the plant's fit, in nats, as a score test promises it."""
    tests = score_effects(case, linearised(case, usual), case.library.candidates)
    return max((entry.gain for entry in tests), default=0.0)


def rows_in_doubt(case: Case, found: FittedHypothesis, notes: Sequence[Note]) -> tuple[Note, ...]:
    """The notes without those on columns in other rows, where what was found explains them: a lag or a delay follows the plant as a column
    that stands early does, and beside it moving columns gains nothing."""
    if not any(note.kind in OTHER_ROWS for note in notes):
        return tuple(notes)
    short = looked_at(case)
    usual = fit(short, found.fit.hypothesis, rounds=0)
    if usual is None:
        return tuple(notes)
    asked, model = Asked(short, usual), case.library.bound.model
    slips = (*asked.commands, *_one_column(len(model.inputs), len(model.outputs)))
    gain = max(thread_map(asked.promised, slips), default=-np.inf)
    return tuple(note for note in notes if is_told(gain) or note.kind not in OTHER_ROWS)


@dataclass(frozen=True)
class Asked:
    """Logs as they are with the plant's fit to them, asked what it gains to move columns."""

    case: Case
    usual: Fit

    def promised(self, slip: Misplaced) -> float:
        """What a move gains, in nats, to first order in all that the plant's fit may then move; -inf where the filter fails."""
        at = fit(moved(self.case, slip), self.usual.hypothesis, rounds=0)
        return (
            -np.inf if at is None else at.log_posterior + at.promised - self.usual.log_posterior - self.usual.promised
        )

    def moved(self, slip: Misplaced) -> ColumnShift:
        """What a move gains once the plant is fitted to it, from where its fit to the logs as they are ended and afresh: numbers that make
        up for a command at a wrong time may lie where no slope leads back from."""
        other = moved(self.case, slip)
        afresh = nominal_hypothesis(self.case, float(decisions.FIRST_PROCESS_NOISE))
        ends = [
            found for start in (self.usual.hypothesis, afresh) if (found := settled_or_none(other, start)) is not None
        ]
        if not ends:
            return ColumnShift(slip, -np.inf, False)
        end = max(ends, key=lambda found: found.log_posterior)
        return ColumnShift(slip, gain_over(self.case, self.usual, end), not is_strained(other, end), end=end)

    @property
    def commands(self) -> tuple[Misplaced, ...]:
        """All inputs a row late and early; of a plant without an input nothing can be moved so."""
        every = tuple(range(len(self.case.library.bound.model.inputs)))
        return (Misplaced(every, 1), Misplaced(every, -1)) if every else ()


def misplaced(asked: Asked) -> tuple[ColumnShift | None, tuple[float, ...]]:
    """The columns that stand in other rows than those of their time, None where none do; and what it promises, in nats, to move all inputs
    by a row, late and early."""
    model = asked.case.library.bound.model
    slips = (*asked.commands, *_one_column(len(model.inputs), len(model.outputs)))
    promised = dict(zip(slips, thread_map(asked.promised, slips), strict=True))
    commands = tuple(promised[slip] for slip in asked.commands)
    least = decisions.PROMISED_SHARE * decisions.PLAIN_TO_SEE
    likelier = sorted((slip for slip in slips if promised[slip] > least), key=lambda slip: -promised[slip])
    ones = thread_map(asked.moved, likelier[: decisions.NEXT])
    for one in sorted(ones, key=lambda one: (-one.follows, -one.gain)):
        found = _furthest(one, asked.moved)
        if is_told(found.gain):
            alike = tuple(
                other.slip
                for other in ones
                if other not in (one, found) and other.slip.way == found.slip.way and is_as_good(other.gain, found.gain)
            )
            return replace(found, alike=alike), commands
    return None, commands


def _unseen(commands: Sequence[float]) -> tuple[Note, ...]:
    """That the logs do not tell in which rows the commands stand, where a row more or less would not show."""
    if not commands or is_told(-max(commands)):
        return ()
    up, down = commands
    said = (
        f"a shift of one row cannot be seen in these logs: with the commands one row up the plant follows {_better(up)}, "
        f"one row down {_better(down)}; {float(decisions.PLAIN_TO_SEE):.0f} nats would tell"
    )
    return (Note("rows_unseen", "inputs", {"up_nats": up, "down_nats": down}, said),)


def _better(gain: float) -> str:
    return f"{abs(gain):.2g} nats {'better' if gain > 0.0 else 'worse'}" if np.isfinite(gain) else "not at all"


def _furthest(found: ColumnShift, asked: Callable[[Misplaced], ColumnShift]) -> ColumnShift:
    """The same by as many rows more as each gains."""
    while found.gain > 0.0 and abs(found.slip.rows) < max(NUMBERS):
        more = asked(found.slip.further())
        if more.gain <= found.gain:
            break
        found = more
    return found


def _note(case: Case, found: ColumnShift) -> Note:
    late, early = OTHER_ROWS
    kind = late if found.slip.way == LATE else early
    numbers = {"rows": found.slip.rows, "gain_nats": found.gain}
    return Note(kind, _names(case, found.slip), numbers, f"perhaps {_in_words(case, found)}")


def _in_words(case: Case, found: ColumnShift) -> str:
    where = ", or ".join(_standing(case, slip) for slip in (found.slip, *found.alike))
    if found.slip.way == EARLY:
        where += ", or the plant is so late"
    return f"{where}: moved by that, the plant follows {found.gain:.0f} nats better"


def _standing(case: Case, slip: Misplaced) -> str:
    verb = "stands" if len(slip.inputs + slip.outputs) == 1 else "stand"
    return f"{_names(case, slip)} {verb} {NUMBERS[abs(slip.rows)]} {'late' if slip.rows > 0 else 'early'} in the log"


def _move(case: Case, slip: Misplaced) -> str:
    return f"move {_names(case, slip)} {'up' if slip.rows > 0 else 'down'} by {NUMBERS[abs(slip.rows)]}"


def _names(case: Case, slip: Misplaced) -> str:
    model = case.library.bound.model
    outputs = list(model.outputs)
    return " and ".join([*(str(model.inputs[n]) for n in slip.inputs), *(outputs[n] for n in slip.outputs)])


def _one_column(inputs: int, outputs: int) -> Iterator[Misplaced]:
    """Each column by itself where there are others of its kind, a row late or early."""
    for rows in (1, -1):
        if inputs > 1:
            yield from (Misplaced((place,), rows) for place in range(inputs))
        if outputs > 1:
            yield from (Misplaced((), rows, (place,)) for place in range(outputs))


def moved(case: Case, slip: Misplaced) -> Case:
    """The case with columns in the rows to which they belong."""
    return case.with_flights([_moved_flight(case, flight, slip) for flight in case.flights])


def _moved_flight(case: Case, flight: FilteredLog, slip: Misplaced) -> FilteredLog:
    own = flight.filter_input
    rows = np.arange(len(own.t_s)) + slip.rows
    u, source = own.u.copy(), np.clip(rows, 0, len(rows) - 1)
    u[:, slip.inputs] = own.u[source][:, slip.inputs]
    filter_input = replace(own, u=u, **_readings(own, slip.outputs, rows))
    if not slip.outputs:
        return replace(flight, filter_input=filter_input)
    x0, p0 = start_of(case.library, filter_input, flight.locked)
    return replace(flight, filter_input=filter_input, x0=x0, p0=p0)


def _readings(own: FilterInput, outputs: Sequence[int], rows: NDArray[np.int64]) -> dict[str, Any]:
    """What is known of each reading, those of `outputs` from other rows; nothing where the log has no such row."""
    if not outputs:
        return {}
    there = (rows >= 0) & (rows < len(rows))
    source = np.clip(rows, 0, len(rows) - 1)
    found = {name: getattr(own, name).copy() for name in READINGS}
    for name, output in chain.from_iterable(((name, output) for output in outputs) for name in READINGS):
        found[name][:, output] = np.where(there, found[name][source, output], READINGS[name])
    return found
