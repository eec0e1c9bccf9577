"""Ways to ask the same question: logs of the same rig that say the same otherwise."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from diagnosis.result import Material, Result
from records.log import RunLog

Logs = list[RunLog]
Steps = Mapping[str, float]  # of each output's sensor
NOISE_STEPS = 1.0 / 3.0


def rows(log: RunLog, chosen: slice) -> RunLog:
    """Some rows of a log, as a log of its own that begins at 0."""
    t_s, step = log.t_s[chosen], chosen.step or 1
    return replace(
        log,
        t_s=t_s - t_s[0],
        u=log.u[chosen],
        y=log.y[chosen],
        extra={name: values[chosen] for name, values in log.extra.items()},
        seq=None,
        sample_period_s=step * log.sample_period_s,
    )


def in_two(logs: Logs, _: Steps) -> Logs:
    """The first log given as two."""
    half = len(logs[0].t_s) // 2
    return [rows(logs[0], slice(0, half)), rows(logs[0], slice(half, None)), *logs[1:]]


def thinned(logs: Logs, _: Steps) -> Logs:
    """Every second row left out."""
    return [rows(log, slice(None, None, 2)) for log in logs]


def noisier(logs: Logs, steps: Steps) -> Logs:
    """A third of a step of noise added to the readings, which are rounded anew."""
    rng, found = np.random.default_rng(4), []
    for log in logs:
        step = np.array([steps[name] for name in log.columns.outputs])
        found.append(replace(log, y=step * np.round(log.y / step + NOISE_STEPS * rng.standard_normal(log.y.shape))))
    return found


def backwards(logs: Logs, _: Steps) -> Logs:
    """The logs in another order."""
    return logs[::-1]


LAWS: dict[str, Callable[[Logs, Steps], Logs]] = {
    "one log given as two": in_two,
    "every second row": thinned,
    "another order": backwards,
    "noise of a third of a step": noisier,
}


def of_logs(logs: Sequence[RunLog], holdout: Sequence[RunLog] = ()) -> Material:
    """What a diagnosis of all rows of these logs begins with."""
    names = [f"log {number}" for number in range(len(logs))]
    held = [f"held {number}" for number in range(len(holdout))]
    return Material(list(logs), list(holdout), held, [None] * (len(logs) + len(holdout)), names=names)


def differs(one: Result, other: Result) -> str:
    """How two answers to the same question differ; "" where they do not.

    The first names must be one, or hardly told apart by the first answer, and equally probable to a tenth.
    """
    first, second = one.diagnosis, other.diagnosis
    if first.verdict != second.verdict:
        return f"verdict {first.verdict}, then {second.verdict}"
    if not first.effects or not second.effects:
        return "" if bool(first.effects) == bool(second.effects) else "names in one answer alone"
    before, after = first.effects[0], second.effects[0]
    if after.effect != before.effect:
        alike = after.effect in before.ambiguous_with
        return "" if alike else f"{before.effect}, then {after.effect}"
    apart = abs(before.probability - after.probability)
    return "" if apart <= 0.1 else f"{before.effect} {before.probability:.2f}, then {after.probability:.2f}"
