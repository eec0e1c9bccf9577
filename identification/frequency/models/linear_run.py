"""A linear model under recorded inputs: its forced motion, and the start and trim that the record had besides."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from identification.frequency.lateral import StateSpace
from identification.frequency.models.linear_model import discrete
from identification.frequency.responses.record import Record

Array = NDArray[np.float64]
MOST_GROWTH = 5.0  # an unstable motion is begun anew before it has grown by exp(5)


@dataclass(frozen=True, eq=False)
class LinearRun:
    """Outputs y (n, outputs) of a model over a record, and of how many stretches with a start of their own they are made."""

    y: Array
    stretches: int


def linear_run(of: StateSpace, record: Record, stretch_s: float = np.inf) -> LinearRun:
    """The model under the record's inputs in stretches of `stretch_s`, by default one; the start of each by least squares.

    A record begins in trim, not at zero, and its trim is not known exactly: a constant error of each input and an offset of each output
    are found with the starts, one for the whole record. An unstable model runs in stretches in which it grows by exp(5) at most.
    """
    growth = float(np.max(np.linalg.eigvals(of.A).real)) * record.duration_s / MOST_GROWTH
    count = max(1, int(np.ceil(growth)), int(np.ceil(record.duration_s / stretch_s - 1e-9)))
    edges = np.unique(np.rint(np.linspace(0, record.u.shape[0], count + 1)).astype(int))
    spread = np.std(record.y, axis=0)
    scale = np.where(spread > 0.0, spread, 1.0)
    parts = [
        _stretch(of, record.u[a:b] - np.mean(record.u, axis=0), record.y[a:b], record.period_s, scale)
        for a, b in pairwise(edges.tolist())
    ]
    trim = _least_squares(np.concatenate([part.trim for part in parts]), np.concatenate([part.left for part in parts]))
    left = [part.left - part.trim @ trim for part in parts]
    return LinearRun(record.y - np.concatenate(left).reshape(record.y.shape) * scale, count)


@dataclass(frozen=True, eq=False)
class _Stretch:
    """What a stretch's start cannot explain of its readings, `left` (rows outputs,), and of the responses to trim (rows outputs, trims)."""

    left: Array
    trim: Array


def _stretch(of: StateSpace, u: Array, y: Array, period_s: float, scale: Array) -> _Stretch:
    columns, n = _columns(of, u, period_s), of.A.shape[0]
    offsets = np.broadcast_to(np.eye(y.shape[1]), (y.shape[0], y.shape[1], y.shape[1]))
    trim = np.concatenate([columns[:, :, 1 + n :], offsets], axis=2)
    start, besides = ((part / scale[None, :, None]).reshape(y.size, -1) for part in (columns[:, :, 1 : 1 + n], trim))
    left = ((y - columns[:, :, 0]) / scale).ravel()
    every = np.column_stack([left, besides])
    every = every - start @ _least_squares(start, every)
    return _Stretch(every[:, 0], every[:, 1:])


def _least_squares(M: Array, y: Array) -> Array:
    """The smallest x of all that minimise |M x - y|, columns weighed alike."""
    size = np.maximum(np.linalg.norm(M, axis=0), 1e-300)
    found = np.linalg.lstsq(M / size, y, rcond=1e-9)[0]
    return np.asarray((found.T / size).T)


def _columns(of: StateSpace, u: Array, period_s: float) -> Array:
    """Outputs (n, outputs, 1 + states + inputs): under u from zero, from each state at 1, under each input at 1."""
    A_d, B_d = discrete(of, period_s)
    (n, m), rows = of.B.shape, u.shape[0]
    X = np.zeros((n, rows, 1 + n + m))
    X[:, 1:, 0] = B_d @ u[:-1].T
    X[:, 0, 1 : 1 + n] = np.eye(n)
    X[:, 1:, 1 + n :] = B_d[:, None, :]
    y = np.asarray(np.einsum("ks,snc->nkc", of.C, _accumulated(A_d, X)))
    before = np.vstack([u[:1], u[:-1]])
    y[:, :, 0] += before @ of.D.T
    y[:, :, 1 + n :] += of.D
    return y


def _accumulated(A_d: Array, X: Array) -> Array:
    """x_k = sum over j <= k of A_d^(k - j) X_j for X (states, n, columns), by doubling: log2 n products instead of n."""
    x, power, reach = X, A_d, 1
    while reach < X.shape[1]:
        carried = power @ x[:, :-reach].reshape(x.shape[0], -1)
        x = x.copy()
        x[:, reach:] += carried.reshape(x.shape[0], -1, x.shape[2])
        power, reach = power @ power, 2 * reach
    return x
