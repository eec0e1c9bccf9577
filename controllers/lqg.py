"""LQG of each axis: a Kalman filter that knows the rotor's lag and estimates what voltage is missing, and an LQR on its estimate.

    m <- m + alpha (u - m)                                   the rotor's lag in volts, u the limited voltage            (C.8)
    p = m + d - u_ff(Psi)                                    what drives the arm beyond its rest at this elevation      (C.9)
    x <- x + beta_p p + beta_v v + beta_u (u - m)            angle                                                     (C.10)
    v <- v + gamma_p p + gamma_v v + gamma_u (u - m)         its rate;   d, the missing voltage, stays                   (C.11)
    x, v, d <- x, v, d + (l_x, l_v, l_d) (angle - x)         the steady-state Kalman filter                              (C.12)
    u = u_ff(r) - d - k_m (m + d - u_ff(r)) - k_x (x - r) - k_v v                                                        (C.13)

(C.8) to (C.11) are the linearised rotor and arm of (4)-(9), sampled with a zero-order hold; u_ff is the feed-forward of eq (28),
of which gravity's stiffness is the slope, so the model is right at every elevation and not only near one. d takes up whatever the
plant file does not know - weight, thrust, friction, the other axis - and is the integral action; as the filter is given the limited
voltage, nothing winds up. So r is the reference as it comes: the regulator goes to it as fast as its weights say, and a filter before it
would only be slower. The coefficients are polynomials in the elevation, fitted over the operating points, each of the lowest degree
that is within 8 %; what they are at one point stands in controllers/lqg_gains.py.
"""

from dataclasses import dataclass
from typing import Any, Generic, TypeVar

import numpy as np
from numpy.polynomial.polynomial import polyval
from numpy.typing import NDArray

from codegen.law_frame import LawNumbers, Sample, polynomial
from controllers.equations.designing import Points, axis_table, law_table
from controllers.equations.equation_controller import EquationController
from controllers.equations.frame import AxisNumbers, Decisions
from controllers.lqg_gains import WEIGHTS, gains_at
from design.schedule import fit, stored_fit
from records.law_table import LawTable
from records.table import AXES, Polynomial

N = TypeVar("N")
Array = NDArray[np.float64]

ANGLE_MAX_RAD, RATE_MAX_RAD_S, MISSING_MAX_V = 8.0, 50.0, 10.0  # beyond: a broken state


@dataclass(frozen=True)
class LqgGains:
    """Polynomials in Psi of (C.8) to (C.13), and the ends of the state."""

    alpha: Polynomial
    beta_p: Polynomial
    beta_v: Polynomial
    beta_u: Polynomial
    gamma_p: Polynomial
    gamma_v: Polynomial
    gamma_u: Polynomial
    l_x: Polynomial
    l_v: Polynomial
    l_d: Polynomial
    k_m: Polynomial
    k_x: Polynomial
    k_v: Polynomial
    angle_max_rad: float
    rate_max_rad_s: float
    missing_max_V: float


@dataclass(frozen=True)
class LqgState(Generic[N]):
    """What one axis remembers: filtered reference, the rotor's lag, angle, rate, missing voltage."""

    reference_1_rad: N
    reference_2_rad: N
    rotor_V: N
    angle_rad: N
    rate_rad_s: N
    missing_V: N


