"""Figs. 12 to 14 of seed 001 once more: the same voltages on a rig and on an identified plant. Levels that the paper's text lacks are ours.

Azimuth fixed: 12a, a slow ramp of u1 from 0.4 MU, where nothing moves yet, to 0.6 MU; 12b, u1 = 0.53 MU for 20 s. Free: 13a, u2 = 0.15 MU
and a slow ramp of u1 to 0.4 MU; 13b, u1 = 0.4 MU and steps of u2 for 120 s; 14, both voltages change for 70 s.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from identification.experiments.velagic.rig import PERIOD_S, VelagicRig
from sim.bind import BoundPlant
from sim.simulate import Conditions, simulate

Array = NDArray[np.float64]
SLOW_MU_S, RAMP_MU_S = 0.002, 0.01
STEP_13_MU, HOLD_13_S, SIDES_13 = 0.02, 15.0, (0.0, 1.0, -1.0, -1.0, 1.0, 1.0, -1.0, 0.0)
MAIN_14_MU, WAVE_14_MU, TAIL_14_MU, PERIODS_14_S = 0.5, 0.03, 0.03, (23.0, 14.0)


@dataclass(frozen=True, eq=False)
class Response:
    """Voltages u_MU (n, 2) at t_s (n,), the angle that the rig's encoder shows and the one that the plant predicts [rad], (n,)."""

    t_s: Array
    u_MU: Array
    measured_rad: Array
    predicted_rad: Array

    @property
    def rms_rad(self) -> float:
        """What the prediction misses."""
        return float(np.sqrt(np.mean((self.measured_rad - self.predicted_rad) ** 2)))


def responses(truth: BoundPlant, identified: BoundPlant) -> Mapping[str, Response]:
    """All five, by the figure's number."""
    free, fixed = VelagicRig(truth), VelagicRig(truth, azimuth_locked=True)
    main = np.linspace(0.4, 0.6, _rows(0.2 / SLOW_MU_S))
    cross, hold = np.linspace(0.0, 0.4, _rows(0.4 / RAMP_MU_S)), _rows(20.0)
    balance = free.balance_MU(0.4)
    steps = balance + STEP_13_MU * np.repeat(SIDES_13, _rows(HOLD_13_S))
    return {
        "12a": _both(fixed, identified, np.column_stack([main, np.zeros(main.size)])),
        "12b": _both(fixed, identified, np.tile([0.53, 0.0], (hold, 1))),
        "13a": _both(free, identified, np.column_stack([cross, np.full(cross.size, 0.15)])),
        "13b": _both(free, identified, np.column_stack([np.full(steps.size, 0.4), steps])),
        "14": _both(free, identified, _both_change(free)),
    }


def _both_change(rig: VelagicRig) -> Array:
    t_s = np.arange(_rows(70.0)) * PERIOD_S
    slow, fast = (np.sin(2.0 * np.pi * t_s / period_s) for period_s in PERIODS_14_S)
    main = MAIN_14_MU + WAVE_14_MU * slow
    tail = np.array([rig.balance_MU(u_1) for u_1 in main.tolist()]) + TAIL_14_MU * np.sign(fast)
    return np.column_stack([main, tail])


def _both(rig: VelagicRig, identified: BoundPlant, u_MU: Array) -> Response:
    """Elevation where the azimuth is fixed, else azimuth."""
    column, locked = (0, ("azimuth",)) if rig.azimuth_locked else (1, ())
    t_s = np.linspace(0.0, PERIOD_S * (len(u_MU) - 1), len(u_MU))
    measured = rig.angles_rad(rig.run(rig.rest(), u_MU)[:-1])[column]
    x0 = np.zeros(len(identified.model.states))
    x0[[str(state) for state in identified.model.states].index("psi_rad")] = -identified.parameter("Psi_lim")
    volts = identified.parameter("MU") * u_MU
    y = simulate(identified, t_s, x0, volts, Conditions(resolution=[0.0, 0.0], locked=locked, keep="y")).y
    assert y is not None
    return Response(t_s, u_MU, measured, y[:, column])


def _rows(duration_s: float) -> int:
    return round(duration_s / PERIOD_S)
