"""Where the first rig flies: its simulation, controller and manoeuvres behind the shared way to make a case."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from blind.rigs.bench import Bench, Logging, Plan, denied_parameters, needs_reversal
from blind.rigs.first.manoeuvre import FirstStyle, draw_style, make_inputs
from blind.rigs.first.pilot import make_pilot
from blind.rigs.first.simulation import BRISTLES, FASTEST_RAD_S, PERIOD_S, PROGRAM, ROW_STEPS
from blind.simulation import flight
from blind.simulation.ce150 import Rig, draw_rig, stated_zero
from blind.simulation.flight import Apparatus, RunInputs
from blind.simulation.record import Loss, Model, Record
from blind.simulation.rest import start_state

Array = NDArray[np.float64]
RUN_S = 60.0
TRIAL_S = 20.0
LOGGING = Logging(PERIOD_S, RUN_S, start_s=0.0, speed_noise_rad_s=0.6, speed_step_rad_s=0.001)


@dataclass(frozen=True, eq=False)
class FirstLab:
    """A rig as its controller knows it, the controller, the way to fly."""

    nominal: Rig
    pilot: Any
    style: FirstStyle

    @property
    def jitter(self) -> bool:
        """Whether the rows come at irregular times."""
        return self.style.jitter

    def inputs(self, rng: Generator, loss: Loss, run: int | None) -> RunInputs:
        """Any run in the case's style; a trial (`run` None) is shorter."""
        duration_s = TRIAL_S if run is None else RUN_S
        return make_inputs(replace(self.style, duration_s=duration_s, loss=loss.share), rng)

    def fly(self, model: Model, shadows: Sequence[Model], inputs: RunInputs) -> Record:
        """From rest at the first reference."""
        psi, phi = inputs.reference[0]
        start = start_state(self.nominal, float(psi), float(phi), FASTEST_RAD_S)
        record = flight.fly(Apparatus(PROGRAM, BRISTLES, self.nominal, self.pilot), model, inputs, start, shadows)
        # Rows on a stop over steps of all rows: a hundredth of the share. Kept, as it decided which draws became cases.
        return replace(record, stop_share=record.stop_share / ROW_STEPS)

    def predict(self, rig: Rig, record: Record, step_s: float) -> Array:
        """Free runs of an effect-free rig."""
        return flight.predict(PROGRAM, rig, BRISTLES, record, step_s)


def draw_bench(nominal: Rig, plan: Plan, rng: Generator) -> Bench:
    """A rig within its stated spread, a controller of some bandwidth, a style."""
    denied = denied_parameters(plan, rng)
    zero = {name: np.zeros(1) for name in denied}
    known = replace(nominal.with_values(zero), sds={**nominal.sds, **zero})
    exact = plan.kind == "nominal" and rng.random() < 0.25
    true = known if exact else draw_rig(known, rng)
    style = draw_style(rng, plan.excited, RUN_S)
    if needs_reversal(plan):
        style = replace(style, dither_V=(style.dither_V[0], 1.5 + 1.5 * style.excited), azimuth_rad=1.4)
    lab = FirstLab(known, make_pilot(known, float(rng.uniform(0.85, 1.15))), style)
    return Bench(known, true, lab, training=2, logging=LOGGING, restated=stated_zero(denied))
