"""What every rig's simulation takes and gives: a rig with settings of effects, and the record of one run."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from blind.effects.effect import Settings
from blind.simulation.ce150 import Rig

Array = NDArray[np.float64]
WINDOW_S = 1.0
THINNED_S = 0.04


@dataclass(frozen=True)
class Model:
    """A rig with settings of effects: (field of effects_t, index, -1 for a number) -> value.

    As a shadow, a `placed` one starts from what the rig's sensors show; one that `loses` misses its lost commands.
    """

    rig: Rig
    settings: Settings
    placed: bool = False
    loses: bool = False


@dataclass(frozen=True)
class Loss:
    """Frames that a flight loses: their share of all, and how many are lost in a row on average."""

    share: float = 0.0
    burst_frames: float = 1.0


@dataclass(frozen=True, eq=False)
class Record:
    """What a run gives from time 0 on, n rows: times, commands (n, 2) V, counted and exact angles (n, 2) rad, apparent
    state (n, 6): psi psi' phi phi' omega_M omega_T; each shadow's angles (n, shadows, 2).

    `stop_share` of the time on an elevation stop. How it is logged: the loop, the axes that were held, which rows were kept (None: all),
    how many seconds the logger's clock counts in a true one. Where an axis is a carriage its angle is a length in m.
    """

    t_s: Array
    u_V: Array
    y_rad: Array
    exact_rad: Array
    apparent: Array
    shadow: Array
    reference: Array
    stop_share: float
    failed: bool
    period_s: float
    loop: str = "closed"
    locked: tuple[str, ...] = ()
    kept: NDArray[np.bool_] | None = None
    clock: float = 1.0

    @property
    def window_rows(self) -> int:
        """Rows after which shadows and predictions start anew."""
        return round(WINDOW_S / self.period_s)

    @property
    def thin(self) -> int:
        """Every how many rows a prediction is looked at for the re-tune."""
        return max(1, round(THINNED_S / self.period_s))
