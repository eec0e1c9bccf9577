"""What stands in a loop's way where eq (26) gives no usable controller: the plant's own poles and zeros.

A stable controller that makes the loop stable exists only where, between any two real zeros outside the unit circle, one at infinity
counted, an even number of real poles lies (parity interlacing; Youla, Bongiorno and Lu, "Single-loop feedback-stabilization of linear
multivariable dynamical plants", Automatica 10, 1974). With w = 1/z, that is the stretch of w from -1 to 1, and infinity is w = 0.
"""

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from design.loop import PlantPolynomials, polynomial_roots

Array = NDArray[np.float64]

# Of the largest gamma of a pole: a zero nearer 0 is one at rest, whose gamma rounding leaves at 1e-10 of that or below; the slowest motion
# of a rig that is faster than 50 ms samples lies at 1e-4 and above. Roots nearer the unit circle are not told apart from it.
AT_REST = 1e-7
SHARED = 1e-7  # likewise, of a zero from a pole: the difference of equal parts leaves less, parts 1 % apart leave 1e-4
FASTEST = 1e-12  # |z| of a pole that has died away within one sample


def advice(plant: PlantPolynomials, integrates: bool) -> str:
    """What to do about a plant that no usable controller was found for, in words."""
    zeros, poles = finite_zeros(plant), polynomial_roots(plant.a)
    if integrates and np.any(np.abs(zeros) < AT_REST * np.max(np.abs(poles))):
        return (
            "at rest this input does not move that output, so nothing holds it at a value: "
            "measure what it can hold, or make one output of several"
        )
    hidden = poles[[bool(np.any(np.abs(zeros - pole) < SHARED * np.max(np.abs(poles)))) for pole in poles]]
    if len(hidden):
        return (
            f"its motion at {_said(hidden, plant.sample_period_s)} has a pole and a zero in one place, so this input does not move it, or "
            "that output does not show it: measure or command another, or write it so that the motion is not among the states"
        )
    between = _odd_stretch(zeros, poles)
    if between:
        ends = " and ".join(_said_z(w, plant.sample_period_s) for w in between)
        return (
            f"no poles will do: between this plant's zeros at {ends} lies an odd number of unstable poles, and what holds such a "
            "loop is unstable itself; measure another output, or make one of several, as of cart and pole"
        )
    slow_zeros = zeros[
        (np.abs(1.0 + zeros) < 1.0) & (zeros.real > -1.0)
    ]  # a hold makes those left of z = 0: nobody moves slower by them
    and_zeros = f", its zeros at {_said(slow_zeros, plant.sample_period_s)}" if len(slow_zeros) else ""
    return (
        f"the plant's own poles are at {_said(poles, plant.sample_period_s)}{and_zeros}: leave a pole near each of these poles that is "
        "faster than the loop shall be, and near each zero that is slower, or choose another free_degree"
    )


def margin_advice(plant: PlantPolynomials, most_sensitivity: float, beside_poles: str = "") -> str:
    """What to do about a plant whose loop has too little margin, in words: of poles nothing, where its own leave none."""
    zeros, poles, least = finite_zeros(plant), polynomial_roots(plant.a), least_sensitivity(plant)
    far = zeros[np.abs(1.0 + zeros) > 1.0 + AT_REST]
    if least >= most_sensitivity:
        unstable = poles[np.abs(1.0 + poles) > 1.0 + AT_REST]
        beside = f" beside zeros at {_said(far, plant.sample_period_s)}" if len(far) else ""
        return (
            f"no poles will do: with unstable poles at {_said(unstable, plant.sample_period_s)}{beside} every controller has "
            f"{least:.3g} or more; measure another output, or make one of several, or sample faster"
        )
    shown = zeros[(zeros.real > -1.0)]
    and_zeros = f", its zeros at {_said(shown, plant.sample_period_s)}" if len(shown) else ""
    return f"choose other poles: the plant's own are at {_said(poles, plant.sample_period_s)}{and_zeros}{beside_poles}"


def least_sensitivity(plant: PlantPolynomials) -> float:
    """The least that max|S|, S = 1/(1 + L), can be under any controller: 1 without an unstable pole.

    At a zero z_0 outside the unit circle S is 1, at poles p outside it 0: by the maximum principle |S| reaches
    prod |(1 - p* z_0) / (z_0 - p)|, and prod |p| for the zero at infinity.
    """
    zeros, poles = 1.0 + finite_zeros(plant), 1.0 + polynomial_roots(plant.a)
    far, unstable = (z[np.abs(z) > 1.0 + AT_REST] for z in (zeros, poles))
    each = [np.prod(np.abs((1.0 - unstable.conj() * zero) / (zero - unstable))) for zero in far]
    return float(max([np.prod(np.abs(unstable)), *each]))


def finite_zeros(plant: PlantPolynomials) -> NDArray[np.complex128]:
    """The finite zeros, as gamma: leading coefficients that are rounding, or nothing, are no zeros."""
    sizes = np.abs(plant.b) * np.max(np.abs(polynomial_roots(plant.a))) ** np.arange(len(plant.b))
    kept = np.flatnonzero(sizes > AT_REST**2 * np.max(sizes))
    return polynomial_roots(plant.b[: kept[-1] + 1]) if kept[-1] else np.zeros(0, dtype=complex)


def _odd_stretch(zeros: NDArray[np.complex128], poles: NDArray[np.complex128]) -> tuple[float, ...]:
    """Two neighbouring real zeros, as w = 1/z, with an odd number of unstable real poles between; () where there are none."""
    at = sorted([0.0, *_outside(zeros)])
    unstable = _outside(poles)
    odd = (pair for pair in pairwise(at) if sum(pair[0] < w < pair[1] for w in unstable) % 2)
    return next(odd, ())


def _outside(gammas: NDArray[np.complex128]) -> list[float]:
    """w = 1/z of the real ones outside the unit circle."""
    real = [1.0 + float(gamma.real) for gamma in gammas if abs(gamma.imag) <= AT_REST * abs(gamma)]
    return [1.0 / z for z in real if abs(z) > 1.0 + AT_REST]


def _said_z(w: float, sample_period_s: float) -> str:
    if w == 0.0:
        return "infinity"
    return f"{-np.log(w) / sample_period_s:.3g} rad/s" if w > 0.0 else f"z = {1.0 / w:.3g}"


def _said(gammas: NDArray[np.complex128], sample_period_s: float) -> str:
    """Poles in rad/s, a pair as one; of what dies away within a sample they tell no more than that."""
    z = 1.0 + gammas
    slow = [np.log1p(gamma) / sample_period_s for gamma in gammas[np.abs(z) > FASTEST] if gamma.imag >= 0.0]
    told = [f"{s.real:.3g}{f' +- {s.imag:.3g}j' if s.imag else ''}" for s in sorted(slow, key=lambda s: -s.real)]
    fast = [f"{np.log(FASTEST) / sample_period_s:.3g} or faster"] * bool(np.any(np.abs(z) <= FASTEST))
    return f"{', '.join([*told, *fast])} rad/s"
