"""PID of both axes: one set of gains an axis, derivative on the filtered angle, back-calculation against windup.

    e = filtered reference - angle,   y_f <- y_f + g (angle - y_f),   g = 1 - exp(-Ts/Tf)
    v = k_p e + I - (k_d / Tf) (angle - y_f)                                                         (C.1)
    u = v + u_ff,   limited;   I <- I + k_i Ts e + (Ts / Tt) (limited u - u),   Tt = sqrt(Ti Td)       (C.2)

Seed 001 compares its fuzzy controllers with PID controllers "previously designed" and prints no gains; how they are tuned here stands
in controllers/pid_tuning.py. (C.2) is back-calculation with the tracking time that Astrom and Hagglund recommend (Advanced PID Control,
2006, section 3.5). Angles in rad, voltages in V.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

import numpy as np

from codegen.law_frame import LawNumbers, Sample
from controllers.coupled import LinearController, demand_held_together
from controllers.equations.designing import Points, axis_table, largest_output, law_table
from controllers.equations.equation_controller import EquationController
from controllers.equations.frame import AxisNumbers, Decisions
from controllers.equations.tuned import Numbers, OpenNumber, Tunable, tuned
from controllers.pid_tuning import Tuning, tune
from design.table import limits_V, plain
from records.law_table import LawTable
from records.table import AXES, lag_gain

N = TypeVar("N")


@dataclass(frozen=True)
class PidGains:
    """k_p, k_i Ts, k_d / Tf of (C.1) and (C.2), the gain g of the angle's filter, Ts / Tt, and the widest I."""

    k_p_V_rad: float
    k_i_Ts_V_rad: float
    k_d_Tf_V_rad: float
    filter_gain: float
    tracking_gain: float
    i_max_V: float
    y_max_rad: float


@dataclass(frozen=True)
class PidState(Generic[N]):
    """What one axis remembers: filtered reference, filtered angle, the integral."""

    reference_1_rad: N
    reference_2_rad: N
    filtered_rad: N
    integral_V: N


class Pid:
    """The equations of one axis, name by name and operation by operation as in templates/pid.c.j2."""

    AxisState = PidState

    def axis_rest(
        self,
        law: LawNumbers[N],
        axis: AxisNumbers[N],
        arithmetic: Decisions[N],
        reference_rad: N,
        angle_rad: N,
        schedule_rad: N,
    ) -> PidState[N]:
        """The filters at the angle, nothing integrated."""
        filtered_rad = arithmetic.clamp(angle_rad, -axis.gains.y_max_rad, axis.gains.y_max_rad)
        return PidState(reference_rad, reference_rad, filtered_rad, law.zero)

    def axis_step(
        self,
        law: LawNumbers[N],
        axis: AxisNumbers[N],
        arithmetic: Decisions[N],
        state: PidState[Any],
        sample: Sample[Any],
    ) -> tuple[PidState[N], N]:
        """(C.1), the limits, (C.2)."""
        gains, angle_rad = axis.gains, sample.angle_rad
        e_rad = state.reference_2_rad - angle_rad
        filtered_rad = state.filtered_rad + gains.filter_gain * (angle_rad - state.filtered_rad)
        filtered_rad = arithmetic.saturate(filtered_rad, -gains.y_max_rad, gains.y_max_rad, law.zero)
        v_V = gains.k_p_V_rad * e_rad + state.integral_V - gains.k_d_Tf_V_rad * (angle_rad - filtered_rad)
        u_V = v_V + sample.u_ff_V
        limited_V: Any = arithmetic.saturate(u_V, axis.u_min_V, axis.u_max_V, axis.u_safe_V)
        integral_V = state.integral_V + gains.k_i_Ts_V_rad * e_rad + gains.tracking_gain * (limited_V - u_V)
        integral_V = arithmetic.saturate(integral_V, -gains.i_max_V, gains.i_max_V, law.zero)
        return PidState(state.reference_1_rad, state.reference_2_rad, filtered_rad, integral_V), limited_V


def design(points: Points) -> LawTable[PidGains]:
    """All axes as the plant file has tuned them, or tuned on its operating points; raises BadInput where no gains hold the sensitivity."""
    found = tuned(points, "pid", TUNABLE)
    if found is not None:
        return _tuned_table(points, found)
    tunings = {loop.axis: tune(points, loop.axis) for loop in points.settings.loops}
    _judge(points, tunings)
    axes = {axis: axis_table(points, axis, _gains(points, axis, tuning)) for axis, tuning in tunings.items()}
    return law_table("pid", points, axes, {axis: _origin(tuning) for axis, tuning in tunings.items()})


