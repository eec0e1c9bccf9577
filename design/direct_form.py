"""The paper's form of the controller, eq (22), and the change of basis to the delta form that is generated.

    Q = q_0 + q_1 z^-1 + q_2 z^-2 + q_3 z^-3,    P = 1 + p_1 z^-1 + p_2 z^-2 + p_3 z^-3 (+ p_4 z^-4)      (22), n = 3

With delta = 1 - z^-1 the same two polynomials are (records.table)

    Q = d_0 + d_1 delta + d_2 delta^2 + d_3 delta^3,    P = 1 - z^-1 [(1 - c_0) + c_1 delta + c_2 delta^2 (+ c_3 delta^3)]

so the change of basis has integer entries. The direct form is kept as reference: in it the slow poles hang on differences
of large coefficients, which a rounded table does not keep. What is in brackets is the roll-off, which the paper's controller lacks.
"""

import math
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@cache
def _binomial(count: int) -> Array:
    """z^-k = (1 - delta)^k: column k holds the coefficients of delta^0 .. delta^(count - 1). The matrix is its own inverse."""
    return np.array([[(-1) ** power * math.comb(k, power) for k in range(count)] for power in range(count)], float)


@dataclass(frozen=True)
class DirectForm:
    """Coefficients of eq (22) at one angle, ascending powers of z^-1: q (n + 1,) in V/rad, p (order + 1,) with p[0] = 1."""

    q: Array
    p: Array


@dataclass(frozen=True)
class DeltaForm:
    """The same controller in powers of delta: q (n + 1,) in V/rad and p (order,) of records.table, p[0] = P(1)."""

    q: Array
    p: Array


def to_delta(direct: DirectForm) -> DeltaForm:
    """Change of basis of Q, and of -z (P - 1) = -(p_1 + p_2 z^-1 + p_3 z^-2 + ..)."""
    order = len(direct.p) - 1
    feedback = -_binomial(order) @ direct.p[1:]
    return DeltaForm(q=_binomial(len(direct.q)) @ direct.q, p=np.append(1.0 - feedback[0], feedback[1:]))


def to_direct(delta: DeltaForm) -> DirectForm:
    """The inverse of `to_delta`."""
    order = len(delta.p)
    feedback = np.append(1.0 - delta.p[0], delta.p[1:])
    return DirectForm(q=_binomial(len(delta.q)) @ delta.q, p=np.append(1.0, -_binomial(order) @ feedback))


def controller_poles_z(direct: DirectForm) -> NDArray[np.complex128]:
    """The controller's own poles (order,): roots of z^order P."""
    return np.asarray(np.roots(direct.p), dtype=complex)
