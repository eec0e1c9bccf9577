"""What other answers to the same sealed cases change: verdicts, first names, and three figures of the score."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from blind.cases.sealed import open_seal
from blind.scoring.judge import Judgement, judge
from blind.scoring.results import Answer, Names, Unreadable, read_answer


@dataclass(frozen=True)
class Change:
    """From some answers to others: cases whose verdict or first name is another, and each of both; cases without a usable answer now;
    the new share less the old of causes that stand first and of first places that are right, where there are effects, and of false
    alarms, where there are none (None: no such case)."""

    cases: int
    other: int
    verdicts: int
    first_names: int
    failed: int
    right_first: float | None
    place: float | None
    false_alarms: float | None

    @property
    def size(self) -> tuple[int, float]:
        """By what changes are compared: the cases that are told otherwise, then how far the three shares move."""
        return self.other, sum(abs(value or 0.0) for value in (self.right_first, self.place, self.false_alarms))


def change(folder: Path, before: Path, after: Path) -> Change:
    """The change from the answers in `before` to those in `after`; raises BadInput where the seal is broken."""
    truths = open_seal(folder)
    old, new = ([read_answer(results / name) for name in truths] for results in (before, after))
    was, now = (
        [judge(name, truths[name], one, None) for name, one in zip(truths, all_of, strict=True)]
        for all_of in (old, new)
    )
    verdicts = [_verdict(a) != _verdict(b) for a, b in zip(old, new, strict=True)]
    names = [_first(a) != _first(b) for a, b in zip(old, new, strict=True)]
    return Change(
        cases=len(truths),
        other=sum(a or b for a, b in zip(verdicts, names, strict=True)),
        verdicts=sum(verdicts),
        first_names=sum(names),
        failed=sum(isinstance(entry, Unreadable) for entry in new),
        right_first=_moved(was, now, True, lambda j: j.rank == 1),
        place=_moved(was, now, True, lambda j: j.place_right),
        false_alarms=_moved(was, now, False, lambda j: j.detected),
    )


def _verdict(answer: Answer | Unreadable) -> str | None:
    return None if isinstance(answer, Unreadable) else answer.verdict


def _first(answer: Answer | Unreadable) -> Names | None:
    return None if isinstance(answer, Unreadable) or not answer.ranked else answer.ranked[0].names


def _moved(
    was: Sequence[Judgement], now: Sequence[Judgement], effects: bool, right: Callable[[Judgement], bool]
) -> float | None:
    """The difference of a share over the cases with effects, or over those without."""
    pairs = [(right(a), right(b)) for a, b in zip(was, now, strict=True) if bool(a.truth.effects) == effects]
    return sum(b - a for a, b in pairs) / len(pairs) if pairs else None
