"""Laws that the seed's text, or habit, suggests and that fail: each is the true law with one thing changed."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from design.direct_form import DirectForm, to_direct
from design.law import polynomial, saturate
from design.schedule import evaluate, schedule_of
from records.table import AxisLaw, ControllerTable

History = tuple[float, float, float]


@dataclass
class _Axis:
    x: list[float]
    errors: History = (0.0, 0.0, 0.0)
    outputs: History = (0.0, 0.0, 0.0)
    forms: list[DirectForm] = field(default_factory=list)


# What the recursion keeps of (v, feed-forward, limited u): v itself works, the others are the traps.
FEEDBACK: Callable[[float, float, float], float] = lambda v, feedforward, u: v  # noqa: E731
TOTAL: Callable[[float, float, float], float] = lambda v, feedforward, u: u  # noqa: E731
CLAMPED: Callable[[float, float, float], float] = lambda v, feedforward, u: u - feedforward  # noqa: E731


class DirectLaw:
    """Eq (27) as it is written, in direct form, over one of three histories.

    `kept` FEEDBACK is the unsaturated recursion on u_fb; TOTAL is the literal eq (27), on the total voltage; CLAMPED feeds the
    limited voltage back ("fb" anti-windup). `measured_feedforward` takes u_ff at the measured elevation instead of the reference's.
    `delayed_coefficients` multiplies a past sample with its own coefficients q_i(k-i), as printed, not with the present ones.
    """

    def __init__(
        self,
        table: ControllerTable,
        kept: Callable[[float, float, float], float] = FEEDBACK,
        *,
        measured_feedforward: bool = False,
        delayed_coefficients: bool = False,
    ) -> None:
        self.table, self.kept = table, kept
        self.measured_feedforward, self.delayed_coefficients = measured_feedforward, delayed_coefficients
        self.axes = [_Axis([0.0, 0.0]), _Axis([0.0, 0.0])]

    def reset(self, *angles_rad: float) -> None:
        self.axes = [_Axis([angle, angle]) for angle in angles_rad]

    def step(self, *given_rad: float) -> tuple[float, ...]:
        references, angles = given_rad[:2], given_rad[2:]
        psi_rad, laws = angles[0], self.table.axes
        for law, axis, reference in zip(laws, self.axes, references, strict=True):
            gain = law.prefilter_gain(self.table.sample_period_s)
            axis.x[0] += gain * (reference - axis.x[0])
            axis.x[1] += gain * (axis.x[0] - axis.x[1])
        feedforward_at = psi_rad if self.measured_feedforward else self.axes[0].x[1]
        u_M, u_T = (
            self._axis(law, axis, angle, psi_rad, feedforward_at)
            for law, axis, angle in zip(laws, self.axes, angles, strict=True)
        )
        return u_M, u_T

    def _axis(self, law: AxisLaw, axis: _Axis, angle: float, psi_rad: float, feedforward_at: float) -> float:
        within = float(np.clip(psi_rad, self.table.schedule.min_rad, self.table.schedule.max_rad))
        axis.forms = [to_direct(evaluate(schedule_of(law), within)), *axis.forms][:4]
        errors = (axis.x[1] - angle, *axis.errors)
        v = _feedback_V(self._form(axis), errors, axis.outputs)
        feedforward = polynomial(law.feedforward_V, feedforward_at)
        u = saturate(law, v + feedforward)
        axis.errors = errors[:3]
        axis.outputs = (self.kept(v, feedforward, u), *axis.outputs[:2])
        return u

    def _form(self, axis: _Axis) -> DirectForm:
        """The present coefficients, or each coefficient i as it was i samples ago."""
        if not self.delayed_coefficients:
            return axis.forms[0]
        past = [axis.forms[min(i, len(axis.forms) - 1)] for i in range(4)]
        return DirectForm(np.array([past[i].q[i] for i in range(4)]), np.array([past[i].p[i] for i in range(4)]))


def _feedback_V(form: DirectForm, errors_rad: Sequence[float], outputs_V: Sequence[float]) -> float:
    """Eq (27): sum q_i e(k-i) - sum p_i u_fb(k-i) from errors (n + 1,) of k .. k-n and outputs (order,) of k-1, k-2 ..

    The outputs are those of the feedback alone. The paper writes the total voltage, which multiplies the feed-forward by 1/P(1).
    """
    return float(np.dot(form.q, errors_rad) - np.dot(form.p[1:], outputs_V))
