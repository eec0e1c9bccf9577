"""Flights of the lateral/directional model with the sensors of seed 002: sweeps of either stick, and doublets to check against.

The motion is that of eq (1) with held sticks, integrated by SciPy's zero-order hold. A pilot's sweep is not a formula's: the swept stick
carries a tenth of its amplitude as slow noise and the other one as much again, to hold the heading. The accelerometer stands at r_s and
reads what the lever adds; all sensors have the noise and steps of the plant file.
"""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray
from scipy.signal import butter, cont2discrete, lfilter

from identification.frequency.flights.sweep import Sweep, sweep_input
from identification.frequency.flights.transfer import lever_terms
from identification.frequency.lateral import INPUTS, MEASURED, check_plant, log_columns, state_space
from records.log import RunLog
from records.plant import Plant

Array = NDArray[np.float64]
SAMPLE_PERIOD_S = 0.02
PILOT_SHARE, PILOT_RAD_S = 0.1, 2.0
PITCH_RAD_S = 0.03
DOUBLET_S, CHECK_S = 1.5, 40.0


def sweep_flights(
    plant: Plant, sweep: Sweep, amplitudes: tuple[float, float], repeats: int, seed: int
) -> Mapping[str, RunLog]:
    """`repeats` sweeps of each stick, by name, and a record of doublets; `amplitudes` of the lateral stick and of the pedals."""
    check_plant(plant)
    rng = np.random.default_rng([seed, 2])
    t_s = _times(sweep.duration_s)
    found = {}
    for number in range(1, repeats + 1):
        for stick, name in enumerate(INPUTS):
            u = np.column_stack([PILOT_SHARE * size * _slow_noise(t_s.size, rng) for size in amplitudes])
            u[:, stick] += sweep_input(sweep, t_s, amplitudes[stick])
            found[f"sweep_{name.removeprefix('delta_')}_{number}"] = flight(plant, t_s, u, rng)
    t_s = _times(CHECK_S)
    u = np.column_stack([doublet(t_s, 3.0, amplitudes[0]), doublet(t_s, 20.0, amplitudes[1])])
    return {**found, "doublets": flight(plant, t_s, u, rng)}


def _times(duration_s: float) -> Array:
    return np.asarray(SAMPLE_PERIOD_S * np.arange(round(duration_s / SAMPLE_PERIOD_S) + 1), dtype=float)


def doublet(t_s: Array, begin_s: float, amplitude: float) -> Array:
    """Right, then left, 1.5 s each."""
    phase = (t_s - begin_s) / DOUBLET_S
    return np.asarray(
        amplitude * np.where((phase >= 0.0) & (phase < 1.0), 1.0, np.where((phase >= 1.0) & (phase < 2.0), -1.0, 0.0))
    )


def flight(plant: Plant, t_s: Array, u: Array, rng: np.random.Generator) -> RunLog:
    """What the instruments record of a flight from trim with the sticks u (n, 2) held from t_s (n,) on."""
    values = {name: entry.values[0] for name, entry in plant.parameters.items() if name != "r_s"}
    of = state_space(values)
    A_d, B_d, *_ = cont2discrete((of.A, of.B, of.C, of.D), SAMPLE_PERIOD_S)
    x = np.zeros((t_s.size, 4))
    for k in range(t_s.size - 1):
        x[k + 1] = A_d @ x[k] + B_d @ u[k]
    before = np.vstack([np.zeros((1, 2)), u[:-1]])
    a_y_m_s2 = x @ of.C[2] + before @ of.D[2]
    rates = x @ of.A.T + before @ of.B.T
    q, q_dot = _pitching(t_s.size, rng)
    omega = np.column_stack([x[:, 1], q, x[:, 2]])
    omega_dot = np.column_stack([rates[:, 1], q_dot, rates[:, 2]])
    a_y_m_s2 = a_y_m_s2 + np.sum(lever_terms(omega, omega_dot, np.array(plant.parameters["r_s"].values)), axis=0)[:, 1]
    y = np.column_stack([omega, a_y_m_s2])
    for place, name in enumerate(MEASURED):
        y[:, place] += plant.sensor_noise.get(name, 0.0) * rng.standard_normal(t_s.size)
        y[:, place] = plant.sensors[name] * np.rint(y[:, place] / plant.sensors[name])
    return RunLog(log_columns(), SAMPLE_PERIOD_S, "open", t_s, u, y)


def _slow_noise(count: int, rng: np.random.Generator) -> Array:
    """Noise of unit standard deviation below 2 rad/s."""
    b, a = butter(2, PILOT_RAD_S * SAMPLE_PERIOD_S / np.pi)
    noise = lfilter(b, a, rng.standard_normal(count))
    return np.asarray(noise / np.std(noise))


def _pitching(count: int, rng: np.random.Generator) -> tuple[Array, Array]:
    """The pitch rate of a flight that is not quite steady, and its slope."""
    q = PITCH_RAD_S * _slow_noise(count, rng)
    return q, np.gradient(q, SAMPLE_PERIOD_S)
