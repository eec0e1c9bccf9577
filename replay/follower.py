"""One firmware held against a log, sample by sample, with the single incidents that leave its answer unexplained.

An incident is accepted only when the law, run on behind it, meets the log again at once: in a float32 log that is a match of
64 bits, which does not happen by chance.
"""

from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from replay import thresholds
from replay.flight import blocks, candidates_for_misread, candidates_for_missing, candidates_for_unmeasured, leaps
from replay.law import ReplayLaw, Setup, each
from replay.workshop import Workshop

Array = NDArray[np.float64]
OUTPUT_HELD, SAMPLE_LOST, RESET = "dropped_frame", "lost_sample", "reset"
STALE_ANGLES, STALE_REFERENCES, UNLOGGED = "stale_sample_once", "stale_reference_once", "sample_not_logged"
MISREAD = "reading_not_as_logged"
# The state before samples that the log lacks, or an answer that it lacks, and which they are.
_Gap = tuple[Any, tuple[int, int]]


@dataclass(frozen=True)
class Incident:
    """What happened once, from sample `first` on, for `samples` samples."""

    kind: str
    first: int
    samples: int = 1


@dataclass(frozen=True)
class Trace:
    """How far a firmware explains the log: the sample at which it no longer does (None: throughout), and the incidents until there."""

    stopped: int | None
    incidents: tuple[Incident, ...]

    @property
    def explains(self) -> bool:
        """True where nothing is left unexplained."""
        return self.stopped is None

    def kinds(self) -> Counter[str]:
        """How many incidents of each kind."""
        return Counter(incident.kind for incident in self.incidents)

    def samples(self, kind: str) -> int:
        """How many samples the incidents of a kind last."""
        return sum(incident.samples for incident in self.incidents if incident.kind == kind)


@dataclass(frozen=True)
class _Hypothesis:
    kind: str
    first: int
    behind: int
    state: Any


