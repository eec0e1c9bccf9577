"""Experiment 3: the arm balanced by weights at its tail; eq (11) of seed 000.

Each weight is let go from above and from below, as dry friction stops the arm short of its balance by up to b_cE on either side.
"""

import math

import numpy as np
from numpy.random import Generator

from identification.experiments.ce150 import models
from identification.experiments.ce150.rig import PSI, Rig, Setup
from identification.model.observation import observation
from identification.model.subsystem import subsystem
from identification.runs.run import Run
from records.errors import BadInput
from records.experiment import Experiment
from sim.bind import BoundPlant

LEVER_M, LEVER_RAD = 0.15, 0.35
LEVER_SD_M, LEVER_SD_RAD = 5e-5, 2e-3  # what a ruler and a protractor leave open
WEIGHT_STEP_KG = 1e-4
BALANCES_DEG = np.linspace(-32.0, 32.0, 12)
SETTLING_S = 40.0
TORQUE_SD_NM = 1e-4


def perform(truth: BoundPlant, rng: Generator) -> Experiment:
    """Hang weights that should balance the arm at angles over its range, release it twice, read where it rests."""
    nominal = 0.0383 / (LEVER_M * 9.81)
    lever_m, lever_rad = rng.normal(LEVER_M, LEVER_SD_M), rng.normal(LEVER_RAD, LEVER_SD_RAD)
    rows = []
    for angle in np.radians(BALANCES_DEG):
        weight = nominal * math.cos(angle) / math.cos(angle + LEVER_RAD)
        weight = round(weight / WEIGHT_STEP_KG) * WEIGHT_STEP_KG
        rig = Rig(truth, Setup(azimuth_locked=1, weight_kg=weight, lever_m=lever_m, lever_rad=lever_rad))
        for side in (-1.0, 1.0):
            release = angle + side * rng.uniform(0.1, 0.25)
            start = np.zeros(8)
            start[PSI] = float(np.clip(release, -0.75, 0.75))
            rest = rig.run(start, np.zeros((round(SETTLING_S / 0.05), 2)), period_s=0.05)[-1, PSI]
            rows.append((weight, float(rig.encoder("psi_rad", np.array([rest]))[0])))
    weights, angles = np.array(rows).T
    return Experiment(
        kind="gravity",
        plant=truth.model.name,
        mount="upright",
        locked=("azimuth",),
        facts={"lever_m": LEVER_M, "lever_sd_m": LEVER_SD_M, "lever_rad": LEVER_RAD, "lever_sd_rad": LEVER_SD_RAD},
        streams={"balance": {"weight_kg": weights, "psi_rad": angles}},
    )


def run(experiment: Experiment, bound: BoundPlant) -> Run:
    """Each rest as a balance of torques that friction leaves open; an arm that lies on a stop balances nothing and is dropped."""
    found = experiment.streams["balance"]
    free = np.abs(found["psi_rad"]) < bound.parameter("Psi_lim") - 2.0 * bound.plant.sensors["psi_rad"]
    angles, weights = found["psi_rad"][free], found["weight_kg"][free]
    if angles.size < 3:
        raise BadInput(
            "balances", "experiment gravity", f"{angles.size} off the stops", "at least three", "hang lighter or heavier weights",
        )  # fmt: skip
    facts = experiment.facts
    extra = {"Psi_m": 0.0, "lever": facts["lever_m"], "lever_angle": facts["lever_rad"]}
    n = angles.size
    return Run(
        name="gravity",
        bound=subsystem(bound, models.gravity(), extra),
        t_s=np.arange(float(n)),
        u=np.column_stack([angles, weights]),
        y=np.zeros(n),
        sd=np.full(n, TORQUE_SD_NM),
        at_s=np.arange(float(n)),
        channel=np.zeros(n, dtype=np.int64),
        channels=("torque_Nm",),
        select=np.arange(n),
        begins=np.array([0]),
        stops=np.array([n]),
        x0=np.zeros((1, 0)),
        observed=observation(models.gravity(), models.gravity_torque()),
    )
