"""Eq (26) in closed form over any arithmetic: six poles placed by a controller of third order that integrates.

    A P + B Q = gamma^6 + c_5 gamma^5 + .. + c_0,   P = gamma (gamma^2 + p_1 gamma + p_0),   Q = q_3 gamma^3 + .. + q_0    (C.21)

with gamma = z - 1. Compared power by power, the lowest gives q_0 = c_0 / b_0 at once, and with it, one after the other,

    b_0 q_1 = c_1 - b_1 q_0 - a_0 p_0
    b_0 q_2 = c_2 - b_1 q_1 - b_2 q_0 - a_1 p_0 - a_0 p_1
    b_0 q_3 = c_3 - b_1 q_2 - b_2 q_1 - a_0 - a_2 p_0 - a_1 p_1                                                     (C.22)

as multiples of p_0 and p_1, for which two equations remain,

    p_1 + b_2 q_3 = c_5 - a_2,     p_0 + a_2 p_1 + b_1 q_3 + b_2 q_2 = c_4 - a_1                                      (C.23)

whose determinant is near 1: in the limit of fast sampling B is b_0 alone, and p_1, p_0 stand there by themselves. The order of
elimination is therefore fixed, the pivots are b_0 and that determinant, and the small q_0 = Q(1), on which the slow poles hang and
which the seven equations in powers of z^-1 lose in float32, is one quotient, right to the last bits.
"""

from dataclasses import dataclass
from typing import Any

from controllers.linearisation import SampledAxis


@dataclass(frozen=True)
class Placed:
    """Q in V/rad and P in powers of delta = 1 - z^-1, as records.table has them; p_0 = P(1) = 0."""

    q_0: Any
    q_1: Any
    q_2: Any
    q_3: Any
    p_1: Any
    p_2: Any


def placed(plant: SampledAxis, target: Any, constants: Any) -> Placed:
    """(C.22) and (C.23) for the coefficients `target` c_0 .. c_5, and the change of basis to delta."""
    a_0, a_1, a_2, b_1, b_2 = plant.a_0, plant.a_1, plant.a_2, plant.b_1, plant.b_2
    inverse = constants.one / plant.b_0
    # q_i = f_i + g_i p_0 + m_i p_1, with g_1 = m_2
    f_0 = target[0] * inverse
    f_1 = (target[1] - b_1 * f_0) * inverse
    g_1 = -a_0 * inverse
    f_2 = (target[2] - b_1 * f_1 - b_2 * f_0) * inverse
    g_2 = -(a_1 + b_1 * g_1) * inverse
    f_3 = (target[3] - a_0 - b_1 * f_2 - b_2 * f_1) * inverse
    g_3 = -(a_2 + b_1 * g_2 + b_2 * g_1) * inverse
    m_3 = -(a_1 + b_1 * g_1) * inverse

    k_11, k_10 = constants.one + b_2 * m_3, b_2 * g_3
    k_01, k_00 = a_2 + b_1 * m_3 + b_2 * g_1, constants.one + b_1 * g_3 + b_2 * g_2
    y_1, y_0 = target[5] - a_2 - b_2 * f_3, target[4] - a_1 - b_1 * f_3 - b_2 * f_2
    determinant = constants.one / (k_11 * k_00 - k_10 * k_01)
    p_1 = (k_00 * y_1 - k_10 * y_0) * determinant
    p_0 = (k_11 * y_0 - k_01 * y_1) * determinant
    q = (f_0, f_1 + g_1 * p_0, f_2 + g_2 * p_0 + g_1 * p_1, f_3 + g_3 * p_0 + m_3 * p_1)
    return _in_delta(constants, constants.one / plant.kappa, q, (p_0, p_1))


def _in_delta(constants: Any, volts: Any, q: tuple[Any, Any, Any, Any], p: tuple[Any, Any]) -> Placed:
    """gamma = delta / (1 - delta) with integer factors: each coefficient is its own power's, plus far smaller lower ones."""
    q_0, q_1, q_2, q_3 = (value * volts for value in q)
    return Placed(
        q_0=q_0,
        q_1=q_1 - constants.three * q_0,
        q_2=q_2 - constants.two * q_1 + constants.three * q_0,
        q_3=q_3 - q_2 + q_1 - q_0,
        p_1=constants.one - p[0],
        p_2=constants.one - p[1] + p[0],
    )
