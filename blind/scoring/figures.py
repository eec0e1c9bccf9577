"""The figures of a score: shares and sizes over the cases where each counts, with the contract's targets."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from blind.scoring.judge import Judgement
from blind.scoring.statistics import Bin, calibration_error, clopper_pearson

Judged = TypeVar("Judged")
SEVERE = 2.0  # noise floors
LOST_FRAMES = "loop.dropped_frames"


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


def figures(judged: Sequence[Judgement], bins: Sequence[Bin]) -> list[Figure]:
    """Every figure, in the order of the table; "severe": a re-tune leaves two noise floors."""
    nominal = [j for j in judged if j.truth.kind == "nominal"]
    effects = [j for j in judged if j.truth.kind != "nominal"]
    severe = [j for j in effects if j.truth.severity_left >= SEVERE]
    seen = [j for j in severe if j.detected]
    single = [j for j in seen if j.truth.kind in ("single", "small")]
    timing = [j for j in severe if j.truth.kind == "timing"]
    double = [j for j in severe if j.truth.kind == "double" and _each_severe(j)]
    outside = [j for j in seen if j.truth.kind == "outside"]
    inside = [j for j in severe if j.truth.kind != "outside"]
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
        _share("right effects to 10 % in size, yet not named", inside, lambda j: j.left_out, 0.02, at_most=True),
        _size("effect's parameters, median relative error", _errors(seen), np.median, 0.03),
        _share("effect's parameters, truth in its 95 % interval", _within(seen), bool, 0.93),
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


def _within(judged: Sequence[Judgement]) -> list[bool]:
    return [within for j in judged for within in j.within_interval]


def _share(
    name: str,
    judged: Sequence[Judged],
    right: Callable[[Judged], bool],
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
