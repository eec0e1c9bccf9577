"""Where the first rig flies: its simulation, controller and manoeuvres behind the shared way to make a case."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from blind.rigs.bench import Bench, Logging, Plan
from blind.rigs.first.manoeuvre import Style, draw_style, make_flight
from blind.rigs.first.pilot import make_pilot, start_state
from blind.rigs.first.truth import PERIOD_S, Flight, fly, predict
from blind.simulation.ce150 import Rig, draw_rig, stated_zero
from blind.simulation.record import Loss, Model, Record

Array = NDArray[np.float64]
RUN_S = 60.0
TRIAL_S = 20.0
LOGGING = Logging(PERIOD_S, RUN_S, start_s=0.0, speed_noise_rad_s=0.6, speed_step_rad_s=0.001)


@dataclass(frozen=True, eq=False)
class FirstLab:
    """A rig as its controller knows it, the controller, the way to fly."""

    nominal: Rig
    pilot: Any
    style: Style

    @property
    def jitter(self) -> bool:
        """Whether the rows come at irregular times."""
        return self.style.jitter

    def flight(self, rng: Generator, loss: Loss, run: int | None) -> Flight:
        """Any run in the case's style; a trial (`run` None) is shorter."""
        duration_s = TRIAL_S if run is None else RUN_S
        return make_flight(replace(self.style, duration_s=duration_s, loss=loss.share), rng)

    def fly(self, model: Model, shadows: Sequence[Model], flight: Flight) -> Record:
        """From rest at the first reference."""
        start = start_state(self.nominal, flight.reference[0, 0], flight.reference[0, 1])
        return fly(model, self.nominal, self.pilot, flight, start, shadows)

    def predict(self, rig: Rig, record: Record, step_s: float) -> Array:
        """Free runs of an effect-free rig."""
        return predict(rig, record, step_s)


def draw_bench(nominal: Rig, plan: Plan, rng: Generator) -> Bench:
    """A rig within its stated spread, a controller of some bandwidth, a style."""
    stated = [name for effect in plan.effects for name in effect.absent]
    # Now and then the plant file denies dry friction and the rig has none: an absent term alone must tell nothing.
    stated += [name for name in ("b_cE", "b_cA") if rng.random() < 0.1 and name not in stated]
    absent = tuple(sorted(stated))
    zero = {name: np.zeros(1) for name in absent}
    known = replace(nominal.with_values(zero), sds={**nominal.sds, **zero})
    exact = plan.kind == "nominal" and rng.random() < 0.25
    true = known if exact else draw_rig(known, rng)
    style = draw_style(rng, plan.excited, RUN_S)
    if any(effect.needs == "reversal" for effect in plan.effects):
        style = replace(style, dither_V=(style.dither_V[0], 1.5 + 1.5 * style.excited), azimuth_rad=1.4)
    lab = FirstLab(known, make_pilot(known, float(rng.uniform(0.85, 1.15))), style)
    return Bench(known, true, lab, training=2, logging=LOGGING, restated=stated_zero(absent))
