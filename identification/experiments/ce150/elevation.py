"""Experiments 5 and 9: main rotor voltages that keep the arm in its stable half, azimuth locked (5) or turned by hand (9)."""

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from identification.experiments.ce150 import models
from identification.experiments.ce150.rig import PERIOD_S, PHI, PSI, Rig, Setup
from identification.experiments.ce150.windows import Readings, even_windows, windowed
from identification.model.subsystem import subsystem
from identification.runs.run import Run
from records.experiment import Experiment
from sim.bind import BoundPlant

Array = NDArray[np.float64]
RAMP_S, RAMP_V = 45.0, (4.0, 6.0)
DURATION_S = 60.0
LEVELS = (1.04, 1.10)  # of the voltage that lifts the arm
LEVELS_BY_HAND = (1.05, 1.075)  # the hand moves the arm too
SWING_WINDOW_S = 10.0
MEDIAN_ROWS, SMOOTH_ROWS = 5, 11


def perform(truth: BoundPlant, rng: Generator, *, by_hand: bool) -> Experiment:
    """Find the voltage that lifts the arm off its stop by a slow ramp, then step about it; by hand, also turn the azimuth."""
    lift_V = _lift_V(truth)
    n = round(DURATION_S / PERIOD_S)
    levels = lift_V * rng.uniform(*(LEVELS_BY_HAND if by_hand else LEVELS), n)
    voltage = np.repeat(levels, rng.integers(80, 250, n))[:n]
    rise = np.linspace(0.9 * lift_V, voltage[0], 300)  # three seconds, gently, as a step would throw the arm up
    u_M = np.concatenate([rise, voltage])
    setup = _hand(rng) if by_hand else Setup(azimuth_locked=1)
    rig = Rig(truth, setup)
    start = np.zeros(8)
    start[PSI] = -truth.parameter("Psi_lim")
    x = rig.run(start, np.column_stack([u_M, np.zeros(u_M.size)]))[:-1]
    stream = {"t_s": np.arange(u_M.size) * PERIOD_S, "u_M_V": u_M, "psi_rad": rig.encoder("psi_rad", x[:, PSI])}
    if by_hand:
        stream["phi_rad"] = rig.encoder("phi_rad", x[:, PHI])
    return Experiment(
        kind="turned_by_hand" if by_hand else "elevation_steps",
        plant=truth.model.name,
        mount="upright",
        locked=() if by_hand else ("azimuth",),
        facts={},
        streams={"motion": stream},
    )


def _lift_V(truth: BoundPlant) -> float:
    """The voltage of a slow ramp at which the encoder first shows the arm moving."""
    n = round(RAMP_S / PERIOD_S)
    ramp = np.linspace(*RAMP_V, n)
    rig = Rig(truth, Setup(azimuth_locked=1))
    start = np.zeros(8)
    start[PSI] = -truth.parameter("Psi_lim")
    angle = rig.run(start, np.column_stack([ramp, np.zeros(n)]))[:-1, PSI]
    return float(ramp[np.argmax(angle > angle[0] + 2.0 * truth.plant.sensors["psi_rad"])])


def _hand(rng: Generator) -> Setup:
    """Three sways at once, off the arm's own 2.3 rad/s, which would throw it against its stops."""
    return Setup(
        hand_turned=1,
        hand_rad=(0.9, 0.35, 0.08),
        hand_rad_s=tuple(rng.uniform([0.5, 1.0, 3.5], [0.8, 1.4, 4.5])),
        hand_phase_rad=tuple(rng.uniform(0.0, 2 * np.pi, 3)),
    )


def run(experiment: Experiment, bound: BoundPlant) -> Run:
    """Windows behind the take-off. The hand's speed is the azimuth's difference over each sample, smoothed by a median filter."""
    motion = experiment.streams["motion"]
    t_s, psi = motion["t_s"], motion["psi_rad"]
    step_rad = bound.plant.sensors["phi_rad"]
    turning = turning_rad_s(t_s, motion["phi_rad"], step_rad) if "phi_rad" in motion else np.zeros(t_s.size)
    begins, stops = even_windows(t_s, psi, _free_from_s(t_s, psi), SWING_WINDOW_S)
    u = np.column_stack([motion["u_M_V"], turning])
    part = subsystem(bound, models.elevation(), {"mount_rad": 0.0})
    return windowed(experiment.kind, part, Readings(t_s, u, psi, "psi_rad"), begins, stops)


def turning_rad_s(t_s: Array, phi_rad: Array, step_rad: float) -> Array:
    """Mean speed from each row to the next (n,), the right one to be held over the sample: differences without leaps, smoothed.

    A median filter takes out what leaps by more than two encoder steps; the rest is smoothed by parabolas over eleven rows. The
    median alone would round a steady speed to whole steps of 0.15 rad/s and cut the crests off, and what rounding leaves in the square
    of the speed would pass for centrifugal torque.
    """
    from scipy.signal import medfilt, savgol_filter  # a second, which whoever only identifies from logs is spared

    speed = np.diff(phi_rad, append=phi_rad[-1]) / np.diff(t_s, append=2 * t_s[-1] - t_s[-2])
    speed[-1] = speed[-2]
    middle = medfilt(speed, MEDIAN_ROWS)
    leaps = np.abs(speed - middle) > 2.5 * step_rad / np.median(np.diff(t_s))
    return np.asarray(savgol_filter(np.where(leaps, middle, speed), SMOOTH_ROWS, 2))


def _free_from_s(t_s: Array, psi: Array) -> float:
    """A second after the arm has left the angle at which the record begins."""
    away = np.flatnonzero(np.abs(psi - psi[0]) > 0.05)
    return float(t_s[away[0]] + 1.0) if away.size else float(t_s[0])
