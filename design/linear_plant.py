"""A linear plant, and the part of it that its one input moves and its one output shows.

Equal parts side by side, two rotors alike on one amplifier, have one motion that the input makes and one, their difference, that
nothing makes and nothing shows: as poles and zeros in one place it would leave eq (26) without a solution. By Krylov's spaces (Kalman,
"Mathematical description of linear dynamical systems", J. SIAM Control 1, 1963),

    V = orth(B, A B, A^2 B, ..),    x = V x_1 + W x_2,    dx_1/dt = V' A V x_1 + V' B u + ..,    dx_2/dt = W' A W x_2

and likewise of A', C' for what the output shows.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Of the largest number of the balanced plant: what rounding leaves of a difference of equal parts is some 1e-16; parts that differ by
# 1e-10 are told apart, and refused where eq (26) keeps too few digits of them.
ROUNDING = 1e-12


@dataclass(frozen=True)
class LinearPlant:
    """dx/dt = A x + B u, y = C x of deviations from an operating point; shapes (n, n), (n, m), (r, n)."""

    A: Array
    B: Array
    C: Array


def minimal(plant: LinearPlant) -> LinearPlant:
    """`plant` of one input and one output without what that input does not move and that output does not show, where that dies away.

    A plant without such a part comes back as it is, and so does one in which the part grows or stays: no law may forget that.
    """
    balanced = _balanced(plant)
    moved = _reached(balanced.A, balanced.B[:, 0])
    part, beside = _split(balanced, moved)
    shown = _reached(part.A.T, part.C[0])
    part, unseen = _split(part, shown)
    left_out = [*beside, *unseen]
    return part if left_out and max(pole.real for pole in left_out) < 0.0 else plant


def _balanced(plant: LinearPlant) -> LinearPlant:
    """The plant in units of its states, powers of two, in which its numbers are alike in size, those of B and C included."""
    from scipy.linalg import matrix_balance  # which whoever only reads a table is spared

    n = len(plant.A)
    block = np.block([[plant.A, plant.B], [plant.C, np.zeros((1, 1))]])
    scaled, _ = matrix_balance(block, permute=False)
    return LinearPlant(scaled[:n, :n], scaled[:n, n:], scaled[n:, :n])


def _reached(A: Array, b: Array) -> Array:
    """An orthonormal basis (n, k) of b, A b, A^2 b, .., by Arnoldi's iteration."""
    least, basis = ROUNDING * float(np.max(np.abs(A), initial=0.0)), (b / np.linalg.norm(b))[:, np.newaxis]
    while basis.shape[1] < len(A):
        further = A @ basis[:, -1]
        for _ in range(2):  # once more: the first leaves what it rounds
            further = further - basis @ (basis.T @ further)
        size = float(np.linalg.norm(further))
        if size <= least:
            break
        basis = np.column_stack([basis, further / size])
    return basis


def _split(plant: LinearPlant, basis: Array) -> tuple[LinearPlant, list[complex]]:
    """The plant within `basis` (n, k), and the poles beside it; as it is where there are none."""
    n, kept = basis.shape
    if kept == n:
        return plant, []
    beside = np.linalg.qr(np.column_stack([basis, np.eye(n)]))[0][:, kept:n]
    poles = np.linalg.eigvals(beside.T @ plant.A @ beside)
    return LinearPlant(basis.T @ plant.A @ basis, basis.T @ plant.B, plant.C @ basis), [complex(pole) for pole in poles]
