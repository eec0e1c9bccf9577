"""Experiments 7 and 8: a rule that keeps the azimuth swinging by its tail rotor, and the search for a balance of both rotors."""

import numpy as np
from numpy.random import Generator
from scipy.sparse import csr_array

from identification.experiments.ce150 import models
from identification.experiments.ce150.rig import PERIOD_S, PHI, Rig, Setup
from identification.experiments.ce150.windows import Readings, even_windows, windowed
from identification.model.observation import observation
from identification.model.subsystem import subsystem
from identification.runs.run import Run
from records.experiment import Experiment
from sim.bind import BoundPlant

OSCILLATION_S, TURN_BACK_RAD, WINDOW_S = 60.0, 1.0, 10.0
VOLTAGES = np.linspace(1.0, 9.0, 17)
STAIR_V, STAIR_S = 0.02, 1.0
HOLD_S, HOLD_STEP_S = 6.0, 0.02
TORQUE_SD_NM = 2e-5


def oscillate(truth: BoundPlant, rng: Generator) -> Experiment:
    """Experiment 7: push one way until the azimuth has passed a limit, then the other, each time as strongly as chance has it."""
    rig = Rig(truth, Setup(elevation_locked=1))
    n, x, side, strength = round(OSCILLATION_S / PERIOD_S), np.zeros(8), 1.0, 2.0
    u_T, phi = np.zeros(n), np.zeros(n)
    for k in range(n):
        phi[k] = rig.encoder("phi_rad", x[PHI : PHI + 1])[0]
        if side * phi[k] > TURN_BACK_RAD:
            side, strength = -side, rng.uniform(1.0, 5.0)
        u_T[k] = side * strength
        x = rig.run(x, np.array([[0.0, u_T[k]]]))[1]
    return Experiment(
        kind="azimuth_oscillation",
        plant=truth.model.name,
        mount="upright",
        locked=("elevation",),
        facts={"psi_locked_rad": 0.0},
        streams={"motion": {"t_s": np.linspace(0.0, (n - 1) * PERIOD_S, n), "u_T_V": u_T, "phi_rad": phi}},
    )


def oscillation_run(experiment: Experiment, bound: BoundPlant) -> Run:
    """Windows behind the first two seconds; the tail rotor runs on through them."""
    motion = experiment.streams["motion"]
    begins, stops = even_windows(motion["t_s"], motion["phi_rad"], 2.0, WINDOW_S)
    extra = {"turned": 0.0, "psi_locked_rad": experiment.facts["psi_locked_rad"]}
    part = subsystem(bound, models.azimuth(), extra)
    readings = Readings(motion["t_s"], motion["u_T_V"][:, None], motion["phi_rad"], "phi_rad")
    return windowed(experiment.kind, part, readings, begins, stops)


def balance(truth: BoundPlant, rng: Generator) -> Experiment:
    """Experiment 8: for each main rotor voltage the tail rotor voltages at which the azimuth gives way to either side."""
    rig = Rig(truth, Setup(elevation_locked=1))
    rows, middle = [], 0.3
    for u_M in VOLTAGES:
        up, down = (_gives_way_V(rig, u_M, middle, side, rng) for side in (1.0, -1.0))
        middle = 0.5 * (up + down)
        rows.append((u_M, up, down))
    u_M, up, down = np.array(rows).T
    return Experiment(
        kind="reaction_balance",
        plant=truth.model.name,
        mount="upright",
        locked=("elevation",),
        facts={},
        streams={"balance": {"u_M_V": u_M, "u_T_up_V": up, "u_T_down_V": down}},
    )


def _gives_way_V(rig: Rig, u_M: float, guess_V: float, side: float, rng: Generator) -> float:
    """Raise the tail rotor's voltage step by step from the other side of the balance until the azimuth moves to `side`."""
    begin = guess_V - side * (0.4 + rng.uniform(0.0, 0.1))
    stairs = begin + side * STAIR_V * np.arange(round(1.2 / STAIR_V))
    held = Rig(rig.truth, Setup(elevation_locked=1, azimuth_locked=1))
    x = held.run(np.zeros(8), np.tile([u_M, begin], (80, 1)), period_s=0.1)[-1]
    u = np.column_stack([np.full(stairs.size, u_M), stairs])
    phi = rig.encoder("phi_rad", rig.run(x, u, period_s=STAIR_S)[:, PHI])
    # At first it may turn the other way, carried by the main rotor; what counts is the first move to `side`.
    return float(stairs[np.argmax(side * np.diff(phi) > 0.5 * rig.truth.plant.sensors["phi_rad"])])


def balance_run(experiment: Experiment, bound: BoundPlant) -> Run:
    """Torques at both voltages at which the azimuth gives way: dry friction is the same on either side, so their mean is none."""
    found = experiment.streams["balance"]
    pairs = np.stack([found["u_T_up_V"], found["u_T_down_V"]], axis=1)
    hold, count = round(HOLD_S / HOLD_STEP_S), pairs.size
    u = np.column_stack([np.repeat(np.repeat(found["u_M_V"], 2), hold), np.repeat(pairs.ravel(), hold)])
    last = hold * np.arange(1, count + 1) - 1
    n = pairs.shape[0]
    select = csr_array((np.full(count, 0.5), (np.repeat(np.arange(n), 2), last)), (n, len(u)))
    t_s = np.linspace(0.0, (len(u) - 1) * HOLD_STEP_S, len(u))
    model = models.reaction()
    return Run(
        name="reaction_balance",
        bound=subsystem(bound, model),
        t_s=t_s,
        u=u,
        y=np.zeros(n),
        sd=np.full(n, TORQUE_SD_NM),
        at_s=np.arange(float(n)),
        channel=np.zeros(n, dtype=np.int64),
        channels=("torque_Nm",),
        select=select,
        begins=np.array([0]),
        stops=np.array([len(u)]),
        x0=np.zeros((1, 2)),
        observed=observation(model, models.reaction_torque()),
    )
