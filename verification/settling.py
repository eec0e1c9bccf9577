"""Whether the law that flies brings its plant to rest: its own arithmetic, flown; the gate of the design looked at its coefficients alone.

A law of slow poles at a short period moves its input by less in a sample than its arithmetic tells apart: coefficients as rounded as they
fly leave every pole and margin in place, and the flight does not come to rest.
"""

from controllers import loading
from controllers.settling import begins_rad, last_error
from design.settings import read_settings
from records.errors import BadInput
from records.law_table import FlownTable
from records.text.units import said
from sim.added_effects import without_effects
from sim.bind import BoundPlant
from verification.host_law import HostLaw

# The largest error at the end of a settled flight [of the range of the references], beside STEPS of the sensor that any loop may hunt by,
# before the law in double precision is asked. A heated pipe of five cells with poles from -0.8 rad/s on ends at its reference in double
# precision at 20 ms, 0.02 off in float32 and 0.8 off in fixed point. Of the tests' plants the farthest off is quanser_aero, by one step,
# 0.008.
SHARE, STEPS = 0.01, 2.0
# How much farther off than in double precision it may end: what does not settle in either is no fault of the arithmetic.
TIMES = 2.0


def demand_settled(bound: BoundPlant, table: FlownTable, arithmetic: str) -> None:
    """Raise BadInput naming operating point, axis and both errors where the generated law ends a flight from rest farther off than the
    same law in double precision; see controllers/settling.py for the flights.
    """
    seen = without_effects(bound)
    settings = read_settings(seen)
    law = HostLaw(loading.generate(table, arithmetic), arithmetic, loops=table.loops)
    for begin_rad in begins_rad(table):
        flown = last_error(seen, settings, table, law, begin_rad)
        limits = [
            SHARE * (axis.reference_max_rad - axis.reference_min_rad) + STEPS * axis.resolution_rad
            for axis in table.axes
        ]
        if all(error <= limit for error, limit in zip(flown.tolist(), limits, strict=True)):
            continue
        exact = last_error(seen, settings, table, loading.row_of(table).float_law(table), begin_rad)
        for loop, error, own, limit in zip(table.loops, flown.tolist(), exact.tolist(), limits, strict=True):
            if not error <= limit + TIMES * own:
                raise BadInput(
                    f"law in {arithmetic}",
                    settings.place(loop.axis, begin_rad),
                    f"{said(loop.output, error)} off at the end of a flight from rest",
                    f"{said(loop.output, own)}, as in double precision",
                    "choose faster poles, a longer sample_period_s, or the other arithmetic: "
                    "what the input moves by in a sample is lost in its last digits",
                )
