"""The transfer functions (20) and (21) of a sampled plant, from its polynomials in gamma = z - 1.

Poles of a few rad/s sampled at 10 ms crowd around z = 1, where polynomials in z cancel: of B, the usual conversion keeps nine digits. In
gamma they spread around 0 and nothing cancels.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from design.discretise import SampledPlant, sample
from design.linear_plant import LinearPlant
from design.loop import plant_polynomials
from records.errors import VerificationFailed

Array = NDArray[np.float64]

# Largest difference between the first impulse response samples of the usual conversion, in z, and of the matrix exponential, as a share
# of the largest of them.
MAX_DISAGREEMENT = 1e-7


@dataclass(frozen=True)
class TransferFunction:
    """B(z)/A(z) of eq (20) in ascending powers of z^-1: b (4,) with b[0] = 0, a (4,) with a[0] = 1."""

    b: Array
    a: Array


def transfer_function(linear: LinearPlant, sample_period_s: float, where: str) -> TransferFunction:
    """The paper's c2d and ss2tf, eqs (20) and (21) of seed 000, for one input and one output, by way of gamma.

    Raises VerificationFailed naming `where` when the usual conversion of the same plant is another one.
    """
    sampled = sample(linear, sample_period_s)
    polynomials = plant_polynomials(sampled)
    _check(linear, sampled, where)
    return transfer_from_polynomials(polynomials.b, polynomials.a)


def _in_z(linear: LinearPlant, sample_period_s: float, scale: float) -> TransferFunction:
    """The same by the way that python-control takes: Pade's exponential, and B as det(zI - A + BC) - det(zI - A).

    That is the difference of two polynomials with coefficients of about 1: it keeps digits where the output is counted in a `scale`
    in which B is of about 1 as well.
    """
    from scipy.linalg import expm  # which whoever only reads a table is spared

    states = len(linear.A)
    block = np.zeros((states + 1, states + 1))
    block[:states, :states], block[:states, states:] = linear.A, linear.B
    step = expm(block * sample_period_s)
    A, B = step[:states, :states], step[:states, states:]
    a, with_output = (np.asarray(np.poly(matrix), dtype=float) for matrix in (A, A - B @ linear.C / scale))
    return TransferFunction(b=(with_output - a) * scale, a=a)


def transfer_from_polynomials(b_gamma: Array, a_gamma: Array) -> TransferFunction:
    """The same transfer function from polynomials in gamma = z - 1, ascending powers, shapes (4,)."""
    shifts = [np.atleast_1d(np.poly(np.ones(power))) for power in range(len(a_gamma))]

    def in_z(ascending: Array) -> Array:
        total = np.zeros(len(ascending))
        for coefficient, shift in zip(ascending, shifts, strict=True):
            total[len(total) - len(shift) :] += coefficient * shift
        return total

    return TransferFunction(b=in_z(b_gamma), a=in_z(a_gamma))


def _check(linear: LinearPlant, sampled: SampledPlant, where: str) -> None:
    count = 2 * (len(linear.A) + 1)
    wanted = _markov(sampled, count)
    largest = float(np.max(np.abs(wanted)))
    at = f"{where}: sampled at {1e3 * sampled.sample_period_s:g} ms"
    if not 0.0 < largest < np.inf:
        raise VerificationFailed(f"{at}, {count} samples of the impulse response reach {largest:.1e} in SI units")
    found = _in_z(linear, sampled.sample_period_s, largest)
    share = float(np.max(np.abs(_impulse_response(found, count) - wanted))) / largest
    if not share < MAX_DISAGREEMENT:
        raise VerificationFailed(
            f"{at}, the transfer function differs from the matrix exponential by {share:.1e} of the largest sample of its impulse "
            f"response (limit {MAX_DISAGREEMENT:.1e})"
        )


def _markov(sampled: SampledPlant, count: int) -> Array:
    """C (I + N)^(k-1) B for k = 1 .. count, after a 0 for k = 0."""
    state, response = sampled.B[:, 0], [0.0]
    for _ in range(count):
        response.append(float(sampled.C[0] @ state))
        state = state + sampled.N @ state
    return np.array(response)


def _impulse_response(transfer: TransferFunction, count: int) -> Array:
    response: list[float] = []
    for k in range(count + 1):
        past = sum(transfer.a[i] * response[k - i] for i in range(1, min(k, len(transfer.a) - 1) + 1))
        response.append(float((transfer.b[k] if k < len(transfer.b) else 0.0) - past))
    return np.array(response)
