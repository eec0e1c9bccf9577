"""A rig, a way to fly it at one place, and one small benchmark of each rig that the tests of this folder share."""

from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

from blind import FIRST, Benchmark, make
from blind.cases.make import Order, make_case
from blind.cases.sealed import open_seal, truth_to_json
from blind.rigs.first import lab as first_lab
from blind.rigs.first.manoeuvre import FirstStyle, make_inputs
from blind.rigs.first.pilot import make_pilot
from blind.rigs.first.simulation import BRISTLES, FASTEST_RAD_S, PROGRAM
from blind.rigs.second import lab as second_lab
from blind.simulation.ce150 import Rig, load_rig
from blind.simulation.flight import Apparatus, RunInputs, fly
from blind.simulation.record import Model, Record
from blind.simulation.rest import start_state
from tests.soak import SOAK

PLANT = Path(__file__).resolve().parents[2] / "plants" / "ce150.toml"
SEED, KINDS = 8, ("nominal", "single", "double", "outside")
SECOND_SEED, SECOND_KINDS = 7, ("nominal", "single", "outside")
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
    apparatus = Apparatus(PROGRAM, BRISTLES, rig, make_pilot(rig, 1.0))

    def run(
        flight: RunInputs, settings: Settings, *, placed: bool = False, changes: Mapping[str, float] | None = None
    ) -> Record:
        own = rig.with_values({name: np.array([value]) for name, value in (changes or {}).items()})
        model = Model(own, settings)
        start = start_state(rig, *flight.reference[0], FASTEST_RAD_S)
        return fly(apparatus, model, flight, start, [model, Model(rig, {}, placed=placed)])

    return run


def shorten(patch: pytest.MonkeyPatch) -> None:
    """Runs of a fifth of their length, unless a soak: as many cases, each with all that a case goes through.

    None of the effects that the seeds give begins later than these runs end.
    """
    if not SOAK:
        for lab in (first_lab, second_lab):
            patch.setattr(lab, "TRIAL_S", 6.0)
        patch.setattr(first_lab, "RUN_S", 12.0)
        patch.setattr(second_lab, "RUN_LENGTHS_S", (12, 15))


@pytest.fixture(scope="session")
def benchmark_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One case each of KINDS, by the first rig."""
    return _made(tmp_path_factory, FIRST, KINDS, SEED)


@pytest.fixture(scope="session")
def second_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One case each of SECOND_KINDS, by the second rig."""
    return _made(tmp_path_factory, "second", SECOND_KINDS, SECOND_SEED)


def _made(paths: pytest.TempPathFactory, rig: str, kinds: tuple[str, ...], seed: int) -> Path:
    out = paths.mktemp(rig) / "cases"
    with ThreadPoolExecutor() as pool, pytest.MonkeyPatch.context() as patch:
        shorten(patch)
        make(Benchmark(seed, len(kinds), kinds, rig=rig), out, pool.map)
    return out


def comes_out_the_same(folder: Path, rig: str, kinds: tuple[str, ...], seed: int) -> bool:
    """Whether the single case of such a benchmark has the same files and the same truth when it is made once more, without company."""
    name, truth = next((name, truth) for name, truth in open_seal(folder).items() if truth.kind == "single")
    with pytest.MonkeyPatch.context() as patch:
        shorten(patch)
        made = make_case(Order(seed, int(name[-4:]), len(kinds), kinds, PLANT.read_text(), rig))
    known = {path.name: path.read_text() for path in (folder / name).iterdir()}
    return bool(made["files"] == known and made["truth"] == truth_to_json(truth))
