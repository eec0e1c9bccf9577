"""What to record next: of the rig's own menu, the run that best separates the hypotheses that are still alike, flown in advance."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray

from diagnosis import decisions
from diagnosis.decide.weighing import Weighed
from diagnosis.experiment.menu import Plan, plans, rooms
from diagnosis.experiment.simulated_experiment import (
    SimulatedExperiment,
    missed,
    outcomes,
    recorded,
    setting,
    simulate_experiment,
)
from diagnosis.experiment.stand_in import StandIn, stand_in
from diagnosis.fit.evidence import FittedHypothesis
from diagnosis.hypothesis.case import Case

Array = NDArray[np.float64]
LONGEST_PERIOD_S = 0.02  # between rows of a simulated experiment: no verdict hangs on it
LOST_APART = 10.0  # standard deviations by which a hypothesis is away that cannot follow the run at all
LEADING = 3  # hypotheses that a run is to tell apart: time
NO_EXPERIMENT = "none of the menu"


@dataclass(frozen=True, eq=False)
class Trial:
    """A plan flown under each leading hypothesis, and the separation of each pair (places in `leading`)."""

    plan: Plan
    flown: tuple[SimulatedExperiment, ...]
    z: Mapping[tuple[int, int], float]

    @property
    def within_limits(self) -> bool:
        """Whether every flight kept its limits."""
        return all(entry.within_limits for entry in self.flown)


def next_experiment(case: Case, weighed: Weighed) -> Mapping[str, Any] | None:
    """The run that separates most of what is undecided, with the outcome to expect; None where nothing is, or nothing can be flown."""
    ranked = zip(weighed.fitted, weighed.probabilities, strict=True)
    likely = [(fitted, probability) for fitted, probability in ranked if probability > decisions.NEGLIGIBLE_SHARE]
    leading = likely[:LEADING]
    pairs = {
        (a, b): leading[a][1] * leading[b][1]
        for a, b in combinations(range(len(leading)), 2)
        if set(leading[a][0].effects) != set(leading[b][0].effects)
    }
    if sum(pairs.values()) < decisions.NEGLIGIBLE_SHARE:
        return None
    fitted = [fitted for fitted, _ in leading]
    period_s = period_of(case)
    found = [trial for plan in plans(case, period_s) if (trial := _trial(case, plan, fitted, pairs)) is not None]
    if not found:
        return None
    best = max(found, key=lambda trial: _worth(trial, pairs))
    return _told(case, best, fitted, pairs)


def _trial(
    case: Case, plan: Plan, fitted: Sequence[FittedHypothesis], pairs: Mapping[tuple[int, int], float]
) -> Trial | None:
    """Fly a plan under every hypothesis and compare each pair on what the likelier of the two would record."""
    law = law_of(case, plan)
    there = setting(case, plan)
    flown = [None if law is None else simulate_experiment(there, plan, law, entry.fit.hypothesis) for entry in fitted]
    if any(entry is None for entry in flown):
        return None
    good = tuple(entry for entry in flown if entry is not None)
    z = {}
    for a in sorted({a for a, _ in pairs}):
        data = recorded(there, good[a])
        noisy = fitted[a].fit.hypothesis
        own = missed(data, fitted[a].fit, plan, noisy)
        if own is None:
            return None
        for b in (b for one, b in pairs if one == a):
            other = missed(data, fitted[b].fit, plan, noisy)
            z[a, b] = LOST_APART if other is None else float(np.sqrt(max(other - own, 0.0)))
    return Trial(plan, good, z)


def period_of(case: Case) -> float:
    """The sample period of a simulated experiment: coarser than the logs' own, as nobody has to wait for it."""
    return min(LONGEST_PERIOD_S, 2.0 * min(flight.log.sample_period_s for flight in case.flights))


def law_of(case: Case, plan: Plan) -> StandIn | None:
    """The law that flies a plan in the simulation; None where there is none."""
    room = rooms(case)
    at = {entry.axis: entry.middle for entry in room}
    size = np.array([0.3 * entry.reach for entry in room])
    return stand_in(case.library.bound, at, size, float(plan.course.t_s[1]), plan.locked)


