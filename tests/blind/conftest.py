"""A rig, a way to fly it at one place, and one small benchmark that the tests of this folder share."""

from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

from blind import make
from blind.rigs.first.manoeuvre import FirstStyle, make_inputs
from blind.rigs.first.pilot import make_pilot
from blind.rigs.first.simulation import BRISTLES, FASTEST_RAD_S, PROGRAM
from blind.simulation.ce150 import Rig, load_rig
from blind.simulation.flight import RunInputs, fly
from blind.simulation.record import Model, Record
from blind.simulation.rest import start_state

PLANT = Path(__file__).resolve().parents[2] / "plants" / "ce150.toml"
Settings = Mapping[tuple[str, int], float]


@pytest.fixture(scope="session")
def rig() -> Rig:
    return load_rig(PLANT)[0]


def calm_flight(seconds: float, psi_rad: float = 0.0, phi_rad: float = 0.0) -> RunInputs:
    """Both angles held, no dither, still air."""
    style = FirstStyle(seconds, False, 0.0, 0.0, (0.0, 0.0), (0.0, 0.0), False, 0.0)
    flight = make_inputs(style, np.random.default_rng(0))
    flight.reference[:] = psi_rad, phi_rad
    return flight


def lively_flight(seconds: float, seed: int = 3) -> RunInputs:
    """Large, fast references with dither on both inputs, still air."""
    style = FirstStyle(seconds, True, 0.45, 1.4, (0.5, 2.0), (0.0, 0.0), False, 0.0)
    return make_inputs(style, np.random.default_rng(seed))


@pytest.fixture(scope="session")
def flown(rig: Rig) -> Callable[..., Record]:
    """Fly the nominal rig with settings of effects; shadow 0 has them, shadow 1 has not."""
    pilot = make_pilot(rig, 1.0)

    def run(
        flight: RunInputs, settings: Settings, *, placed: bool = False, changes: Mapping[str, float] | None = None
    ) -> Record:
        own = rig.with_values({name: np.array([value]) for name, value in (changes or {}).items()})
        model = Model(own, settings)
        start = start_state(rig, *flight.reference[0], FASTEST_RAD_S)
        return fly(PROGRAM, model, BRISTLES, rig, pilot, flight, start, [model, Model(rig, {}, placed=placed)])

    return run


@pytest.fixture(scope="session")
def benchmark_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Five cases: one without effect, one single, one double, one out of library, one more."""
    out = tmp_path_factory.mktemp("blind") / "cases"
    with ThreadPoolExecutor() as pool:
        make(5, out, 5, each=pool.map)
    return out
