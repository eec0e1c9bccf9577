"""A driver that can change its output only so fast.

(1)  |du/dt| <= r
"""

from collections.abc import Iterator

from sim.effect import Effect, EffectParameter, Role
from sim.model import Model
from sim.paths.input_stages import SlewLimit
from sim.prior import COMMON


def effects(model: Model) -> Iterator[Effect]:
    """Eq (1) on each input."""
    for place, entry in model.places.inputs.items():
        column = model.inputs.index(entry.variable)
        size = entry.size
        # Up to what a motor's driver needs, which crosses its range in some milliseconds.
        grid = tuple(share * size for share in (0.3, 0.7, 1.5, 3.0, 7.0, 20.0, 70.0, 200.0))
        never = 1.0e7 * size  # faster than any command changes in a sample
        unit = "s^-1" if entry.unit == "-" else f"{entry.unit} s^-1"
        yield Effect(
            name=f"{place}.slew_limit",
            depends=f"rate limit of {entry.variable}",
            parameters=(EffectParameter("r", unit, 0.02 * size, never, size, never, grid, role=Role.SLOPE),),
            equation="|du/dt| <= r",
            story="The driver changes its voltage only so fast and trails behind quick commands.",
            source="a driver's ramp",
            prior=COMMON,
            on_input=lambda values, column=column: SlewLimit(column, values["r"]),
            smooth=False,
            twins={f"{place}.lag": "both trail behind quick commands; only a limit spares small ones"},
        )
