"""Experiments 1 and 2: rectangular voltages of random height and length on one rotor; load cell at 10 Hz, photogate at its blades.

Three clocks: the board's (inputs, load cell), and the oscilloscope's (pulses of the photogate). One digital pulse is seen by both.
"""

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray
from scipy.interpolate import CubicHermiteSpline
from scipy.sparse import csr_array

from identification.experiments.ce150 import models
from identification.experiments.ce150.rig import PERIOD_S, TURN_M, TURN_T, Rig, Setup
from identification.model.observation import observation
from identification.runs.run import Run
from records.errors import BadInput
from records.experiment import Experiment
from sim.bind import BoundPlant

Array = NDArray[np.float64]
DURATION_S = 60.0
LOAD_CELL_PERIOD_S = 0.1
LOAD_CELL_NOISE_N = 1e-3
LOAD_CELL_STEP_N = 1e-4
BLADES = 2
SCOPE_S = 1e-7  # 10 MHz
EDGE_JITTER_S = 3e-6
BLADE_ERROR_RAD = 0.01  # the second blade is not exactly opposite the first
SLOWEST_RAD_S = 20.0  # below it a turn takes so long that its mean says little
TRIM_S = 0.5
SPEED_INFLATION = 0.02  # the error of a pulse's time lengthens one turn and shortens the next


def perform(truth: BoundPlant, rng: Generator, *, tail: bool) -> Experiment:
    """Drive one rotor for a minute and record input, thrust and pulses."""
    n = round(DURATION_S / PERIOD_S)
    voltage = np.repeat(rng.uniform(0.0, 10.0, n), rng.integers(50, 300, n))[:n]
    u = np.zeros((n, 2))
    u[:, int(tail)] = voltage
    lock = Setup(elevation_locked=1, azimuth_locked=1)
    t_s = np.linspace(0.0, n * PERIOD_S, n + 1)
    fine = Rig(truth, lock).run(np.zeros(8), np.repeat(u, 10, axis=0), period_s=PERIOD_S / 10)
    omega, turn = fine[:, 3 if tail else 0], fine[:, TURN_T if tail else TURN_M]
    thrust = _thrust(truth, "p_FT" if tail else "p_FM", omega[:: round(LOAD_CELL_PERIOD_S / PERIOD_S * 10)])
    force = thrust + rng.normal(0.0, LOAD_CELL_NOISE_N, thrust.size)
    offset_s, sync_s = float(rng.uniform(5.0, 20.0)), 0.2
    pulses = _pulses(np.arange(omega.size) * PERIOD_S / 10, turn, omega, rng)
    return Experiment(
        kind="tail_rotor" if tail else "main_rotor",
        plant=truth.model.name,
        mount="upright",
        locked=("elevation", "azimuth"),
        facts={"blades": float(BLADES), "sync_board_s": sync_s, "sync_scope_s": sync_s + offset_s},
        streams={
            "input": {"t_s": t_s[:-1], "u_V": voltage},
            "load_cell": {
                "t_s": np.linspace(0.0, (force.size - 1) * LOAD_CELL_PERIOD_S, force.size),
                "thrust_N": np.round(force / LOAD_CELL_STEP_N) * LOAD_CELL_STEP_N,
            },
            "photogate": {"pulse_s": np.round((pulses + offset_s) / SCOPE_S) * SCOPE_S},
        },
    )


def _thrust(truth: BoundPlant, name: str, omega: Array) -> Array:
    coefficients = truth.plant.parameters[name].values
    return np.asarray(np.where(omega > 0.0, np.polynomial.polynomial.polyval(omega, coefficients), 0.0))


def _pulses(t_s: Array, turn: Array, omega: Array, rng: Generator) -> Array:
    """When the blades pass the gate, from the rotor's angle; a rotor that hardly turns gives none."""
    moving = omega > 1.0
    inverse = CubicHermiteSpline(turn[moving], t_s[moving], 1.0 / omega[moving])
    turns = np.arange(np.ceil(turn[moving][0] / (2 * np.pi)), np.floor(turn[moving][-1] / (2 * np.pi)))
    angles = (turns[:, None] * 2 * np.pi + np.array([0.0, np.pi + BLADE_ERROR_RAD])).ravel()
    inside = angles[(angles > turn[moving][0]) & (angles < turn[moving][-1])]
    return np.sort(inverse(inside) + rng.normal(0.0, EDGE_JITTER_S, inside.size))


