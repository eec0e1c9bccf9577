"""A linear model under recorded inputs: its forced motion, and the start and trim that the record had besides."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from identification.frequency.lateral import StateSpace
from identification.frequency.models import discrete
from identification.frequency.record import Record

Array = NDArray[np.float64]
MOST_GROWTH = 5.0  # an unstable motion is begun anew before it has grown by exp(5)


@dataclass(frozen=True, eq=False)
class LinearRun:
    """Outputs y (n, outputs) of a model over a record, and of how many stretches with a start of their own they are made."""

    y: Array
    stretches: int


def linear_run(of: StateSpace, record: Record) -> LinearRun:
    """The model under the record's inputs; start, constant input error and output offset of each stretch by least squares.

    A record begins in trim, not at zero, and its trim is not known exactly. A model that is unstable runs in stretches so short that
    none grows by more than exp(5).
    """
    fastest = float(np.max(np.linalg.eigvals(of.A).real))
    count = max(1, int(np.ceil(fastest * record.duration_s / MOST_GROWTH)))
    edges = np.rint(np.linspace(0, record.u.shape[0], count + 1)).astype(int)
    scale = np.maximum(np.std(record.y, axis=0), 1e-300)
    y = np.empty_like(record.y)
    for a, b in pairwise(edges.tolist()):
        y[a:b] = _stretch(of, record.u[a:b], record.y[a:b], record.period_s, scale)
    return LinearRun(y, count)


def _stretch(of: StateSpace, u: Array, y: Array, period_s: float, scale: Array) -> Array:
    columns = _columns(of, u, period_s)
    forced, besides = columns[:, :, 0], columns[:, :, 1:]
    offsets = np.broadcast_to(np.eye(y.shape[1]), (y.shape[0], y.shape[1], y.shape[1]))
    free = np.concatenate([besides, offsets], axis=2)
    M = (free / scale[None, :, None]).reshape(y.size, -1)
    size = np.maximum(np.linalg.norm(M, axis=0), 1e-300)
    found = np.linalg.lstsq(M / size, ((y - forced) / scale).ravel(), rcond=1e-9)[0] / size
    return np.asarray(forced + free @ found)


def _columns(of: StateSpace, u: Array, period_s: float) -> Array:
    """Outputs (n, outputs, 1 + states + inputs): under u from zero, from each state at 1, under each input at 1."""
    A_d, B_d = discrete(of, period_s)
    (n, m), rows = of.B.shape, u.shape[0]
    trim = np.mean(u, axis=0)
    X = np.zeros((n, rows, 1 + n + m))
    X[:, 1:, 0] = B_d @ (u - trim)[:-1].T
    X[:, 0, 1 : 1 + n] = np.eye(n)
    X[:, 1:, 1 + n :] = B_d[:, None, :]
    y = np.asarray(np.einsum("ks,snc->nkc", of.C, _accumulated(A_d, X)))
    before = np.vstack([u[:1], u[:-1]]) - trim
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
