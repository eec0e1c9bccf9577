"""The scorer: opens the seal, judges each case, adds up."""

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

from blind.cases.sealed import Truth, open_seal
from blind.scoring.figures import Figure, figures
from blind.scoring.judge import Judgement, judge
from blind.scoring.results import Unreadable, read_answer
from blind.scoring.shrinkage import relative_shrinkage
from blind.scoring.statistics import Bin, reliability

SEVERITY_EDGES = (0.0, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0, float("inf"))


@dataclass(frozen=True)
class Detection:
    """Cases with effects whose severity lies in [low, high), and the share in which a gap was found."""

    low: float
    high: float
    cases: int
    detected: float


@dataclass(frozen=True)
class Score:
    """The whole score: figures, detection by severity (plain, and after a re-tune), reliability, confusions, failures by case."""

    cases: int
    figures: tuple[Figure, ...]
    detection: tuple[Detection, ...]
    detection_left: tuple[Detection, ...]
    bins: tuple[Bin, ...]
    confusions: tuple[tuple[str, str, int], ...]
    failures: tuple[tuple[str, str], ...]
    judgements: tuple[Judgement, ...]


def score(folder: Path, results: Path) -> Score:
    """Score RESULTS/case-XXXX/diagnosis.json against the sealed truth of `folder`.

    A missing or unreadable answer counts as wrong in every figure and is named. Raises BadInput where the seal is broken.
    """
    return score_all([(folder, results)])


def score_all(answered: Sequence[tuple[Path, Path]]) -> Score:
    """One score over several folders of cases, each with its results."""
    judgements = [
        _judged(folder / name, results / name, name if len(answered) == 1 else f"{folder.name}/{name}", truth)
        for folder, results in answered
        for name, truth in open_seal(folder).items()
    ]
    bins = reliability([j.stated for j in judgements if j.stated is not None])
    return Score(
        cases=len(judgements),
        figures=tuple(figures(judgements, bins)),
        detection=_by_severity(judgements, lambda truth: truth.severity),
        detection_left=_by_severity(judgements, lambda truth: truth.severity_left),
        bins=bins,
        confusions=_confusions(judgements),
        failures=tuple((j.case, j.failure) for j in judgements if j.failure is not None),
        judgements=tuple(judgements),
    )


def _judged(case: Path, result: Path, name: str, truth: Truth) -> Judgement:
    answer = read_answer(result)
    if truth.kind == "nominal":
        return judge(name, truth, answer, None)
    if isinstance(answer, Unreadable):
        return judge(name, truth, answer, 0.0)
    share = relative_shrinkage(truth.hold, answer, case / "hold-1.csv", result / "prediction-hold-1.csv")
    return judge(name, truth, answer, share)


def _by_severity(judged: Sequence[Judgement], size: Callable[[Truth], float]) -> tuple[Detection, ...]:
    rows = []
    for low, high in pairwise(SEVERITY_EDGES):
        inside = [j for j in judged if j.truth.kind != "nominal" and low <= size(j.truth) < high]
        if inside:
            rows.append(Detection(low, high, len(inside), sum(j.detected for j in inside) / len(inside)))
    return tuple(rows)


def _named_right(judgement: Judgement) -> bool:
    """No gap where there is none; no wrong name where no name of the table fits; exactly the effects elsewhere."""
    if judgement.truth.kind == "nominal":
        return not judgement.detected
    if judgement.truth.kind == "outside":
        return judgement.detected and not judgement.wrong_names
    return judgement.found_right


def _confusions(judged: Sequence[Judgement]) -> tuple[tuple[str, str, int], ...]:
    """(truth, what was found instead, how often), most frequent first."""
    pairs: Counter[tuple[str, str]] = Counter()
    for j in judged:
        truth = " + ".join(sorted(effect.name for effect in j.truth.effects)) or "no effect"
        found = " + ".join(sorted(j.found)) or ("gap, not named" if j.detected else "no gap")
        if not _named_right(j) and j.failure is None:
            pairs[truth, found] += 1
    return tuple((truth, found, count) for (truth, found), count in sorted(pairs.items(), key=lambda e: (-e[1], e[0])))
