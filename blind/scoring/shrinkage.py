"""How far a diagnosis shrank the hold-out gap, as a share of what the true model reaches."""

import csv
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from blind.cases.sealed import Hold
from blind.rigs.bench import with_word
from blind.scoring.results import Answer

Array = NDArray[np.float64]
# Below this share of the floor's energy nothing is left to remove, and the ratio would be noise over noise.
REMOVABLE = 0.5
COVERED = 0.5


def relative_shrinkage(hold: Hold, answer: Answer, log: Path, prediction: Path) -> float | None:
    """(before^2 - after^2) / (before^2 - true^2), each output scaled by the true model's RMS, clipped to [-1, 1.05].

    `prediction` is scored against the case's own log; where it is missing the diagnosis' stated RMS count. None where the re-tuned
    plant leaves less than half the floor's energy to remove; 0 where nothing usable was predicted.
    """
    names = tuple(hold.rms_true)
    bars = _scored_rms(log, prediction, names) or _stated_rms(answer, names)
    if bars is None:
        return 0.0
    before, after = bars
    scale = {name: hold.rms_true[name] ** 2 for name in names}
    removable = sum(before[name] ** 2 / scale[name] - 1.0 for name in names)
    if removable < REMOVABLE:
        return None
    removed = sum((before[name] ** 2 - after[name] ** 2) / scale[name] for name in names)
    return float(np.clip(removed / removable, -1.0, 1.05))


def _stated_rms(answer: Answer, names: Sequence[str]) -> tuple[Mapping[str, float], Mapping[str, float]] | None:
    bars = (answer.rms_before, answer.rms_after)
    return bars if all(isinstance(bar.get(name), float | int) for bar in bars for name in names) else None


def _scored_rms(
    log: Path, prediction: Path, outputs: Sequence[str]
) -> tuple[Mapping[str, float], Mapping[str, float]] | None:
    measured, predicted = _columns(log), _columns(prediction)
    names = [with_word(output, bar) for output in outputs for bar in ("before", "after")]
    if predicted is None or measured is None or any(name not in predicted for name in ("t_s", *names)):
        return None
    rows = np.searchsorted(measured["t_s"], predicted["t_s"] - 1e-4)
    rows = np.minimum(rows, len(measured["t_s"]) - 1)
    same = np.abs(measured["t_s"][rows] - predicted["t_s"]) < 1e-3
    bars: tuple[dict[str, float], dict[str, float]] = ({}, {})
    for output in outputs:
        for bar, kind in zip(bars, ("before", "after"), strict=True):
            error = (predicted[with_word(output, kind)] - measured[output][rows])[same]
            error = error[np.isfinite(error)]
            if len(error) < COVERED * len(measured["t_s"]):
                return None
            bar[output] = float(np.sqrt(np.mean(error**2)))
    return bars


def _columns(path: Path) -> dict[str, Array] | None:
    try:
        with path.open(encoding="utf-8", newline="") as stream:
            rows = list(csv.reader(stream))
        table = np.array([[float(cell) if cell.strip() else np.nan for cell in row] for row in rows[1:]])
        return {name.strip(): table[:, index] for index, name in enumerate(rows[0])}
    except (OSError, ValueError, IndexError):
        return None
