"""Logs that contradict each other: one and the same plant, whatever it lacks, cannot have made them all."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from diagnosis import decisions
from diagnosis.filter.kalman import Pass
from diagnosis.fit.evidence import log_evidence
from diagnosis.fit.gauss_newton import fit
from diagnosis.fit.linear_problem import Fit
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import passes

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Contradiction:
    """Log number `index` wants other numbers than the rest: it gains `gain` nats with `moved` of its own, furthest first, in units of
    their spread."""

    index: int
    gain: float
    moved: tuple[tuple[str, float], ...]


def contradiction(case: Case, found: Fit) -> Contradiction | None:
    """The log that gains most by numbers of its own beside a joint fit, to first order; None for a single log.

    With g the slope of one log's misfit and I its information at the joint fit, numbers d of its own gain g' S^-1 g / 2 where
    S = I + L - I (I_all + L)^-1 I and L is what was known before, correlation and all.
    """
    if len(case.flights) < 2:
        return None
    compiled = case.library.compiled(found.hypothesis.effects)
    lacks = found.hypothesis.lacks
    inside = [e for e in found.free if e.effect in compiled.names and e.log is None and e.effect not in lacks]
    places = [compiled.place(entry.effect, entry.parameter.symbol) for entry in inside]
    runs = passes(case, found.hypothesis, [*case.free.tolist(), *places])
    if runs is None:
        return None
    scale = np.concatenate([case.sd, [entry.scale for entry in inside]])
    before = decisions.SIZE_SD**-2 * np.eye(len(scale))
    before[: len(case.free), : len(case.free)] = case.known
    names = [str(case.library.bound.model.parameter_symbols[place]) for place in case.free]
    names += [f"{entry.effect}.{entry.parameter.symbol}" for entry in inside]
    parts = [_own_numbers(runs, index, scale, before, names) for index in range(len(runs))]
    return max(parts, key=lambda entry: entry.gain)


def parted_gain(case: Case, found: Fit) -> float:
    """Nats that the logs gain if each is fitted by itself: what first order promises of limits and steps is often not there."""
    apart = [fit(case.with_flights([flight]), found.hypothesis, rounds=6) for flight in case.flights]
    return sum(entry.log_posterior if entry else -np.inf for entry in apart) - found.log_posterior


def parted_evidence(case: Case, found: Fit) -> float:
    """Log evidence of as many plants as there are logs, each within what is stated and none with what the others lack."""
    apart = [fit(case.with_flights([flight]), found.hypothesis, rounds=6) for flight in case.flights]
    return sum(log_evidence(entry, case.library.effects) if entry else -np.inf for entry in apart)


def _own_numbers(runs: Sequence[Pass], index: int, scale: Array, before: Array, names: Sequence[str]) -> Contradiction:
    grams = [run.gram * np.outer(scale, scale) for run in runs]
    own, everything = grams[index], np.sum(grams, axis=0) + before
    pull = runs[index].pull * scale
    curvature = own + before - own @ np.linalg.solve(everything, own)
    step = -np.linalg.solve(curvature, pull)
    order = np.argsort(-np.abs(step))[:3]
    return Contradiction(
        index, float(-0.5 * pull @ step), tuple((names[place], float(step[place])) for place in order.tolist())
    )
