"""A push from outside, once.

(1)  torque + torque (t_0 <= t < t_0 + duration), with edges of EDGE_S
"""

from collections.abc import Iterator

from sim.edits import EDGE_S, step, with_torque
from sim.effect import Effect, EffectParameter, Role
from sim.model import Model
from sim.prior import COMMON, Unlikely

LONG = Unlikely(-2.0, "a push by hand is short: what lasts longer is rather something that changed", above=5.0)


def effects(model: Model) -> Iterator[Effect]:
    """Eq (1) on each axis."""
    for axis, entry in model.places.axes.items():
        size = entry.torque_size
        yield Effect(
            name=f"{axis}.disturbance",
            depends="torque(t)",
            parameters=(
                EffectParameter("torque", entry.torque_unit, -size, size, 0.075 * size, 0.0),
                EffectParameter("t_0", "s", 0.0, 1.0e5, 10.0, role=Role.INSTANT),
                EffectParameter(
                    "duration", "s", 0.05, 1.0e3, 1.0, starts=(0.3, 1.0, 3.0), role=Role.DURATION, unlikely=LONG
                ),
            ),
            equation=f"+ torque for t_0 <= t < t_0 + duration, edges {EDGE_S:g} s",
            story="Someone or something pushed it during the run.",
            source="a push by hand",
            prior=COMMON,
            edit=lambda model, torque, t_0, duration, axis=axis: with_torque(
                model, axis, torque * (step(t_0) - step(t_0 + duration))
            ),
            smooth=False,
        )