def _worth(trial: Trial, pairs: Mapping[tuple[int, int], float]) -> tuple[float, float]:
    """What a trial decides, in units of the probability at stake, less its effort; then the separation itself."""
    stake = sum(pairs.values())
    decided = sum(p * _decided(trial.z[pair]) for pair, p in pairs.items()) / stake
    cost = decisions.EFFORT * (trial.plan.effort + (0.0 if trial.within_limits else 1.0))
    return decided - cost, min(trial.z.values())


def _decided(z: float) -> float:
    """A half at what chance does; no model is so right that noise alone decides, so that more is always worth a little more."""
    return z**2 / (z**2 + decisions.BEYOND_CHANCE**2)


def _told(
    case: Case, best: Trial, fitted: Sequence[FittedHypothesis], pairs: Mapping[tuple[int, int], float]
) -> Mapping[str, Any]:
    first = max(pairs, key=lambda pair: pairs[pair] * _decided(best.z[pair]))
    names = [_name(entry) for entry in fitted]
    apart = best.z[first]
    split = {True: list[str](), False: list[str]()}
    for a, b in pairs:
        split[best.z[a, b] >= decisions.BEYOND_CHANCE].append(f"{names[a]} from {names[b]}")
    return {
        "experiment": best.plan.name if split[True] else NO_EXPERIMENT,
        "instruction": best.plan.instruction if split[True] else "no run of this rig's menu tells what is left apart",
        "separates": split[True],
        "does_not_separate": split[False],
        "expected_outcome": _outcome(case, best, first, names),
        "separation": round(apart, 1),
        "within_limits": best.within_limits,
        "duration_s": round(float(best.plan.course.t_s[-1] + best.plan.course.t_s[1]), 2),
    }


def _name(fitted: FittedHypothesis) -> str:
    return " + ".join(fitted.effects)


def _outcome(case: Case, trial: Trial, pair: tuple[int, int], names: Sequence[str]) -> str:
    """The expected outcome in one sentence with numbers."""
    a, b = pair
    apart = trial.z[pair]
    if apart < decisions.BEYOND_CHANCE:
        return (
            f"no run of the menu tells {names[a]} from {names[b]}: the best of them ({trial.plan.name}) leaves them "
            f"{apart:.1f} standard deviations of the noise apart"
        )
    found = outcomes([trial.flown[a].log, trial.flown[b].log], _floors(case))
    kept = "" if trial.within_limits else "; stops or inputs reach their limits"
    apart_text = f"{apart:.0f} standard deviations of the noise apart after re-tuning{kept}"
    if found is None:
        return f"{names[a]} and {names[b]} leave small differences everywhere that add up: {apart_text}"
    name, after_s, values = found
    one, other = (_shown(name, value) for value in values)
    return (
        f"{after_s:.1f} s into the run the {_part(case, name)} is at {one} under {names[a]}, "
        f"at {other} under {names[b]}: {apart_text}"
    )


def _part(case: Case, column: str) -> str:
    """The axis or input that a column tells of, in words."""
    places = case.library.bound.model.places
    parts = {axis.angle: name for name, axis in places.axes.items()}
    parts |= {str(entry.variable): name for name, entry in places.inputs.items()}
    return parts.get(column, column).replace("_", " ")


def _floors(case: Case) -> dict[str, float]:
    """What a reader can see of each column: some encoder steps, a share of an input's range."""
    model, bound = case.library.bound.model, case.library.bound
    found = {name: decisions.BEYOND_CHANCE * max(bound.plant.sensors[name], 1e-4) for name in model.outputs}
    for variable in model.inputs:
        low, high = bound.commands(variable)
        found[str(variable)] = decisions.NEGLIGIBLE_SHARE * (high - low)
    return found


def _shown(name: str, value: float) -> str:
    if name.endswith("_rad"):
        return f"{np.degrees(value):.1f} deg"
    if name.endswith("_rad_s"):
        return f"{np.degrees(value):.1f} deg/s"
    unit = name.rsplit("_", 1)[-1]
    return f"{value:.3g} {unit}" if unit in ("V", "m") else f"{value:.3g}"
