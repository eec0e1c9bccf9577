"""How a plant predicts logs that were kept from its identification."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from identification.fit.belief import NOTHING
from identification.fit.solve import solve
from identification.fit.steps import followed
from identification.runs.log_run import run_of
from identification.runs.run import offset_names
from identification.stages.estimate import problem_of
from identification.uncertainty.residuals import ResidualTest, tests_at
from records.log import RunLog
from sim.bind import BoundPlant

HOLDOUT_S = 1.0  # windows, as those of the diagnosis' predictions


def prediction_tests(
    bound: BoundPlant, logs: Mapping[str, RunLog], offsets: Mapping[str, float] | None = None
) -> tuple[ResidualTest, ...]:
    """How the plant as it is predicts logs that were not used: free-running over windows of a second, whose starts alone are fitted.

    `offsets` are constants added to its inputs, by "offset.INPUT".
    """
    added = np.array([(offsets or {}).get(name, 0.0) for name in offset_names(bound.model)])
    shifted = {name: replace(log, u=log.u + added) for name, log in logs.items()}
    runs = tuple(followed(run_of(bound, log, name, HOLDOUT_S)) for name, log in shifted.items())
    return tests_at(solve(problem_of(runs, (), {}, NOTHING)))
