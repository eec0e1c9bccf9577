"""Errors that last (rounding, a model's misfit): how many independent readings a run's correlated residuals are worth."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from identification.fit.normal_equations import Point, Starts
from identification.runs.prediction import Block
from identification.runs.run import Run

Array = NDArray[np.float64]
PIECE_S = 1.0


@dataclass(frozen=True, eq=False)
class ParameterScore:
    """One run: information H of its residuals taken as independent, scores of its pieces g (pieces, parameters)."""

    H: Array
    g: Array

    def inflation(self, weak: Array, least: float) -> float:
        """How many times more the scores vary than independent residuals would let them: trace(M H^-1) per parameter.

        M = sum over pieces of g g^T. Only directions that this run informs count; `weak` is the information that holds the others. So few
        pieces tell a variance to a share sqrt(2 / pieces) only; twice that is added, which makes it an upper limit.
        """
        A = np.linalg.inv(self.H + weak)
        informed = float(np.trace(A @ self.H))
        pieces = self.g.shape[0]
        if informed < 0.5 or pieces <= informed + 1.0:
            return 1.0
        M = self.g.T @ self.g * (pieces / (pieces - informed))
        return max(float(np.trace(A @ M)) / informed, least) * float(1.0 + 2.0 * np.sqrt(2.0 / pieces))


def score(run: Run, starts: Starts, blocks: Sequence[Block], channel: int, piece_s: float = PIECE_S) -> ParameterScore:
    """The score of one channel of a run at its optimum, with the windows' starts projected out: J - X C^-1 X^T J."""
    size = blocks[0].by_parameter.shape[1]
    H, pieces = np.zeros((size, size)), [np.zeros((0, size))]  # none of a channel that was never read
    follow = np.linalg.solve(starts.C, np.swapaxes(starts.B, 1, 2))
    for block, along in zip(blocks, follow, strict=True):
        mine = run.channel[block.place] == channel
        if not mine.any():
            continue
        J = (block.by_parameter - block.by_start @ along)[mine]
        H += J.T @ J
        begins = np.flatnonzero(np.diff(np.floor((block.at_s[mine] - run.t_s[0]) / piece_s), prepend=-1.0))
        pieces.append(np.add.reduceat(J * block.residual[mine, None], begins, axis=0))
    return ParameterScore(H, np.concatenate(pieces))


def inflations(point: Point, weak: Array) -> tuple[Array, ...]:
    """For each run the inflation of each of its channels."""
    return tuple(
        np.array([score(run, starts, own, number).inflation(weak, least) for number, least in enumerate(_least(run))])
        for run, starts, own in zip(point.runs, point.starts, point.blocks, strict=True)
    )


def _least(run: Run) -> tuple[float, ...]:
    return run.least_inflation or (1.0,) * len(run.channels)


def pieces(point: Point) -> int:
    """How many pieces of `PIECE_S` all runs have, which is what intervals rest on."""
    return sum(
        int(np.unique(np.floor((block.at_s - run.t_s[0]) / PIECE_S)).size)
        for run, own in zip(point.runs, point.blocks, strict=True)
        for block in own
    )
