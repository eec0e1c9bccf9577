"""Tests flown on the simulated helicopter: a pilot moves one control in steps and steadies the rest, in light air, with noise."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from identification.envelope.flights.conditions import Condition
from identification.envelope.flights.flight import CONTROLS, Flight
from identification.envelope.flights.multistep import STEPS_2311, multistep
from identification.envelope.truth.equations import Air, rates, specific_force
from identification.envelope.truth.figures import Machine
from identification.envelope.truth.trim import air_of, trim
from identification.margins import FOOT_m

Array = NDArray[np.float64]

STEP_s, SAMPLE_s, DURATION_s = 0.01, 0.05, 24.0
QUIET_s, UNIT_s, HAND_s = 3.0, 1.0, 0.15
HEIGHT_percent = {"collective": 5.0, "longitudinal": 2.5, "lateral": 2.5, "pedals": 5.0}
CLIMB_m_s = {"level": 0.0, "ascending": 1000.0 * FOOT_m / 60.0, "descending": -1000.0 * FOOT_m / 60.0}

# The pilot against deviations from trim: per cent of travel for each m/s of w, rad/s and rad; assumed, found to hold every condition.
_PILOT = np.zeros((4, 8))
_PILOT[0, 2] = 0.5
_PILOT[1, 4], _PILOT[1, 7] = 12.0, 25.0
_PILOT[2, 3], _PILOT[2, 6] = -6.0, -25.0
_PILOT[3, 5] = -20.0
_OWN_AXIS = 0.7  # of that on the control that he moves
REMNANT_percent, REMNANT_s = 0.3, 1.0  # what the pilot adds by himself, and how long it lasts
GUST_m_s, GUST_LENGTH_m = 0.15, 200.0  # light air

# One sd of white noise; accelerations bear the rotor's vibration.
NOISE_x = np.array([0.10, 0.10, 0.10, 0.003, 0.003, 0.003, 0.0015, 0.0015])  # m/s, rad/s, rad
NOISE_y = np.array([0.12, 0.12, 0.18])  # m/s^2


@dataclass(frozen=True)
class FlightTest:
    """A flight to be flown; `number` tells repetitions apart, which differ in height of the steps, gusts and noise."""

    condition: Condition
    mission: str
    manoeuvre: str
    number: int
    use: str
    steps: tuple[int, ...] = STEPS_2311


@dataclass(frozen=True, eq=False)
class Disturbance:
    """What a test's seed decides, drawn flight by flight so that no flight depends on its company: per sample, and the steps' height."""

    height: float
    gust: Array
    remnant: Array
    noise_x: Array
    noise_y: Array


def fly(machine: Machine, tests: Sequence[FlightTest], seed: int, duration_s: float = DURATION_s) -> tuple[Flight, ...]:
    """All tests at once; the same test, seed and duration give the same flight."""
    start = [trim(machine, test.condition, CLIMB_m_s[test.mission]) for test in tests]
    s, c = np.stack([entry[0] for entry in start], axis=1), np.stack([entry[1] for entry in start], axis=1)
    airs = [air_of(machine, test.condition) for test in tests]
    air = Air(*(np.concatenate([getattr(a, name) for a in airs]) for name in ("density_kg_m3", "station_m")))
    drawn = [_drawn(test, seed, duration_s) for test in tests]
    x, u, y = _flown(machine, air, (s, c), _inputs(tests, drawn, duration_s), tests, drawn)
    return tuple(
        Flight(test.condition, test.mission, test.manoeuvre, test.number, test.use, SAMPLE_s, u[:, :, i],
               x[:, :, i] + chance.noise_x, y[:, :, i] + chance.noise_y)
        for i, (test, chance) in enumerate(zip(tests, drawn, strict=True))
    )  # fmt: skip


def _flown(
    machine: Machine,
    air: Air,
    start: tuple[Array, Array],
    inputs: Array,
    tests: Sequence[FlightTest],
    drawn: Sequence[Disturbance],
) -> tuple[Array, Array, Array]:
    """x (samples, 8, n), u (samples, 4, n), y (samples, 3, n) without noise, from the trimmed `start`: states and controls."""
    s, trimmed = start
    gain = np.stack([_gain(test) for test in tests], axis=2)
    gusts, remnants = (np.stack([getattr(entry, name) for entry in drawn], axis=2) for name in ("gust", "remnant"))
    x_trim, c, every = s[:8].copy(), trimmed.copy(), round(SAMPLE_s / STEP_s)
    rows: list[tuple[Array, Array, Array]] = []
    for k in range(len(inputs)):
        gust = gusts[k // every]
        if k % every == 0:
            rows.append((s[:8], c, specific_force(machine, air, s, c, gust)))
        correction = np.einsum("ijn,jn->in", gain, s[:8] - x_trim)
        wanted = trimmed + inputs[k] + remnants[k // every] + correction
        c = np.clip(c + (wanted - c) * (STEP_s / HAND_s), 0.0, 100.0)
        s = runge_kutta(machine, air, s, c, gust, STEP_s)
    x, u, y = (np.stack([row[i] for row in rows]) for i in range(3))
    return x, u, y


def runge_kutta(machine: Machine, air: Air, s: Array, c: Array, gust_m_s: Array, step_s: float) -> Array:
    """One step of the classical method of fourth order, controls and gust held."""
    k1 = rates(machine, air, s, c, gust_m_s)
    k2 = rates(machine, air, s + step_s / 2 * k1, c, gust_m_s)
    k3 = rates(machine, air, s + step_s / 2 * k2, c, gust_m_s)
    k4 = rates(machine, air, s + step_s * k3, c, gust_m_s)
    return np.asarray(s + step_s / 6 * (k1 + 2 * k2 + 2 * k3 + k4))


def _inputs(tests: Sequence[FlightTest], drawn: Sequence[Disturbance], duration_s: float) -> Array:
    """The steps that the pilot intends (steps of integration, 4, n)."""
    t_s = np.arange(round(duration_s / STEP_s)) * np.float64(STEP_s)
    wanted = np.zeros((len(t_s), 4, len(tests)))
    for i, (test, chance) in enumerate(zip(tests, drawn, strict=True)):
        if test.manoeuvre in CONTROLS:
            moved = CONTROLS.index(test.manoeuvre)
            wanted[:, moved, i] = chance.height * multistep(t_s, test.steps, UNIT_s, QUIET_s)
    return wanted


def _gain(test: FlightTest) -> Array:
    gain = _PILOT.copy()
    if test.manoeuvre in CONTROLS:
        gain[CONTROLS.index(test.manoeuvre)] *= _OWN_AXIS
    return gain


def _drawn(test: FlightTest, seed: int, duration_s: float) -> Disturbance:
    rng = np.random.default_rng([seed, *_numbers(test)])
    rows = round(duration_s / SAMPLE_s)
    gust_s = GUST_LENGTH_m / test.condition.speed_m_s
    height = HEIGHT_percent.get(test.manoeuvre, 0.0) * rng.uniform(0.85, 1.15) * rng.choice([-1.0, 1.0])
    return Disturbance(
        float(height),
        GUST_m_s * _coloured(rng, rows, 3, gust_s),
        REMNANT_percent * _coloured(rng, rows, 4, REMNANT_s),
        NOISE_x * rng.standard_normal((rows, 8)),
        NOISE_y * rng.standard_normal((rows, 3)),
    )


def _numbers(test: FlightTest) -> list[int]:
    """A test as whole numbers, for its seed."""
    at = test.condition
    words = (*at.loading, *test.mission, "-", *test.manoeuvre)
    return [*map(ord, words), at.altitude_ft, at.speed_kts, test.number]


def _coloured(rng: np.random.Generator, rows: int, columns: int, time_s: float) -> Array:
    """Noise of unit sd with a correlation time, at rest in the beginning (rows, columns)."""
    kept = np.exp(-SAMPLE_s / time_s)
    fresh = np.sqrt(1.0 - kept**2) * rng.standard_normal((rows, columns))
    value, found = np.zeros(columns), np.zeros((rows, columns))
    for k in range(1, rows):
        value = kept * value + fresh[k]
        found[k] = value
    return found
