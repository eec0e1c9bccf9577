"""Which effects these data could have shown, at the size that they may well have."""

from collections.abc import Sequence

import numpy as np

from diagnosis import decisions
from diagnosis.detect.starts import ScoreTest
from diagnosis.hypothesis.case import Case
from sim.effect import Role


def cannot_tell(case: Case, score_tests: Sequence[ScoreTest]) -> bool:
    """Whether most of the library would go unseen in these data even at its reference sizes."""
    return _share_hidden(case, score_tests) > decisions.BLIND_SHARE


def judged(case: Case, score_tests: Sequence[ScoreTest]) -> list[str]:
    """Effects of which these score tests could say something: all but steps of a signal, which are read off the readings themselves."""
    return [
        name
        for name in case.library.candidates
        if case.library.effects[name].having(Role.STEP) is None or name in {e.effect for e in score_tests}
    ]


def hidden(case: Case, score_tests: Sequence[ScoreTest]) -> dict[str, float]:
    """By effect that would go unseen at its reference size: how many times that it could be; inf where it left no trace at all."""
    power = {entry.effect: entry.power for entry in score_tests}
    found = {
        name: decisions.BEYOND_CHANCE / max(power[name], 1e-9) if name in power else np.inf
        for name in judged(case, score_tests)
    }
    return {name: ratio for name, ratio in found.items() if ratio > 1.0}


def _share_hidden(case: Case, score_tests: Sequence[ScoreTest]) -> float:
    return len(hidden(case, score_tests)) / max(len(judged(case, score_tests)), 1)
