"""Cross spectra of records at chosen frequencies, by windows of one length: the transforms that all responses are made of.

A window of L rows is cut out, its mean taken off, weighted by Hann's window and transformed at any frequencies, not only at whole
multiples of 1 / L; windows overlap by 80 %. All of it is linear in the readings, which the intervals rest on.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.signal.windows import hann

from identification.frequency.responses.record import Record

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
OVERLAP = 0.8


@dataclass(frozen=True, eq=False)
class Window:
    """A window of `rows` at the frequencies omega_rad_s (f,): `kernel` (rows, f) transforms rows that have no mean."""

    rows: int
    period_s: float
    omega_rad_s: Array
    kernel: Complex

    @property
    def length_s(self) -> float:
        """How long it is."""
        return self.rows * self.period_s

    def begins(self, count: int) -> NDArray[np.int64]:
        """First rows of the windows of a record of `count` rows, none where it is shorter."""
        if count < self.rows:
            return np.zeros(0, dtype=np.int64)
        steps = 1 + int(np.ceil((count - self.rows) / (self.rows * (1.0 - OVERLAP)) - 1e-9))
        return np.unique(np.rint(np.linspace(0, count - self.rows, steps))).astype(np.int64)


def window(length_s: float, period_s: float, omega_rad_s: Array) -> Window:
    """Hann's window, scaled so that white noise of variance 1 has spectra of 1."""
    rows = max(8, round(length_s / period_s))
    weights = hann(rows, sym=False)
    weights /= np.sqrt(np.sum(weights**2))
    phase = np.outer(np.arange(rows) * period_s, omega_rad_s)
    return Window(rows, period_s, omega_rad_s, weights[:, None] * np.exp(-1j * phase))


def transforms(of: Window, signal: Array) -> Complex:
    """Transforms (windows, f, channels) of the windows of a signal (n, channels)."""
    begins = of.begins(signal.shape[0])
    if not begins.size:
        return np.zeros((0, of.omega_rad_s.size, signal.shape[1]), dtype=complex)
    cut = np.lib.stride_tricks.sliding_window_view(signal, of.rows, axis=0)[begins]
    cut = cut - np.mean(cut, axis=2, keepdims=True)
    return np.asarray(np.swapaxes(cut @ of.kernel.real + 1j * (cut @ of.kernel.imag), 1, 2))


@dataclass(frozen=True, eq=False)
class Spectra:
    """Sums over all windows, S_ab = sum a b^* at each frequency, (f, channels of a, channels of b).

    `by_r` (f, inputs + outputs) is the multiple coherence of the inputs, then the outputs, with r: 1 for inputs that are r themselves.
    `along` (windows, f, inputs) = r^* S_ur^-1 makes responses of the transforms of outputs: T = sum y along. `windows` is how many would
    fit side by side, which is what random errors go by.
    """

    S_uu: Complex
    S_yu: Complex
    S_yy: Complex
    by_r: Array
    along: Complex
    T: Complex
    windows: float


def spectra(of: Window, records: Sequence[Record]) -> Spectra:
    """The spectra of all records that are long enough for this window, and T = S_yr S_ur^-1."""
    u, y = (np.concatenate(parts) for parts in zip(*_transformed(of, records), strict=True))
    swept = [record.r is not record.u for record in records]
    r = np.concatenate([transforms(of, record.r) for record in records]) if any(swept) else u
    S_uu = _cross(u, u)
    S_ur = S_uu if r is u else _cross(u, r)
    along = np.einsum("wfr,fri->wfi", np.conj(r), np.linalg.inv(S_ur))
    count = sum(record.u.shape[0] / of.rows for record in records if record.u.shape[0] >= of.rows)
    by_r = multiple_coherence(np.concatenate([u, y], axis=2), r)
    return Spectra(S_uu, _cross(y, u), _cross(y, y), by_r, along, response(y, along), count)


def multiple_coherence(signals: Complex, r: Complex) -> Array:
    """Share of the power of each signal (windows, f, channels) that r (windows, f, instruments) explains, (f, channels)."""
    S_sr = _cross(signals, r)
    explained = np.einsum("fsr,frq,fsq->fs", S_sr, np.linalg.pinv(_cross(r, r), hermitian=True), np.conj(S_sr)).real
    return np.asarray(explained / np.maximum(np.sum(np.abs(signals) ** 2, axis=0), 1e-300))


def response(y: Complex, along: Complex) -> Complex:
    """T (f, outputs, inputs) from the transforms y (windows, f, outputs) of outputs."""
    return np.asarray(np.einsum("wfo,wfi->foi", y, along))


def outputs_of(of: Window, records: Sequence[Record]) -> Complex:
    """The transforms of all records' outputs."""
    return np.concatenate([transforms(of, record.y) for record in records])


def _transformed(of: Window, records: Sequence[Record]) -> list[tuple[Complex, Complex]]:
    return [(transforms(of, record.u), transforms(of, record.y)) for record in records]


def _cross(a: Complex, b: Complex) -> Complex:
    return np.asarray(np.einsum("wfa,wfb->fab", a, np.conj(b), optimize=True))
