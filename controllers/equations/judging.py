"""What a loop must be able to do, and its margins against those of [design]: what falls below is no controller for that plant."""

import numpy as np

from controllers.equations.designing import Points, mean_speed_rad_s
from design.analysis.margins import margins
from design.loop import OpenLoop, Poles, closed_loop_poles, plant_polynomials, slowest
from design.schedule import NOISE
from design.settings import DesignSettings
from records.errors import BadInput

REMEDY = "choose slower poles in poles_rad_s, or another controller"


def demand_margins(settings: DesignSettings, where: str, loop: OpenLoop) -> None:
    """Raise BadInput naming the pole or margin that one loop does not hold `where` it stands."""
    demand_stable("slowest closed-loop pole", where, closed_loop_poles(loop))
    found, limits = margins(loop), settings.margins
    if not found.sensitivity < limits.max_sensitivity:
        _refuse("sensitivity max|1/(1 + L)|", where, f"{found.sensitivity:.4g}", f"below {limits.max_sensitivity:.4g}")
    if not found.phase_rad >= limits.min_phase_margin_rad:
        _refuse("phase margin", where, f"{found.phase_rad:.4g} rad", f"at least {limits.min_phase_margin_rad:.4g} rad")
    if not found.delay_s >= limits.min_delay_margin_s:
        _refuse("delay margin", where, f"{found.delay_s:.4g} s", f"at least {limits.min_delay_margin_s:.4g} s")


def demand_held_at_rest(points: Points, axis: str) -> None:
    """Raise BadInput naming the operating point where a steady input holds the output nowhere: what integrates would drift there unseen."""
    step = mean_speed_rad_s(points.settings.axis(axis)) * points.settings.sample_period_s
    for psi_rad, plant in zip(points.psi_rad.tolist(), points.sampled(axis), strict=True):
        b = np.abs(plant_polynomials(plant).b)
        if b[0] <= NOISE * np.max(b * step ** np.arange(len(b))):
            loop = points.settings.loop(axis)
            got = f"a steady {loop.input} that does not move {loop.output}"
            expected = "an input that holds the output off its rest, or drives it on: the controller integrates"
            remedy = (
                f"measure what {loop.input} holds, or choose free_degree without integral action for the scheduled law"
            )
            raise BadInput("loop", points.settings.place(axis, psi_rad), got, expected, remedy)


def demand_robust(settings: DesignSettings, where: str, sensitivity: float, limit: float) -> None:
    """Raise BadInput where a loop's max |1/(1 + L)|, the other loops closed, is above `limit` or the margin of [design]."""
    limit = min(limit, settings.margins.max_sensitivity)
    if not sensitivity <= limit:
        what = "coupled margin, sensitivity max|1/(1 + L)| with the other loops closed"
        _refuse(what, where, f"{sensitivity:.4g}", f"at most {limit:.4g}")


def demand_stable(what: str, where: str, poles: Poles) -> None:
    """Raise BadInput where a pole [rad/s] is not to the left of 0."""
    pole_rad_s = slowest(poles)
    if not pole_rad_s < 0.0:
        _refuse(what, where, f"{pole_rad_s:.4g} rad/s", "below 0 rad/s")


def _refuse(what: str, where: str, got: str, expected: str) -> None:
    raise BadInput(what, where, got, expected, REMEDY)