def _judge(points: Points, tunings: Mapping[str, Tuning]) -> None:
    """Raise BadInput naming the operating point at which loops that are robust alone are not together."""
    controllers = {axis: linear_controller(tuning, points.settings.sample_period_s) for axis, tuning in tunings.items()}
    for index in range(len(points.psi_rad)):
        demand_held_together(points, index, controllers, points.settings.margins.max_sensitivity)


def linear_controller(tuning: Tuning, Ts_s: float) -> LinearController:
    """(C.1) and (C.2) without limits, in the state (I, y_f)."""
    gain = lag_gain(tuning.filter_s, Ts_s)
    of_angle = tuning.k_d / tuning.filter_s * (1.0 - gain)
    return LinearController(
        np.diag([0.0, -gain]), np.array([-tuning.k_i * Ts_s, gain]), np.array([1.0, of_angle]), -tuning.k_p - of_angle
    )


FLOWN = "design.tuned"
RULE = "largest integral gain with max |1/(1 + L)| <= Ms_max at every operating point, Ti >= 4 Td, no faster than the wished poles"


def _origin(tuning: Tuning) -> dict[str, Any]:
    found = {name: plain([value])[0] for name, value in vars(tuning).items()}
    return {**found, "rule": RULE}


def _gains(points: Points, axis: str, tuning: Tuning) -> PidGains:
    Ts_s = points.settings.sample_period_s
    low_V, high_V = limits_V(points.bound, points.settings.loop(axis), points.settings.axis(axis))
    return PidGains(
        k_p_V_rad=tuning.k_p,
        k_i_Ts_V_rad=tuning.k_i * Ts_s,
        k_d_Tf_V_rad=tuning.k_d / tuning.filter_s,
        filter_gain=lag_gain(tuning.filter_s, Ts_s),
        tracking_gain=Ts_s / math.sqrt(tuning.k_d / tuning.k_i),
        i_max_V=high_V - low_V,
        y_max_rad=largest_output(points.settings.axis(axis)),
    )


def _tuned_table(points: Points, found: Mapping[str, Numbers]) -> LawTable[PidGains]:
    tunings = {
        axis: Tuning(n["k_p_V_rad"], n["k_i_V_rad_s"], n["k_d_V_s_rad"], n["filter_s"], math.nan, math.nan)
        for axis, n in found.items()
    }
    axes = {axis: axis_table(points, axis, _gains(points, axis, tuning)) for axis, tuning in tunings.items()}
    return law_table("pid", points, axes, {axis: {**numbers, "rule": FLOWN} for axis, numbers in found.items()})


# An azimuth that turns 1 rad for 0.1 V, or for 100; a derivative's filter from two samples on.
OPEN = (
    OpenNumber("k_p_V_rad", 0.05, 50.0),
    OpenNumber("k_i_V_rad_s", 0.01, 50.0),
    OpenNumber("k_d_V_s_rad", 0.005, 50.0),
    OpenNumber("filter_s", 0.02, 0.3),
)
TUNABLE = Tunable(
    open=dict.fromkeys(AXES, OPEN),
    table=_tuned_table,
    template="pid_tuning.c.j2",
    flat=lambda gains: list(vars(gains).values()),
)

CONTROLLER = EquationController(
    name="pid",
    title="PID",
    source="seed 001, section 5.2.2, which prints no gains",
    plants=(
        "any plant of one to four loops, as `ce150`, on which one set of gains a loop is robust over its range, alone and with all others "
        "closed, and settles; else one on which the gains of its [design.tuned.pid] do"
    ),
    note=(
        "has one set of gains an axis, the largest integral gain under which |1/(1 + L)| stays below 2, or where no gains do that below "
        "3, at every operating point, with Ti >= 4 Td, Tf = Td/10 and a crossover below the wished poles' geometric mean. One set of "
        "gains reaches no less than 2.5 where the plant changes as much as the CE150 does over +-40 deg. The derivative is of the "
        "filtered angle, the integral is held by back-calculation, references are filtered as the scheduled law's. Ti >= 4 Td was added "
        "when a loop of it overshot by 55 % without. Where a plant file has [design.tuned.pid], as `plants/ce150_velagic.toml`, gains and"
        " Tf are those: `twinlaw design --controller pid --tune SEED` finds them by differential evolution, as those of the least mean "
        "|error| of both axes through a flight of 120 s on that plant (`verification/comparison/tuning.py`)."
    ),
    equations=lambda _: Pid(),
    gains=PidGains,
    tables=design,
    template="pid.c.j2",
    tunable=TUNABLE,
)
