"""Sums over frequency bands, of logs that differ in length and rate, and the coherence that they give."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
BANDS_HZ = (0.0, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0)
NO_POWER = 1e-300  # power of a band in which there is nothing


def cross_power(one: Sequence[Array], other: Sequence[Array], steps_s: Sequence[float]) -> Complex:
    """Sums of A conj(B) by band (bands, ...): flights of one (rows,) and other (rows, ...), spectra over each flight's whole length."""
    total: Complex = np.zeros((len(BANDS_HZ) - 1, *other[0].shape[1:]), dtype=complex)
    for a, b, step_s in zip(one, other, steps_s, strict=True):
        A, B = np.fft.rfft(a), np.fft.rfft(b, axis=0)
        product = A.reshape(-1, *(1,) * (b.ndim - 1)) * B.conj()
        for band, bins in enumerate(_bins(len(a), step_s)):
            total[band] += product[bins].sum(axis=0)
    return total


def power(of: Sequence[Array], steps_s: Sequence[float]) -> Array:
    """Sums of |A|^2 by band (bands,)."""
    return np.asarray(cross_power(of, of, steps_s).real)


def coherence(one: Sequence[Array], other: Sequence[Array], steps_s: Sequence[float]) -> Array:
    """gamma^2 by band (bands,): |sum A conj(B)|^2 / (sum |A|^2 sum |B|^2), the spectra averaged over the band; 0 where one is nothing."""
    both = power(one, steps_s) * power(other, steps_s)
    return np.asarray(np.abs(cross_power(one, other, steps_s)) ** 2 / np.maximum(both, NO_POWER))


def averages(of: Sequence[Array], steps_s: Sequence[float]) -> Array:
    """How many independent frequencies each band's sums are over (bands,)."""
    counts = [[bins.sum() for bins in _bins(len(part), step_s)] for part, step_s in zip(of, steps_s, strict=True)]
    return np.asarray(np.sum(counts, axis=0), dtype=float)


def _bins(rows: int, step_s: float) -> list[NDArray[np.bool_]]:
    """Which frequencies of a flight lie in each band."""
    frequency = np.fft.rfftfreq(rows, step_s)
    return [(frequency >= low) & (frequency < high) for low, high in pairwise(BANDS_HZ)]
