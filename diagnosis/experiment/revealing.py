"""What to record when logs show too little: of the rig's own menu, the run in which most effects of the library would show."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from diagnosis import decisions
from diagnosis.experiment.menu import plans
from diagnosis.experiment.next_experiment import law_of, period_of
from diagnosis.experiment.simulated_experiment import recorded, setting, simulate_experiment
from diagnosis.fit.free_numbers import size_scale
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import Hypothesis, passes

Array = NDArray[np.float64]


def revealing_experiment(case: Case, hypothesis: Hypothesis) -> Mapping[str, Any] | None:
    """The run that shows most effects on the equations at their reference sizes, less its effort; None where none can be flown."""
    names = [name for name in case.library.candidates if name in case.library.names and name not in hypothesis.effects]
    best, worth, shown = None, -np.inf, 0
    for plan in plans(case, period_of(case)):
        there, law = setting(case, plan), law_of(case, plan)
        flown = None if law is None else simulate_experiment(there, plan, law, hypothesis)
        if flown is None:
            continue
        seen = _seen(recorded(there, flown), hypothesis, names)
        if seen * (1.0 - decisions.EFFORT * plan.effort) > worth:
            best, worth, shown = (plan, flown), seen * (1.0 - decisions.EFFORT * plan.effort), seen
    if best is None:
        return None
    plan, flown = best
    now = _seen(case, hypothesis, names)
    return {
        "experiment": plan.name,
        "instruction": plan.instruction,
        "separates": [],
        "expected_outcome": f"{shown} of {len(names)} effects would show at the size that they may well have; "
        f"in these logs {now} do",
        "within_limits": flown.within_limits,
        "duration_s": round(float(plan.course.t_s[-1] + plan.course.t_s[1]), 2),
    }


def _seen(case: Case, hypothesis: Hypothesis, names: list[str]) -> int:
    """How many effects would stand BEYOND_CHANCE deviations out at their reference size, the plant's own coefficients re-tuned."""
    effects = case.library.effects
    touched = {name: {p.symbol: p.touched for p in effects[name].parameters} for name in names}
    compiled = case.library.compiled((*hypothesis.effects, *names))
    places = [compiled.place(name, effects[name].size.symbol) for name in names]
    runs = passes(case, hypothesis.with_effects({**touched, **hypothesis.effects}), [*case.free.tolist(), *places])
    if runs is None:
        return 0
    scale = np.concatenate([case.sd, [size_scale(effects[name].size) for name in names]])
    gram = np.sum([run.gram for run in runs], axis=0) * np.outer(scale, scale)
    own = len(case.free)
    cross = gram[:own, own:]
    left = np.diag(gram)[own:] - np.sum(cross * np.linalg.solve(gram[:own, :own] + case.known, cross), axis=0)
    return int(np.sum(left >= decisions.BEYOND_CHANCE**2))
