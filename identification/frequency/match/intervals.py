"""How far the parameters of a match may be off: noise of the readings carried through windows, responses and cost.

Every step from readings to responses is linear in the readings, and the match is linear in the responses to first order, so that

    (1)  theta - theta_true = sum over rows t and outputs o of  w_o(t) n_o(t)

with weights w that follow exactly from windows, inputs and the slopes of the cost (7). With the spectrum S of what a model leaves of the
readings, noise and disturbance alike,

    (2)  covariance = sum over records of  1 / N  sum over f of  W(f)^* S(f) W(f)

so correlated readings, windows that overlap, and outputs that share a disturbance all count as what they are. What (1) leaves out
is of second order in the noise, and a disturbance that the inputs themselves bring about (a nonlinearity).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.signal import csd

from identification.frequency.match.cost import W_P, Target
from identification.frequency.responses.conditioned import Responses
from identification.frequency.responses.record import Record

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
BLIND = 1e-9  # a direction of so little information, relative to the best known one, is not told by the data
PIECES = 4


@dataclass(frozen=True, eq=False)
class Slopes:
    """How the match turns with the responses: (J^T J)^-1 J^T in `gain` (parameters, 2 m), and directions that J does not see."""

    gain: Array
    unseen: Array


def slopes(J: Array, size: Array) -> Slopes:
    """From the slopes J (2 m, parameters) of the residual; `unseen` (directions, parameters) in units of the parameters, each as long as
    the `size` of the parameter that it moves most.
    """
    values, vectors = np.linalg.eigh((J * size).T @ (J * size))
    seen = values > BLIND * values[-1]
    inverse = (vectors[:, seen] / values[seen]) @ vectors[:, seen].T
    unseen = vectors[:, ~seen] / np.max(np.abs(vectors[:, ~seen]), axis=0)
    return Slopes(size[:, None] * inverse @ (J * size).T, (unseen * size[:, None]).T)


def covariance(base: Responses, records: Sequence[Record], left: Sequence[Array], points: Target, of: Slopes) -> Array:
    """(2), (parameters, parameters); `left` (n, outputs) is what the model leaves of each record. Unseen directions count as 100 %."""
    factors = _factors(base, points, of)
    firsts = [0 for _ in base.windows]
    total = of.unseen.T @ of.unseen
    longest = max(record.y.shape[0] for record in records)
    S = noise_spectrum(left, max(16, longest // PIECES))
    for record in records:
        counts = [entry.begins(record.u.shape[0]).size for entry in base.windows]
        along = [whole[first : first + count] for whole, first, count in zip(base.along, firsts, counts, strict=True)]
        firsts = [first + count for first, count in zip(firsts, counts, strict=True)]
        total = total + _by_record(_weights(base, record, factors, along), S)
    return np.asarray((total + total.T) / 2.0)


def noise_spectrum(left: Sequence[Array], rows: int) -> Complex:
    """Mean spectrum (rows, outputs, outputs) of what is left, at the frequencies k / rows per reading; white noise of variance 1 has 1."""
    channels = left[0].shape[1]
    S = np.zeros((rows, channels, channels), dtype=complex)
    fit = [entry for entry in left if entry.shape[0] >= rows]
    for entry in fit:
        for a in range(channels):
            for b in range(channels):
                S[:, a, b] += csd(entry[:, b], entry[:, a], nperseg=rows, return_onesided=False)[1] / len(fit)
    return S


def _factors(base: Responses, points: Target, of: Slopes) -> Complex:
    """c with theta - theta_true = Re sum c dT, shape (parameters, f, outputs, inputs)."""
    m = points.T.size
    by_gain = of.gain[:, :m] * (points.root_weight * 20.0 / np.log(10.0))
    by_phase = of.gain[:, m:] * (points.root_weight * np.sqrt(W_P) * 180.0 / np.pi)
    c = np.zeros((of.gain.shape[0], *base.T.shape), dtype=complex)
    c[:, points.frequency, points.output, points.input] = -(by_gain - 1j * by_phase) / points.T
    return c


def _weights(base: Responses, record: Record, factors: Complex, along: Sequence[Complex]) -> Array:
    """w of (1) for one record, (parameters, outputs, n); `along` of its own windows."""
    w = np.zeros((factors.shape[0], base.T.shape[1], record.y.shape[0]))
    for number, (of, mine) in enumerate(zip(base.windows, along, strict=True)):
        own = factors * base.weights[number]
        used = np.flatnonzero(np.any(own != 0.0, axis=(0, 2, 3)))
        kernel = np.vstack([of.kernel.real[:, used].T, -of.kernel.imag[:, used].T])
        kernel = kernel - np.mean(kernel, axis=1, keepdims=True)
        for begin, towards in zip(of.begins(record.u.shape[0]), mine, strict=True):
            g = np.einsum("pfoi,fi->pof", own[:, used], towards[used])
            w[:, :, begin : begin + of.rows] += np.concatenate([g.real, g.imag], axis=2) @ kernel
    return w


def _by_record(w: Array, S: Complex) -> Array:
    """One record's part of (2)."""
    n = w.shape[2]
    W = np.fft.fft(w, axis=2)
    places = np.rint(np.arange(n) * (S.shape[0] / n)).astype(int) % S.shape[0]
    through = np.einsum("fab,qbf->qaf", S[places], W)
    return np.asarray(np.real(np.einsum("paf,qaf->pq", np.conj(W), through)) / n)