class Lqg:
    """The equations of one axis, name by name and operation by operation as in templates/lqg.c.j2."""

    AxisState = LqgState

    def axis_rest(
        self,
        law: LawNumbers[N],
        axis: AxisNumbers[N],
        arithmetic: Decisions[N],
        reference_rad: N,
        angle_rad: N,
        schedule_rad: N,
    ) -> LqgState[N]:
        """The operating point at this elevation: the rotor at the speed that holds the arm there, the arm at rest, nothing missing."""
        limit_rad = axis.gains.angle_max_rad
        rest_V = polynomial(axis.feedforward_V, schedule_rad, law.zero)
        return LqgState(
            reference_rad,
            reference_rad,
            arithmetic.saturate(rest_V, axis.u_min_V, axis.u_max_V, law.zero),
            arithmetic.clamp(angle_rad, -limit_rad, limit_rad),
            law.zero,
            law.zero,
        )

    def axis_step(
        self,
        law: LawNumbers[Any],
        axis: AxisNumbers[Any],
        arithmetic: Decisions[Any],
        state: LqgState[Any],
        sample: Sample[Any],
    ) -> tuple[LqgState[Any], Any]:
        """(C.12), (C.13), the limits, (C.8) to (C.11)."""
        gains, psi_rad = axis.gains, sample.schedule_rad

        def at(coefficients: Any) -> Any:
            return polynomial(coefficients, psi_rad, law.zero)

        innovation_rad = sample.angle_rad - state.angle_rad
        x_rad = state.angle_rad + at(gains.l_x) * innovation_rad
        v_rad_s = state.rate_rad_s + at(gains.l_v) * innovation_rad
        d_V = state.missing_V + at(gains.l_d) * innovation_rad
        d_V = arithmetic.saturate(d_V, -gains.missing_max_V, gains.missing_max_V, law.zero)

        m_V = arithmetic.saturate(state.rotor_V, axis.u_min_V, axis.u_max_V, law.zero)
        feedback_V = (
            at(gains.k_m) * (m_V + d_V - sample.u_ff_V)
            + at(gains.k_x) * (x_rad - state.reference_2_rad)
            + at(gains.k_v) * v_rad_s
        )
        u_V = sample.u_ff_V - d_V - feedback_V
        limited_V: Any = arithmetic.saturate(u_V, axis.u_min_V, axis.u_max_V, axis.u_safe_V)

        step_V = limited_V - m_V
        p_V = m_V + d_V - polynomial(axis.feedforward_V, psi_rad, law.zero)
        x_rad = x_rad + (at(gains.beta_p) * p_V + at(gains.beta_v) * v_rad_s + at(gains.beta_u) * step_V)
        v_rad_s = v_rad_s + (at(gains.gamma_p) * p_V + at(gains.gamma_v) * v_rad_s + at(gains.gamma_u) * step_V)
        remembered = LqgState(
            state.reference_1_rad,
            state.reference_2_rad,
            m_V + at(gains.alpha) * step_V,
            arithmetic.saturate(x_rad, -gains.angle_max_rad, gains.angle_max_rad, law.zero),
            arithmetic.saturate(v_rad_s, -gains.rate_max_rad_s, gains.rate_max_rad_s, law.zero),
            d_V,
        )
        return remembered, limited_V


def design(points: Points) -> LawTable[LqgGains]:
    """Both axes from Riccati equations at each operating point, fitted over the elevation."""
    values = {axis: _values(points, axis) for axis in AXES}
    degrees = {name: max(_degree(points, values[axis][name]) for axis in AXES) for name in NAMES}
    axes = {axis: axis_table(points, axis, _gains(points, axis, values[axis], degrees), 0.0) for axis in AXES}
    return law_table("lqg", points, axes, {axis: vars(WEIGHTS[axis]) for axis in AXES})


NAMES = tuple(LqgGains.__dataclass_fields__)[:13]
FIT = 0.08


def _values(points: Points, axis: str) -> dict[str, Array]:
    """Each coefficient at the operating points (points,)."""
    resolution_rad = points.bound.plant.sensors[points.settings.loop(axis).output]
    Ts_s, weights = points.settings.sample_period_s, WEIGHTS[axis]
    designs = [gains_at(plant, weights, Ts_s, resolution_rad) for plant in points.behind_one_lag(axis)]
    return {name: np.array([entry[name] for entry in designs]) for name in NAMES}


def _degree(points: Points, values: Array) -> int:
    """The lowest degree that fits the values to FIT of their largest: every power costs cycles, and most coefficients hardly vary."""
    most = points.settings.coefficient_degree
    for degree in range(most):
        error = np.max(np.abs(polyval(points.psi_rad, fit(points.psi_rad, values, degree)) - values))
        if error <= FIT * np.max(np.abs(values)):
            return degree
    return most


def _gains(points: Points, axis: str, values: dict[str, Array], degrees: dict[str, int]) -> LqgGains:
    return LqgGains(
        **{name: stored_fit(points.psi_rad, values[name], degrees[name]) for name in NAMES},
        angle_max_rad=ANGLE_MAX_RAD,
        rate_max_rad_s=RATE_MAX_RAD_S,
        missing_max_V=MISSING_MAX_V,
    )


CONTROLLER = EquationController(
    name="lqg",
    title="LQG: Kalman filter and LQR, scheduled",
    source="ours: what the papers' controllers are to be beaten by",
    plants="a helicopter of two axes, each behind one rotor lag, as `ce150`, on which it settles",
    needs="its filter knows a rotor's lag and an arm that gravity turns",
    note=(
        "is a Kalman filter, which knows the rotor's lag and estimates the voltage that is missing for whatever the plant file "
        "does not know, and an LQR on its estimate, both from Riccati equations at the 17 operating points and scheduled by "
        "polynomials in the elevation. That estimate is the integral action, and as the filter is told the limited voltage "
        "nothing winds up, so its references need no filter. Its weights are, of some twenty sets an axis, those of least IAE "
        "that overshot by less than 1 % on a hundred spread plants of seed 101, which are not those below, with no more travel of the "
        "voltage than the scheduled law's without a roll-off (13.9 V/s), begun there as if its rotors stood still. In the air it "
        "begins at the operating point: its rotors turn as fast as holds the arm where it is."
    ),
    equations=Lqg(),
    gains=LqgGains,
    tables=design,
    template="lqg.c.j2",
)
