"""The scorer: opens the seal, judges each case, adds up."""

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np

from blind.cases.sealed import Truth, open_seal
from blind.scoring.judge import Judgement, judge
from blind.scoring.results import Unreadable, read_answer
from blind.scoring.shrinkage import relative_shrinkage
from blind.scoring.statistics import Bin, calibration_error, clopper_pearson, reliability

SEVERE = 2.0
LOST_FRAMES = "loop.dropped_frames"
EDGES = (0.0, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0, float("inf"))


@dataclass(frozen=True)
class Figure:
    """One line of the score: a share or size over `cases` cases, its 95 % interval where it is a share, the target, whether it is met.

    `value` and `met` are None where no case counts; `target` is None for a figure that is only reported.
    """

    name: str
    value: float | None
    cases: int
    interval: tuple[float, float] | None
    target: float | None
    at_most: bool
    met: bool | None
    unit: str


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
        figures=tuple(_figures(judgements, bins)),
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


def _figures(judged: Sequence[Judgement], bins: Sequence[Bin]) -> list[Figure]:
    nominal = [j for j in judged if j.truth.kind == "nominal"]
    effects = [j for j in judged if j.truth.kind != "nominal"]
    severe = [j for j in effects if j.truth.severity_left >= SEVERE]
    seen = [j for j in severe if j.detected]
    single = [j for j in seen if j.truth.kind in ("single", "small")]
    timing = [j for j in severe if j.truth.kind == "timing"]
    double = [j for j in severe if j.truth.kind == "double" and _each_severe(j)]
    outside = [j for j in seen if j.truth.kind == "outside"]
    plain = [j for j in effects if j.truth.severity >= SEVERE]
    return [
        _share("false alarms on cases without effect", nominal, lambda j: j.detected, 0.01, at_most=True),
        _share("detected, severity after re-tune >= 2", severe, lambda j: j.detected, 0.97),
        _share("detected, severity >= 2", plain, lambda j: j.detected, None),
        _share("place right, of the detected", seen, lambda j: j.place_right, 0.95),
        _share("place right, an input and its rotor as one", seen, lambda j: j.side_right, None),
        _share("cause first, single library effect", single, lambda j: j.rank == 1, 0.90),
        _share("cause in the first three", single, lambda j: j.rank is not None and j.rank <= 3, 0.98),
        _share("cause in the stated ambiguous set", single, lambda j: j.set_hit or j.rank == 1, None),
        _size("effect's parameters, median relative error", _errors(seen), np.median, 0.03),
        _share("two effects, both named", double, lambda j: j.all_named, 0.80),
        _share(
            "out of library: no wrong name, place right", outside, lambda j: not j.wrong_names and j.place_right, 0.85
        ),
        _share("out of library: functional class right", outside, lambda j: j.class_right, None),
        _share("timing: named", timing, lambda j: j.rank == 1, None),
        *_shrinkage_figures(severe),
        _size("expected calibration error", [calibration_error(bins)] if bins else [], np.median, 0.03),
        *_time_figures(judged),
    ]


def _shrinkage_figures(severe: Sequence[Judgement]) -> list[Figure]:
    """The true model is told which frames a flight loses, which no prediction can know: one figure leaves such cases out."""
    inside = [j for j in severe if j.truth.kind != "outside"]
    known, unknown = _shrunk(inside), _shrunk([j for j in severe if j.truth.kind == "outside"])
    foreseeable = _shrunk([j for j in inside if all(effect.name != LOST_FRAMES for effect in j.truth.effects)])
    return [
        _size("hold-out shrinkage of the true model's, median", known, np.median, 0.97, at_most=False),
        _size("hold-out shrinkage, tenth percentile", known, lambda x: np.percentile(x, 10.0), 0.85, at_most=False),
        _size(
            "hold-out shrinkage, tenth percentile, no frames lost", foreseeable, lambda x: np.percentile(x, 10.0), None
        ),
        _size("hold-out shrinkage out of library, median", unknown, np.median, None, at_most=False),
    ]


def _shrunk(judged: Sequence[Judgement]) -> list[float]:
    return [j.shrinkage for j in judged if j.shrinkage is not None]


def _time_figures(judged: Sequence[Judgement]) -> list[Figure]:
    times = [j.time_s for j in judged if j.time_s is not None]
    return [
        _size("time, median", times, np.median, 15.0, unit="s"),
        _size("time, worst", times, np.max, 40.0, unit="s"),
    ]


def _each_severe(judgement: Judgement) -> bool:
    return all(effect.severity_left >= SEVERE for effect in judgement.truth.effects)


def _errors(judged: Sequence[Judgement]) -> list[float]:
    return [error for j in judged if j.truth.kind in ("single", "small", "timing") for error in j.parameter_errors]


def _share(
    name: str,
    judged: Sequence[Judgement],
    right: Callable[[Judgement], bool],
    target: float | None,
    at_most: bool = False,
) -> Figure:
    if not judged:
        return Figure(name, None, 0, None, target, at_most, None, "")
    hits = sum(bool(right(j)) for j in judged)
    value = hits / len(judged)
    interval = clopper_pearson(hits, len(judged))
    return Figure(name, value, len(judged), interval, target, at_most, _met(value, target, at_most), "")


def _size(
    name: str,
    values: Sequence[float],
    statistic: Callable[[Sequence[float]], float],
    target: float | None,
    at_most: bool = True,
    unit: str = "",
) -> Figure:
    if not values:
        return Figure(name, None, 0, None, target, at_most, None, unit)
    value = float(statistic(values))
    return Figure(name, value, len(values), None, target, at_most, _met(value, target, at_most), unit)


def _met(value: float, target: float | None, at_most: bool) -> bool | None:
    if target is None:
        return None
    return value <= target if at_most else value >= target


def _by_severity(judged: Sequence[Judgement], size: Callable[[Truth], float]) -> tuple[Detection, ...]:
    rows = []
    for low, high in pairwise(EDGES):
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
