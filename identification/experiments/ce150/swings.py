"""Experiments 4 and 6: an axis turned by 90 degrees swings under gravity after it was pulled aside by hand and let go."""

import itertools
import math

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from identification.experiments.ce150 import models
from identification.experiments.ce150.rig import PERIOD_S, PHI, PSI, Rig, Setup
from identification.experiments.ce150.windows import Readings, windowed
from identification.model.subsystem import subsystem
from identification.runs.run import Run
from records.experiment import Experiment
from sim.bind import BoundPlant

Array = NDArray[np.float64]
HELD_S = 0.5
SWINGS = {"elevation_swing": (8, 10.0, (0.45, 0.72)), "azimuth_swing": (12, 5.0, (1.0, 2.0))}  # count, length, release
MOVED_STEPS = 5.0


def perform(truth: BoundPlant, rng: Generator, *, azimuth: bool) -> Experiment:
    """Pull aside, hold, let go, on alternate sides."""
    kind = "azimuth_swing" if azimuth else "elevation_swing"
    count, length_s, (least, most) = SWINGS[kind]
    if azimuth:
        setup, place, output = Setup(turned=1.0, elevation_locked=1), PHI, "phi_rad"
    else:
        setup, place, output = Setup(mount_rad=-math.pi / 2, azimuth_locked=1), PSI, "psi_rad"
    rig, pieces = Rig(truth, setup), []
    for number in range(count):
        start = np.zeros(8)
        start[place] = rng.uniform(least, most) * (1.0 if number % 2 else -1.0)
        swing = rig.run(start, np.zeros((round(length_s / PERIOD_S), 2)))[:-1, place]
        pieces.append(np.concatenate([np.full(round(HELD_S / PERIOD_S), start[place]), swing]))
    angles = np.concatenate(pieces)
    return Experiment(
        kind=kind,
        plant=truth.model.name,
        mount="turned",
        locked=("elevation",) if azimuth else ("azimuth",),
        facts={"psi_locked_rad": 0.0} if azimuth else {},
        streams={
            "angle": {
                "t_s": np.linspace(0.0, (angles.size - 1) * PERIOD_S, angles.size),
                output: rig.encoder(output, angles),
            }
        },
    )


def run(experiment: Experiment, bound: BoundPlant) -> Run:
    """Each swing as a window from the moment it moves until it rests; the hand that holds the arm is trimmed."""
    azimuth = experiment.kind == "azimuth_swing"
    output = "phi_rad" if azimuth else "psi_rad"
    stream = experiment.streams["angle"]
    begins, stops = swings(stream["t_s"], stream[output], bound.plant.sensors[output])
    if azimuth:
        part = subsystem(bound, models.azimuth(), {"turned": 1.0, "psi_locked_rad": experiment.facts["psi_locked_rad"]})
    else:
        part = subsystem(bound, models.elevation(), {"mount_rad": -math.pi / 2})
    u = np.zeros((stream["t_s"].size, len(part.model.inputs)))
    return windowed(experiment.kind, part, Readings(stream["t_s"], u, stream[output], output), begins, stops)


def swings(t_s: Array, angle: Array, step: float) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Rows from which the arm swings freely after a hand let it go, and those behind which it rests.

    A release is where readings leave a hold of at least 0.3 s; a swing ends when it stays within some steps of where it comes to rest.
    """
    still = max(2, round(0.3 / float(np.median(np.diff(t_s)))))
    changed = np.concatenate([[0], np.flatnonzero(np.diff(angle)) + 1, [angle.size]])
    holds = [(a, b) for a, b in itertools.pairwise(changed) if b - a >= still]
    begins, stops = [], []
    for (_, end), (begin, _) in zip(holds, [*holds[1:], (angle.size, 0)], strict=True):
        hold = angle[end - 1]
        moved = np.flatnonzero(np.abs(angle[end:begin] - hold) > MOVED_STEPS * step)
        if moved.size > still:
            begins.append(end + moved[0])
            restless = np.flatnonzero(np.abs(angle[end:begin] - angle[begin - 1]) > MOVED_STEPS * step)
            stops.append(end + restless[-1] + 1)
    return np.array(begins, dtype=np.int64), np.array(stops, dtype=np.int64)
