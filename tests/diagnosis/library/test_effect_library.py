"""Compiled filters: which one carries what, and that several diagnoses may want them at once with nothing in the cache yet."""

import os
import signal
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from diagnosis.filter.kalman import Pass
from diagnosis.hypothesis.case import make_case
from diagnosis.hypothesis.hypothesis import nominal_hypothesis, passes
from diagnosis.library.effect_library import EffectLibrary, effect_library
from jobs.thread_map import WORKERS
from records.log import RunLog
from sim.bind import BoundPlant
from sim.columns import log_columns
from sim.effect import Values
from tests.diagnosis.arm import arm
from tests.plants import bound
from tests.soak import sampled
from tests.test_project import ROOT
from toolchain.cache import CACHE_DIR

# Three threads of a process ask for one or two variants of one library, as a search does; then the filter runs in all of them.
ASK = """
from concurrent.futures import ThreadPoolExecutor
import numpy as np
from diagnosis.hypothesis.case import make_case
from diagnosis.hypothesis.hypothesis import nominal_hypothesis, passes
from diagnosis.library.effect_library import effect_library
from records.log import RunLog
from sim.columns import log_columns
from tests.plants import bound

plant = bound("aeroshield")
library = effect_library(plant)
t_s = np.arange(200) * 0.01
log = RunLog(log_columns(plant.model), 0.01, "open", t_s, np.full((200, 1), 1.5), np.sin(t_s)[:, None])
case = make_case(library, [log])

def likelihood(_):
    library.compiled(()), library.compiled({asked})
    return passes(case, nominal_hypothesis(case, -1.5))[0].log_likelihood

with ThreadPoolExecutor(3) as pool:
    print(repr(list(pool.map(likelihood, range(6)))))
"""

# A search is announced, and the process is through before anything of it is built.
ANNOUNCE = """
from diagnosis.library.effect_library import effect_library
from tests.plants import bound

library = effect_library(bound("emps"))
library.prepare()
"""

WAIT = """
import signal, sys
from jobs.thread_map import through_when_interrupted

signal.signal(signal.SIGINT, signal.default_int_handler)
try:
    with through_when_interrupted():
        print("announced", flush=True)
        signal.pause()
except KeyboardInterrupt:
    sys.exit(3)
"""


@pytest.mark.soak  # a cold library, by processes
@pytest.mark.parametrize(("asked", "filters"), sampled([("()", 1), ("library.wide_names", 2)], keep=[("()", 1)]))
def test_two_processes_and_their_threads_on_an_empty_cache_get_the_same_filters(
    tmp_path: Path, asked: str, filters: int
) -> None:
    # The compiler keeps its own cache, which knows of processes; the project's starts empty.
    (tmp_path / "zig").symlink_to(CACHE_DIR / "zig")
    environment = {**os.environ, "TWINLAW_CACHE": str(tmp_path)}
    command = [sys.executable, "-c", ASK.format(asked=asked)]
    pipe = subprocess.PIPE
    both = [subprocess.Popen(command, cwd=ROOT, env=environment, stdout=pipe, stderr=pipe, text=True) for _ in range(2)]
    said = [process.communicate() for process in both]
    assert [process.returncode for process in both] == [0, 0], said
    (first, _), (second, _) = said
    assert first == second
    assert len(set(first.strip("[]\n").split(", "))) == 1
    left = sorted(path.name.split("-")[0] for path in (tmp_path / "host").iterdir() if "filter" in path.name)
    assert left == filters * ["filter"]
    assert not [path for path in (tmp_path / "host").iterdir() if path.is_dir()]
    notes = {path.suffix for path in (tmp_path / "effect_libraries").iterdir()}
    assert notes == {".json"}  # whole ones alone


@pytest.mark.soak
def test_what_was_announced_is_there_when_the_process_ends(tmp_path: Path) -> None:
    (tmp_path / "zig").symlink_to(CACHE_DIR / "zig")
    environment = {**os.environ, "TWINLAW_CACHE": str(tmp_path)}
    said = subprocess.run(
        [sys.executable, "-c", ANNOUNCE], cwd=ROOT, env=environment, capture_output=True, text=True, check=False
    )
    assert (said.returncode, said.stderr) == (0, "")
    # The plant alone, with the whole library, with what has no state and lags.
    assert len([path for path in (tmp_path / "host").iterdir() if path.suffix == ".so"]) == 3
    assert not [path for path in (tmp_path / "host").iterdir() if path.is_dir()]


def test_of_the_variants_the_narrowest_is_taken() -> None:
    library = effect_library(arm())
    noises = set(library.noises)
    assert library.compiled(["theta_sensor.delay"]).names == noises
    for wanted in (["theta_sensor.lag"], [library.names[0]], [library.names[0], "theta_sensor.lag"]):
        assert library.compiled(wanted).names == {*library.names, "theta_sensor.lag", *noises}
    for wanted in (
        ["theta_sensor.lag", library.wide_names[0]],
        [library.names[0], library.wide_names[0]],
    ):
        assert library.compiled(wanted).names == {*library.whole, *noises}


