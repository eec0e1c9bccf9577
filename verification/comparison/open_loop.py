"""Fig. 18 of seed 001: what each motor does to the other axis without a controller, on the paper's own equations."""

from dataclasses import dataclass

import numpy as np

from records.table import AXES
from sim.bind import BoundPlant
from sim.equilibrium import equilibrium
from sim.simulate import Conditions, simulate
from verification.comparison.flights import Flown

MODEL = "ce150_velagic"
REST_RAD = -0.648  # below the horizontal, where 0.48 MU holds the arm at rest
STEP_S, STEPS, SAMPLE_PERIOD_S = 30.0, 5, 0.01


@dataclass(frozen=True)
class OpenLoop:
    """One half of the figure: main and tail voltage in machine units, one level a step; the other half of its axes' numbers is ours."""

    name: str
    main_MU: tuple[float, ...]
    tail_MU: tuple[float, ...]


# The figure's axes: u_1 0.48 MU with u_2 from 0.15 to 0.25, and u_2 0.21 MU with u_1 from 0.4 to 0.8. With the paper's a_3 and b_3 the
# azimuth stands still at 0.48 MU where the tail has 0.38 MU: the third run has the figure's steps about that.
RUNS = (
    OpenLoop("u2 steps at u1 = 0.48 MU", (0.48,) * STEPS, (0.20, 0.25, 0.20, 0.15, 0.20)),
    OpenLoop("u1 steps at u2 = 0.21 MU", (0.48, 0.53, 0.48, 0.43, 0.48), (0.21,) * STEPS),
    OpenLoop("u2 steps about 0.38 MU", (0.48,) * STEPS, (0.38, 0.43, 0.38, 0.33, 0.38)),
)


def fly_open_loop(bound: BoundPlant) -> dict[str, Flown]:
    """The runs by name, from rest at REST_RAD; nothing on other equations."""
    if bound.model.name != MODEL:
        return {}
    samples = round(STEP_S * STEPS / SAMPLE_PERIOD_S) + 1
    t_s = np.asarray(np.arange(samples) * SAMPLE_PERIOD_S, dtype=float)
    step = np.minimum((t_s // STEP_S).astype(int), STEPS - 1)
    x0, flown = equilibrium(bound, REST_RAD).x0, {}
    for run in RUNS:
        u_V = bound.parameter("MU") * np.column_stack([np.array(run.main_MU)[step], np.array(run.tail_MU)[step]])
        runs = simulate(bound, t_s, x0, u_V, Conditions(keep="y"))
        assert runs.y is not None
        flown[run.name] = Flown(t_s, np.full((samples, len(AXES)), np.nan), runs.y, u_V)
    return flown
