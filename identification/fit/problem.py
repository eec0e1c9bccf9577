"""What a fit is asked: runs, the parameters to find with their bounds, and what is known of them before."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from identification.runs.run import Run

Array = NDArray[np.float64]
Tell = Callable[[Array], None]  # parameters (parameters,)
Told = Callable[[Mapping[str, float]], None]  # the same by name


@dataclass(frozen=True, eq=False)
class Prior:
    """What is known before: mean (parameters,) and information Lambda (parameters, parameters), zero where nothing is known."""

    mean: Array
    information: Array


@dataclass(frozen=True, eq=False)
class Problem:
    """Runs and the parameters `names` to fit: start, typical size `scale`, bounds, prior; all of shape (parameters,)."""

    names: tuple[str, ...]
    start: Array
    scale: Array
    lower: Array
    upper: Array
    runs: tuple[Run, ...]
    prior: Prior


def by_name(names: Sequence[str], told: Told | None) -> Tell:
    """Tells the parameters (parameters,) by name to the one who watches, if there is one."""

    def tell(theta: Array) -> None:
        if told is not None:
            told(dict(zip(names, theta.tolist(), strict=True)))

    return tell