def run(experiment: Experiment, bound: BoundPlant) -> Run:
    """Pulses to the mean speed of each whole turn, all on the board's clock, the first half second trimmed."""
    rotor = "M" if experiment.kind == "main_rotor" else "T"
    drive, cell, facts = experiment.streams["input"], experiment.streams["load_cell"], experiment.facts
    pulses = experiment.streams["photogate"]["pulse_s"] - facts["sync_scope_s"] + facts["sync_board_s"]
    gate = pulses[:: round(facts["blades"])]  # always the same blade: its neighbour's misplacement does not count
    t_s = np.unique(np.concatenate([drive["t_s"], cell["t_s"], gate]))
    t_s = t_s[(t_s >= drive["t_s"][0]) & (t_s <= drive["t_s"][-1])]
    turns = _whole_turns(gate[(gate >= t_s[0] + TRIM_S) & (gate <= t_s[-1])])
    if not len(turns):
        raise BadInput(
            "photogate", f"experiment {experiment.kind}", "no whole turn faster than 20 rad/s", "pulses of a turning rotor",
            "check gate, blades and the common pulse: the rotor's parameters need its speed",
        )  # fmt: skip
    at_cell = (cell["t_s"] >= t_s[0] + TRIM_S) & (cell["t_s"] <= t_s[-1])
    speeds = 2 * np.pi / (turns[:, 1] - turns[:, 0])
    select = _select(t_s, turns, cell["t_s"][at_cell])
    model, alias = models.rotor(), _alias(rotor)
    known = dict(zip([str(s) for s in bound.model.parameter_symbols], bound.p.tolist(), strict=True))
    own = {model_name: known[name] for name, model_name in alias.items()}
    p = np.array([own[str(symbol)] for symbol in model.parameter_symbols])
    held = np.searchsorted(drive["t_s"], t_s, side="right") - 1
    return Run(
        name=experiment.kind,
        bound=BoundPlant(bound.plant, model, p, np.zeros(p.size)),
        t_s=t_s,
        u=drive["u_V"][held][:, None],
        y=np.concatenate([speeds, cell["thrust_N"][at_cell]]),
        sd=np.concatenate([np.full(len(turns), 0.3), np.full(int(at_cell.sum()), 2e-3)]),
        at_s=np.concatenate([turns[:, 1], cell["t_s"][at_cell]]),
        channel=np.repeat([0, 1], [len(turns), int(at_cell.sum())]),
        channels=("speed_rad_s", "thrust_N"),
        select=select,
        begins=np.array([0]),
        stops=np.array([t_s.size]),
        x0=np.zeros((1, 2)),
        observed=observation(model, models.rotor_readings()),
        alias=alias,
        least_inflation=(SPEED_INFLATION, 1.0),
    )


def _whole_turns(gate: Array) -> Array:
    """Begin and end of each turn (turns, 2), without those that are too slow."""
    turns = np.stack([gate[:-1], gate[1:]], axis=1)
    return np.asarray(turns[2 * np.pi / (turns[:, 1] - turns[:, 0]) > SLOWEST_RAD_S])


def _select(t_s: Array, turns: Array, cell_s: Array) -> csr_array:
    """Mean speed of a turn as the angle's difference over its time, thrust as it is; rows (turns + cell), columns 2 n."""
    rate = 1.0 / (turns[:, 1] - turns[:, 0])
    begin, end, cell = (np.searchsorted(t_s, times) for times in (turns[:, 0], turns[:, 1], cell_s))
    number, late = np.arange(len(turns)), len(turns) + np.arange(cell.size)
    rows = np.concatenate([number, number, late])
    columns = np.concatenate([2 * begin, 2 * end, 2 * cell + 1])
    return csr_array((np.concatenate([-rate, rate, np.ones(cell.size)]), (rows, columns)), (late[-1] + 1, 2 * t_s.size))


def _alias(rotor: str) -> dict[str, str]:
    """Names of the plant's parameters -> those of the rotor's model."""
    return {
        **{f"p_b{rotor}_{i}": f"p_b_{i}" for i in range(3)},
        f"K_{rotor}": "K",
        **{f"p_F{rotor}_{i}": f"p_F_{i}" for i in range(5)},
    }