class Follower:
    """A setup's law over a flight; `follow` gives the trace. Where `misread`, the law may have had other readings than the log holds."""

    def __init__(self, workshop: Workshop, setup: Setup, misread: bool = False) -> None:
        """Raises BadInput for a table that no law can be made from."""
        self._misread = misread
        self._law = ReplayLaw(setup)
        self._flight = workshop.flight
        self.inputs = workshop.inputs(setup)
        self._wanted, self._slack = workshop.answers(setup)
        self._loops = setup.loops
        self._lacks = workshop.lacks
        self._late = (
            np.array([lag for lags in (setup.reference_lags, setup.angle_lags) for lag in each(lags, self._loops)]) > 0
        )

    def follow(self) -> Trace:
        """Run through the log, accepting incidents."""
        n = len(self.inputs)
        state, row = self._law.start(self.inputs[0, self._loops :]), 0
        incidents: list[Incident] = []
        gaps = self._gaps()
        last_gap: _Gap | None = None
        while True:
            gaps = [gap for gap in gaps if gap[0] >= row]  # an incident may last beyond the next
            stop = gaps[0][0] if gaps else n
            row = self._run(state, row, stop)
            if row == n:
                return self._judged(Trace(None, tuple(incidents)))
            if row == stop:
                last_gap = (self._law.copied(state), gaps.pop(0))
                continue
            best = self._best(row, state, last_gap, {incident.kind for incident in incidents})
            if best is None:
                return Trace(row, tuple(incidents))
            incidents.append(Incident(best.kind, best.first, max(1, best.behind - best.first)))
            state, row = best.state, best.behind

    def _gaps(self) -> list[tuple[int, int]]:
        """Samples that the log lacks, and rows of it whose answer is not known, each by itself but those that tell nothing."""
        unanswered: NDArray[np.bool_] = np.asarray(np.isnan(self._wanted).any(axis=1))
        for first, behind in ((0, 1), *self._flight.missing):
            unanswered[first:behind] = False
        unread = np.isnan(self.inputs[:, self._loops :]).any(axis=1)
        nothing = unanswered & unread & np.isnan(self._wanted).all(axis=1)
        alone = np.flatnonzero(unanswered & ~nothing).tolist()
        return sorted((*self._flight.missing, *blocks(nothing), *((row, row + 1) for row in alone)))

    def _judged(self, trace: Trace) -> Trace:
        """Incidents alone are no explanation: enough samples in which the output moved must be the law's own answers."""
        if not trace.incidents:
            return trace
        trace = self._peaks_misread(trace)
        if trace.samples(MISREAD) > thresholds.MOST_MISREAD * len(self.inputs):
            return Trace(trace.incidents[0].first, ())
        moved = np.concatenate([[True], np.any(self._wanted[1:] != self._wanted[:-1], axis=1)])
        telling = moved & ~np.isnan(self._wanted).any(axis=1)
        explained = telling.copy()
        for incident in trace.incidents:
            explained[incident.first : incident.first + incident.samples] = False
        enough = explained.sum() >= max(
            thresholds.LEAST_EXPLAINED_SAMPLES, thresholds.LEAST_EXPLAINED_SHARE * telling.sum()
        )
        return trace if enough else Trace(trace.incidents[0].first, ())

    def _peaks_misread(self, trace: Trace) -> Trace:
        """The law given the angle of the sample before at a peak of the log's, however low, is no stale sample where a peak stands that
        no plant has: its state behind is the same."""
        if not any(leaps(self._flight, entry.first).any() for entry in trace.incidents if entry.kind == MISREAD):
            return trace
        low = [
            replace(entry, kind=MISREAD)
            if entry.kind == STALE_ANGLES and leaps(self._flight, entry.first, 0.0).any()
            else entry
            for entry in trace.incidents
        ]
        return replace(trace, incidents=tuple(low))

    def _run(self, state: Any, first: int, behind: int, inputs: NDArray[Any] | None = None) -> int:
        given = self.inputs if inputs is None else inputs
        return self._law.run(state, (first, behind), given, self._wanted, self._slack)

    def _best(self, row: int, state: Any, last_gap: _Gap | None, met: set[str]) -> _Hypothesis | None:
        """The hypothesis that carries furthest, if it carries at all; of equals the first.

        One that carries to the log's end meets nothing more that could refute it, and where the output rests too little
        before: there a kind that was `met` before is believed, if it carries at all.
        """
        n, carrying = len(self.inputs), []
        for hypothesis in self._hypotheses(row, state, last_gap):
            ahead = min(hypothesis.behind + thresholds.LOOK_AHEAD, n)
            reached = self._run(self._law.copied(hypothesis.state), hypothesis.behind, ahead)
            carries = reached > hypothesis.behind or reached == n
            # Behind a number that was found because its answer fits, the next may be missing as well.
            carries = carries or (hypothesis.kind in (UNLOGGED, MISREAD) and bool(np.isnan(self.inputs[reached]).any()))
            if reached > row and carries:
                carrying.append((reached, hypothesis))
        if (
            self._misread and leaps(self._flight, row).any()
        ):  # the log itself shows it; a plant at rest hides what was not run
            carrying = [entry for entry in carrying if entry[1].kind == MISREAD] or carrying
        furthest = max((reached for reached, _ in carrying), default=0)
        known = [(reached, hypothesis) for reached, hypothesis in carrying if hypothesis.kind in met]
        choice = known if furthest == n and known else carrying
        return max(choice, key=lambda entry: entry[0], default=(0, None))[1]

    def _hypotheses(self, row: int, state: Any, last_gap: _Gap | None) -> Iterator[_Hypothesis]:
        if row == 0:
            yield from self._begun()
        if row == len(self.inputs) or row == 0:
            return
        yield from self._never_read(row, state)
        yield from self._held(row, state)
        yield _Hypothesis(RESET, row, row, self._law.start(self.inputs[row, self._loops :]))
        each_angle = [(STALE_ANGLES, slice(place, place + 1)) for place in range(self._loops, 2 * self._loops)]
        for kind, columns in (
            (STALE_ANGLES, slice(self._loops, 2 * self._loops)),
            *(each_angle if self._loops > 1 else ()),
            (STALE_REFERENCES, slice(0, self._loops)),
        ):
            yield from self._other_input(row, state, kind, columns, self.inputs[row - 1, columns])
        if np.isnan(self.inputs[row]).any():
            yield from self._given(state, (row, row + 1), candidates_for_unmeasured(self._flight, row))
        if last_gap is not None and row <= last_gap[1][1] + 2:
            yield from self._not_logged(row, last_gap)
        if self._misread:
            yield from self._read_otherwise(row, state, thresholds.MISREAD_IN_A_ROW)

    def _begun(self) -> Iterator[_Hypothesis]:
        """Behind the first row, where angles that it lacks are those from which the law started, and which it answered."""
        gaps = np.isnan(self.inputs[0])
        if not gaps.any():
            return
        for candidate in candidates_for_unmeasured(self._flight, 0):
            given = np.where(gaps, candidate.astype(self.inputs.dtype), self.inputs[:1])
            state = self._law.start(given[0, self._loops :])
            if self._law.run(state, (0, 1), given, *self._between(0, 1)) == 1:
                yield _Hypothesis(UNLOGGED, 0, 1, state)

    def _never_read(self, row: int, state: Any) -> Iterator[_Hypothesis]:
        """A zero in a column that lacks readings: it may have been written down for none, beside zero where nobody sees it."""
        angle_rad = self._flight.angle_rad
        written = self._lacks & (angle_rad[row] == 0.0)
        if not written.any():
            return
        angle_rad = angle_rad.copy()
        angle_rad[row, written] = np.nan
        candidates = candidates_for_unmeasured(replace(self._flight, angle_rad=angle_rad), row)
        none = np.concatenate([np.zeros(self._loops, bool), written])
        yield from self._given(state, (row, row + 1), candidates, none)

    def _held(self, row: int, state: Any) -> Iterator[_Hypothesis]:
        """The output stayed as it was: the law's frame was lost, or the law was not called."""
        same = self._wanted[row : row + thresholds.LONGEST_HOLD] == self._wanted[row - 1]
        held = int(np.argmin(np.append(same.all(axis=1), False)))
        stepped = self._law.copied(state)
        for length in range(1, held + 1):
            self._law.run(stepped, (row + length - 1, row + length), self.inputs, None, None)
            yield _Hypothesis(OUTPUT_HELD, row, row + length, self._law.copied(stepped))
            yield _Hypothesis(SAMPLE_LOST, row, row + length, self._law.copied(state))
            if self._late.any() and row + length < len(self.inputs):
                yield from self._late_behind_loss(row, length, state)

    def _late_behind_loss(self, row: int, length: int, state: Any) -> Iterator[_Hypothesis]:
        """A firmware that is late by samples which it ran: behind a loss it uses those from before the loss."""
        behind, changed, moved = row + length, self.inputs.copy(), self._law.copied(state)
        changed[behind, self._late] = changed[row, self._late]
        if self._run(moved, behind, behind + 1, changed) == behind + 1:
            yield _Hypothesis(SAMPLE_LOST, row, behind + 1, moved)

    def _other_input(self, row: int, state: Any, kind: str, columns: slice, values: Array) -> Iterator[_Hypothesis]:
        """The law was given other numbers in this one sample, and answered them exactly."""
        if np.array_equal(self.inputs[row, columns], values):
            return
        changed, moved = self.inputs.copy(), self._law.copied(state)
        changed[row, columns] = values
        if self._run(moved, row, row + 1, changed) == row + 1:
            yield _Hypothesis(kind, row, row + 1, moved)

    def _read_otherwise(self, row: int, state: Any, rows: int) -> Iterator[_Hypothesis]:
        """The law had other readings than the log holds, near these, in up to so many rows, and answered them exactly; of as few angles
        as it takes."""
        lacks = bool(np.isnan(self._flight.angle_rad[row]).any())
        for differing, candidates in enumerate(candidates_for_misread(self._flight, row), int(not lacks)):
            found, kind = False, MISREAD if differing else UNLOGGED
            for candidate in candidates:
                changed, moved = candidate[np.newaxis].astype(self.inputs.dtype), self._law.copied(state)
                if self._law.run(moved, (0, 1), changed, *self._between(row, row + 1)) < 1:
                    continue
                yield _Hypothesis(kind, row, row + 1, moved)
                found = self._run(self._law.copied(moved), row + 1, min(row + 2, len(self.inputs))) > row + 1
                if not found and 1 < rows < len(self.inputs) - row:
                    behind = list(self._read_otherwise(row + 1, moved, rows - 1))
                    found = bool(behind)
                    yield from (
                        replace(entry, first=row, kind=MISREAD if MISREAD in (kind, entry.kind) else kind)
                        for entry in behind
                    )
            if found:
                return

    def _not_logged(self, row: int, gap: _Gap) -> Iterator[_Hypothesis]:
        """Samples that the log lacks: the law did not run, or was given the numbers that make its next answers fit."""
        state, (first, behind) = gap
        if behind > row + 1:
            return
        if (first, behind) not in self._flight.missing and behind - first == 1:
            yield from self._unanswered(first, state)
            return
        yield _Hypothesis(UNLOGGED, first, behind, self._law.copied(state))
        yield from self._given(state, (first, behind), candidates_for_missing(self._flight, (first, behind)))

    def _unanswered(self, row: int, state: Any) -> Iterator[_Hypothesis]:
        """A row whose command is not known: only the next answers tell what the law read there, if the log lacks that or holds another."""
        if np.isnan(self.inputs[row]).any():
            yield from self._given(state, (row, row + 1), candidates_for_unmeasured(self._flight, row))
        if self._misread:
            yield from self._read_otherwise(row, state, 1)

    def _given(
        self, state: Any, rows: tuple[int, int], candidates: Iterable[Array], none: NDArray[np.bool_] | bool = False
    ) -> Iterator[_Hypothesis]:
        """The law's state behind `rows` for each candidate of what it was given there, if its answers agree with the log's.

        Candidates stand for what is not a number, and for the columns `none` (2 loops).
        """
        first, behind = rows
        for candidate in candidates:
            changed, moved = self.inputs[first:behind].copy(), self._law.copied(state)
            gaps = np.isnan(changed) | none
            changed[gaps] = candidate.astype(changed.dtype)[gaps]
            if self._law.run(moved, (0, behind - first), changed, *self._between(first, behind)) == behind - first:
                yield _Hypothesis(UNLOGGED, first, behind, moved)

    def _between(self, first: int, behind: int) -> tuple[Array, Array]:
        return self._wanted[first:behind].copy(), self._slack[first:behind].copy()
