"""Commands that get lost on the line, while the last one is held.

(1)  u(k) = u(k - 1) with probability p; which frames are lost depends on their number alone
"""

from collections.abc import Iterator

from sim.effect import Effect, EffectParameter, Role
from sim.model import Model
from sim.paths.input_stages import DroppedFrames
from sim.prior import COMMON


def effects(model: Model) -> Iterator[Effect]:
    """Eq (1) on all inputs together."""
    if not model.places.inputs:
        return
    yield Effect(
        name="loop.dropped_frames",
        depends="lost updates of " + " and ".join(str(entry.variable) for entry in model.places.inputs.values()),
        parameters=(EffectParameter("p", "-", 0.0, 0.9, 0.1, 0.0, (0.05, 0.1, 0.2), role=Role.LOSS),),
        equation="u(k) = u(k - 1) with probability p",
        story="Now and then a command gets lost and the plant keeps the last one.",
        source="a lossy line with zero-order hold",
        prior=COMMON,
        on_input=lambda values: DroppedFrames(values["p"]),
        smooth=False,
        twins={"loop.delay": "on average, a lost frame makes the input late by a share of a sample"},
    )
