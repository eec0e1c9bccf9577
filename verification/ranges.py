"""The ranges of states and inputs for which the rounding bound is proved, and whether a flight stayed within them."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from codegen.law_equations import AxisState, LawInput, LawState, words_from_state
from records.table import AxisLaw, ControllerTable

Range = tuple[float, float]

# The law's own rounding may carry a difference of two numbers this little (relatively) beyond the difference of their ranges.
_SLACK = 1.0 + 1e-5


@dataclass(frozen=True)
class LawRanges:
    """A range for every number of state and input."""

    state: LawState[Range]
    given: LawInput[Range]


@dataclass(frozen=True)
class Motion:
    """What is assumed of the axes: hard stops [rad], and how fast a measured angle may move from sample to sample [rad/s].

    The default rates hold for the CE150 by a margin: full thrust from stop to stop without friction reaches 10.5 rad/s in
    elevation, full thrust and reaction torque against the damping 8.4 rad/s in azimuth.
    """

    psi_limit_rad: float = 0.7854
    phi_limit_rad: float = 2.2690
    psi_rate_rad_s: float = 15.0
    phi_rate_rad_s: float = 15.0


def declared_ranges(table: ControllerTable, motion: Motion) -> LawRanges:
    """Ranges of flight: angles within the stops and moving no faster than the rates, both as the encoders show them, references
    within their limits, filters within the references' range, and saturation by no more than the span of the limits:

        e in x_2 - angle                    |delta e| <= rate Ts + step + b span(x)   |delta^2 e| <= 2 |delta e|
        s = limited u - u_ff                |delta s| <= span(s)                      |delta^2 s| <= 2 |delta s|, and so on
        |w| <= span of the limits           |delta w| <= 2 |w|                        |delta^2 w| <= 2 |delta w|
        v = s + w

    A step that starts outside, after a harder saturation say, is not covered; `share_within` tells how many of a flight's did.
    """
    psi_limit_rad = motion.psi_limit_rad + table.elevation.resolution_rad
    phi_limit_rad = motion.phi_limit_rad + table.azimuth.resolution_rad
    elevation = _axis_ranges(table, table.elevation, psi_limit_rad, motion.psi_rate_rad_s)
    azimuth = _axis_ranges(table, table.azimuth, phi_limit_rad, motion.phi_rate_rad_s)
    psi_rad, phi_rad = _around_zero(psi_limit_rad), _around_zero(phi_limit_rad)
    psi_ref_rad, phi_ref_rad = _reference(table.elevation), _reference(table.azimuth)
    return LawRanges(
        LawState(elevation, azimuth, psi_rad, phi_rad, psi_ref_rad, phi_ref_rad),
        LawInput(psi_ref_rad, phi_ref_rad, psi_rad, phi_rad),
    )


def share_within(ranges: LawRanges, states: NDArray[np.uint32]) -> float:
    """Share of float32 states, bits [n, words], all of whose numbers lie within the ranges."""
    low, high = np.array([*words_from_state(ranges.state)]).T
    numbers = states.view(np.float32).astype(np.float64)
    return float(np.mean(np.all((numbers >= low) & (numbers <= high), axis=-1)))


def _axis_ranges(table: ControllerTable, axis: AxisLaw, limit_rad: float, rate_rad_s: float) -> AxisState[Range]:
    low_rad, high_rad = _reference(axis)
    gain = axis.prefilter_gain(table.sample_period_s)
    measured_move_rad = rate_rad_s * table.sample_period_s + axis.resolution_rad
    move_rad = _SLACK * (measured_move_rad + gain * (high_rad - low_rad))
    psi_ref_rad = np.linspace(*_reference(table.elevation), 201)
    u_ff_V = np.polynomial.polynomial.polyval(psi_ref_rad, axis.feedforward_V)
    span_V = _SLACK * (axis.u_max_V - axis.u_min_V)
    slack_V = (_SLACK - 1.0) * span_V
    s_V = (axis.u_min_V - float(u_ff_V.max()) - slack_V, axis.u_max_V - float(u_ff_V.min()) + slack_V)
    s_span_V = _SLACK * (s_V[1] - s_V[0])
    return AxisState(
        reference_1_rad=(low_rad, high_rad),
        reference_2_rad=(low_rad, high_rad),
        e_0_rad=(_SLACK * (low_rad - limit_rad), _SLACK * (high_rad + limit_rad)),
        e_1_rad=_around_zero(move_rad),
        e_2_rad=_around_zero(2.0 * move_rad),
        v_V=(s_V[0] - span_V, s_V[1] + span_V),
        s_0_V=s_V,
        s_1_V=_around_zero(s_span_V),
        s_2_V=_around_zero(2.0 * s_span_V),
        s_3_V=_around_zero(_SLACK * 4.0 * s_span_V),
        w_0_V=_around_zero(span_V),
        w_1_V=_around_zero(_SLACK * 2.0 * span_V),
        w_2_V=_around_zero(_SLACK * 4.0 * span_V),
    )


def _reference(axis: AxisLaw) -> Range:
    """The reference's range as the law holds it, with limits rounded to float32."""
    return float(np.float32(axis.reference_min_rad)), float(np.float32(axis.reference_max_rad))


def _around_zero(bound: float) -> Range:
    return -bound, bound