def test_axes_that_yield_have_a_variant_without_the_other_effects_that_bring_states(plant: BoundPlant) -> None:
    library = effect_library(plant)
    assert set(library.bristles) == {"elevation.bristles", "azimuth.bristles"}
    yielding = library.carrying(["azimuth.bristles", library.narrow[0]])
    assert set(yielding) == {*library.narrow, *library.bristles}
    assert library.carrying(["azimuth.bristles", library.wide_names[0]]) == library.whole


def test_what_no_filter_follows_is_in_none_and_is_no_candidate(plant: BoundPlant) -> None:
    library = effect_library(plant)
    assert "main_rotor.imbalance" in library.effects
    assert not any(name.endswith(".imbalance") for name in (*library.whole, *library.candidates))


ASLEEP: list[dict[str, Values]] = [
    {"psi_sensor.lag": {"tau": 0.02}},
    {"elevation.flexible_mode": {"gain": 0.4, "omega_n": 14.0, "zeta": 0.3}},
    {"elevation.presliding": {"b": 3e-4, "z_0": 0.01}, "phi_sensor.lag": {"tau": 0.03}},
    {"main_rotor.dry_friction": {"c": 50.0}, "azimuth.bristles": {"z_0": 0.01}, "azimuth.coulomb": {"b": 0.002}},
]
ASLEEP.append(ASLEEP[2] | ASLEEP[3])
ASLEEP_ON_THE_ARM: dict[str, Values] = {
    "arm.presliding": {"b": 4e-5, "z_0": 0.02},
    "theta_sensor.lag": {"tau": 0.03},
    "arm.coulomb": {"b": 2e-4},
}
PLANTS = [*(("ce150", effects) for effects in ASLEEP), ("aeroshield", ASLEEP_ON_THE_ARM)]


@pytest.mark.parametrize(("name", "effects"), sampled(PLANTS, keep=[]))
def test_effects_that_sleep_change_nothing(name: str, effects: dict[str, Values]) -> None:
    # Truth: a filter of these effects' equations and the rotors' friction alone, which differs by the order of sums. Without that friction
    # it differed by 5e-6 of 20: a rotor is then no axis, and no step ends where it stands still.
    plant = bound(name)
    library = effect_library(plant)
    model = plant.model
    t_s = np.arange(400) * 0.01
    y = np.column_stack([0.3 * np.sin(t_s), 0.2 * np.cos(2.0 * t_s)])[:, : len(model.outputs)]
    u = np.column_stack([3.0 + np.sin(5.0 * t_s), np.cos(3.0 * t_s)])[:, : len(model.inputs)]
    case = make_case(library, [RunLog(log_columns(model), 0.01, "open", t_s, u, y)])
    symbols = [(name, symbol) for name, values in effects.items() for symbol in values]

    def run(library: EffectLibrary) -> Pass:
        compiled = library.compiled(effects)
        hypothesis = nominal_hypothesis(case, -1.5).with_effects(effects)
        places = [*range(library.own), *(compiled.place(name, symbol) for name, symbol in symbols)]
        found = passes(replace(case, library=library), hypothesis, places)
        assert found is not None
        return found[0]

    kept = {*effects, "main_rotor.dry_friction", "tail_rotor.dry_friction"} & library.effects.keys()
    few = replace(
        library,
        effects={name: library.effects[name] for name in kept},
        names=tuple(name for name in library.names if name in effects),
        wide_names=tuple(name for name in library.wide_names if name in kept),
        bristles=tuple(name for name in library.bristles if name in effects),
    )
    beside, alone = run(library), run(few)
    assert beside.x.shape[1] > alone.x.shape[1]
    np.testing.assert_allclose(beside.w, alone.w, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(beside.gram, alone.gram, rtol=1e-7, atol=1e-9 * np.abs(alone.gram).max())


@pytest.mark.soak  # a cold library, by processes
def test_interrupted_it_begins_nothing_more(tmp_path: Path) -> None:
    (tmp_path / "zig").symlink_to(CACHE_DIR / "zig")
    command = [sys.executable, "-c", ANNOUNCE + WAIT]
    environment = {**os.environ, "TWINLAW_CACHE": str(tmp_path)}
    pipe = subprocess.PIPE
    with subprocess.Popen(
        command, cwd=ROOT, env=environment, stdout=pipe, stderr=pipe, start_new_session=True
    ) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == b"announced\n"
        os.killpg(process.pid, signal.SIGINT)  # as a terminal does, to the compilers too
        process.communicate()
    assert process.returncode == 3
    # Two were at work; the one behind them is never begun.
    assert len(list((tmp_path / "host").glob("*.so"))) <= WORKERS
    assert not [path for path in (tmp_path / "host").glob("*") if path.is_dir()]
