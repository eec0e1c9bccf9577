"""The cost of a model against conditioned frequency responses, eq (7) of seed 002.

    J = sum over pairs of  20 / n  sum over n frequencies of  W_gamma [W_g (|T_c| - |T|)^2 + W_p (arg T_c - arg T)^2]

magnitudes in dB, phases in degrees, W_gamma = 1.58 (1 - exp(-gamma^2)), W_g = 1, W_p = 0.01745, so that 1 dB weighs like 7.57 degrees;
n = 20 frequencies of each pair, even in log omega over the range in which its coherence is good. The standard form of ref [5]
squares W_gamma; here it stands as the paper prints it. J is a sum of squares, and `residual` returns their roots.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from identification import thresholds
from identification.frequency.responses.conditioned import Responses

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
Index = NDArray[np.int64]
N_OMEGA = 20
W_G, W_P = 1.0, 0.01745
LEAST_POINTS = 4


@dataclass(frozen=True, eq=False)
class Target:
    """The points to be matched: places (m,) in frequency, output and input, the measured response there, and the root of its weight."""

    frequency: Index
    output: Index
    input: Index
    T: Complex
    root_weight: Array


def good_range(coherence: Array) -> Index:
    """Places of the longest run of frequencies whose coherence (f,) is good; none where it is shorter than four."""
    good = np.concatenate([[False], coherence >= thresholds.GOOD_COHERENCE, [False]])
    edges = np.flatnonzero(np.diff(good.astype(int)))
    begins, ends = edges[::2], edges[1::2]
    if not begins.size or np.max(ends - begins) < LEAST_POINTS:
        return np.zeros(0, dtype=np.int64)
    longest = int(np.argmax(ends - begins))
    return np.arange(begins[longest], ends[longest])


def chosen_points(coherence: Array) -> Index:
    """20 of the places of the good range, evenly spread."""
    run = good_range(coherence)
    if not run.size:
        return run
    return np.unique(run[np.rint(np.linspace(0, run.size - 1, N_OMEGA)).astype(int)])


def coherence_weight(gamma2: Array) -> Array:
    """W_gamma."""
    return np.asarray(1.58 * (1.0 - np.exp(-gamma2)))


def target(of: Responses) -> Target:
    """The points of all pairs with a good range."""
    found = [
        (k, o, i, N_OMEGA / places.size)
        for o in range(of.T.shape[1])
        for i in range(of.T.shape[2])
        for places in (chosen_points(of.coherence[:, o, i]),)
        for k in places
    ]
    k, o, i = (np.array([entry[place] for entry in found], dtype=np.int64) for place in range(3))
    share = np.array([entry[3] for entry in found])
    return Target(k, o, i, of.T[k, o, i], np.sqrt(share * coherence_weight(of.coherence[k, o, i])))


def with_response(points: Target, T: Complex) -> Target:
    """The same points and weights for a response T (f, outputs, inputs) that has been corrected."""
    return Target(
        points.frequency,
        points.output,
        points.input,
        T[points.frequency, points.output, points.input],
        points.root_weight,
    )


def residual(points: Target, T: Complex) -> Array:
    """Roots of the terms of J, (2 m,), of a model's T (f, outputs, inputs): those of magnitudes, then those of phases."""
    ratio = np.log(points.T / T[points.frequency, points.output, points.input])
    gain_dB = 20.0 / np.log(10.0) * ratio.real
    phase_deg = np.degrees(ratio.imag)
    return np.concatenate([np.sqrt(W_G) * points.root_weight * gain_dB, np.sqrt(W_P) * points.root_weight * phase_deg])


def pair_cost(points: Target, r: Array, output: int, input: int) -> float:
    """The part of J that one pair has; by ref [5] a pair below 150 to 200, and a mean below 100, is a good match."""
    mine = np.tile((points.output == output) & (points.input == input), 2)
    return float(np.sum(r[mine] ** 2))
