"""How large the error of the integration step is, found by halving it."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sim.bind import BoundPlant
from sim.simulate import Conditions, Drive, simulate

ORDER = 4  # of the Runge-Kutta method
Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class StepError:
    """Runs with n and with 2 n steps per sample compared over all samples, one number per output (outputs,), in its unit.

    `difference` is the largest absolute difference of the true outputs; `estimate` = difference 2^4 / (2^4 - 1) is Richardson's
    estimate of the error of the run with n steps, for a method of order 4. Near sticking the order is lower and the estimate rough.
    """

    substeps: int
    difference: Array
    estimate: Array


def step_error(
    bound: BoundPlant,
    t_s: ArrayLike,
    x0: ArrayLike,
    drive: Drive,
    *,
    reference: ArrayLike | None = None,
    substeps: int = 1,
) -> StepError:
    """The step-halving check of a run of `simulate` with the same arguments, shapes and errors: t_s (n,), x0 (states,).

    Outputs are not quantised in it, and so the loop that a controller closes is smooth: a reading that flips by one count would hide
    the error of the integration behind the encoder's step. An unstable plant with given inputs amplifies every error: check
    it in the loop, or over short times.
    """

    def run(count: int) -> Array:
        y = simulate(
            bound, t_s, x0, drive, Conditions(reference=reference, resolution=exact, substeps=count, keep="y")
        ).y
        assert y is not None
        return y

    exact = np.zeros(len(bound.model.outputs))
    return halved(run, substeps)


def halved(run: Callable[[int], Array], substeps: int) -> StepError:
    """The same check of any run that gives outputs (.., n, outputs) for a number of steps a sample."""
    coarse, fine = run(substeps), run(2 * substeps)
    difference = np.max(np.abs(coarse - fine), axis=tuple(range(coarse.ndim - 1)))
    return StepError(substeps, difference, difference * 2**ORDER / (2**ORDER - 1))
