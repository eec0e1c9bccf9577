"""Conditioned frequency responses of several inputs and outputs, their coherence, and windows of several lengths made into one.

    (1)  T(omega) = S_yr S_ur^-1,                       with r = u in an open loop: each input's part with the others taken off
    (2)  gamma^2 = |S_yi.c|^2 / (S_ii.c S_yy.c)         partial coherence of input i and output y, the other inputs c taken off
         and no more than the multiple coherence of input and of output with r
    (3)  e = sqrt(0.55) sqrt(1 - gamma^2) / (|gamma| sqrt(2 n_d))      random error of a response over n_d windows, half overlapped

after ref [5] of seed 002. The second line of (2) is for closed loops: what goes round a loop, an encoder's steps, is coherent without
telling anything of the plant. A long window resolves low frequencies, short ones average more where there is room for many: the
responses of all lengths that hold at least two periods are averaged with the weights e^-4, which leaves a pair to the windows that
know it best.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from identification.frequency.flights.sweep import WINDOW_PERIODS
from identification.frequency.responses.record import Record
from identification.frequency.responses.spectra import Spectra, Window, outputs_of, response, spectra, window
from records.errors import BadInput

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
C_E2 = 0.55
NO_COHERENCE, FULL_COHERENCE = 1e-6, 1.0 - 1e-9
STILL = 1e-9
ALIKE = 1e-10  # inputs whose swept parts are one direction to this share of power cannot be told apart


@dataclass(frozen=True, eq=False)
class Responses:
    """T (f, outputs, inputs) at omega_rad_s (f,), its partial coherence and relative random error, of the same shape.

    `windows` are those it was made with, `weights` (windows, f, outputs, inputs) how much each counts, and `along` makes the responses of
    one length from transforms of outputs.
    """

    omega_rad_s: Array
    T: Complex
    coherence: Array
    error: Array
    windows: tuple[Window, ...]
    weights: Array
    along: tuple[Complex, ...]


def frequency_responses(records: Sequence[Record], omega_rad_s: Array, lengths_s: Sequence[float]) -> Responses:
    """(1) to (3) of all records together; raises BadInput where inputs cannot be told apart."""
    period_s = records[0].period_s
    windows = tuple(window(length, period_s, omega_rad_s) for length in lengths_s)
    _check_told_apart(records)
    found = [spectra(entry, records) for entry in windows]
    coherence = np.stack([pair_coherence(entry) for entry in found])
    error = np.stack([random_error(own, entry.windows) for own, entry in zip(coherence, found, strict=True)])
    held = np.array(
        [[entry.length_s * w >= 2.0 * np.pi * WINDOW_PERIODS * 0.999 for w in omega_rad_s] for entry in windows]
    )
    held[int(np.argmax([entry.rows for entry in windows]))] = True  # the longest is what there is
    best = np.min(np.where(held[:, :, None, None], error, np.inf), axis=0)
    raw = np.where(held[:, :, None, None], (best / error) ** 4, 0.0)
    weights = raw / np.sum(raw, axis=0)
    T = np.sum(weights * np.stack([entry.T for entry in found]), axis=0)
    mean = np.sum(weights * coherence, axis=0)
    along = tuple(entry.along for entry in found)
    return Responses(omega_rad_s, T, mean, np.sum(weights * error, axis=0), windows, weights, along)


def responses_with(base: Responses, records: Sequence[Record]) -> Complex:
    """T of other readings under the same inputs, by the same windows and weights."""
    pairs = zip(base.windows, base.along, strict=True)
    each = np.stack([response(outputs_of(entry, records), along) for entry, along in pairs])
    return np.asarray(np.sum(base.weights * each, axis=0))


def pair_coherence(of: Spectra) -> Array:
    """(2), shape (f, outputs, inputs), within 1e-6 .. 1."""
    inputs = of.S_uu.shape[1]
    by_input, by_output = of.by_r[:, None, :inputs], of.by_r[:, inputs:, None]
    least = np.minimum(partial_coherence(of), np.minimum(by_input, by_output))
    return np.clip(least, NO_COHERENCE, FULL_COHERENCE)


def partial_coherence(of: Spectra) -> Array:
    """The first line of (2), shape (f, outputs, inputs)."""
    inputs, outputs = of.S_uu.shape[1], of.S_yy.shape[1]
    gamma2 = np.empty((of.S_uu.shape[0], outputs, inputs))
    for i in range(inputs):
        rest = [j for j in range(inputs) if j != i]
        keep = [i]
        take = np.linalg.inv(of.S_uu[:, rest][:, :, rest]) if rest else np.zeros((gamma2.shape[0], 0, 0))
        to_i, to_y = of.S_uu[:, keep][:, :, rest], of.S_yu[:, :, rest]
        S_ii = np.real(of.S_uu[:, i, i] - (to_i @ take @ _adjoint(to_i))[:, 0, 0])
        S_yi = of.S_yu[:, :, i] - (to_y @ take @ _adjoint(to_i))[:, :, 0]
        S_yy = np.real(np.einsum("foo->fo", of.S_yy - to_y @ take @ _adjoint(to_y)))
        gamma2[:, :, i] = np.abs(S_yi) ** 2 / np.maximum(S_ii[:, None] * S_yy, 1e-300)
    return gamma2


def random_error(coherence: Array, windows: float) -> Array:
    """(3), as a share of |T|."""
    return np.asarray(np.sqrt(C_E2 * (1.0 - coherence) / (coherence * 2.0 * windows)))


def _adjoint(matrices: Complex) -> Complex:
    return np.asarray(np.conj(np.swapaxes(matrices, 1, 2)))


def _check_told_apart(records: Sequence[Record]) -> None:
    """In a closed loop the references are checked as well: they are what tells the inputs apart."""
    names = ", ".join(record.name for record in records)
    for what in ("u", "r"):
        moved = np.concatenate([getattr(record, what) - np.mean(getattr(record, what), axis=0) for record in records])
        size = np.linalg.norm(moved, axis=0)
        still = np.flatnonzero(size <= STILL)
        if still.size:
            got = f"input {still[0] + 1} never moves"
        elif float(np.linalg.eigvalsh((moved / size).T @ (moved / size))[0]) < ALIKE:
            got = "inputs that always move together"
        else:
            continue
        raise BadInput("inputs", names, got, "each swept on its own", "add a record in which another input is swept")


def replaced(base: Responses, T: Complex) -> Responses:
    """The same responses with other values."""
    return replace(base, T=T)
