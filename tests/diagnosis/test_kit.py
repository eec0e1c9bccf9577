"""Compiled filters: which one carries what, and that several diagnoses may want them at once with nothing in the cache yet."""

import os
import signal
import subprocess
import sys
from pathlib import Path

from diagnosis.abreast import WORKERS
from diagnosis.kit import make_kit
from sim.bind import BoundPlant
from tests.test_project import ROOT
from toolchain.cache import CACHE_DIR

# Three threads of a process ask for two variants of one kit, as a search does; then the filter runs in all of them.
ASK = """
from concurrent.futures import ThreadPoolExecutor
import numpy as np
from diagnosis.case import make_case
from diagnosis.hypothesis import nothing_supposed, passes
from diagnosis.kit import make_kit
from records.log import RunLog
from sim.columns import log_columns
from tests.plants import bound

plant = bound("aeroshield")
kit = make_kit(plant)
t_s = np.arange(200) * 0.01
log = RunLog(log_columns(plant.model), 0.01, "open", t_s, np.full((200, 1), 1.5), np.sin(t_s)[:, None])
case = make_case(kit, [log])

def likelihood(_):
    kit.variant(()), kit.variant(kit.wide_names)
    return passes(case, nothing_supposed(case, -1.5))[0].log_likelihood

with ThreadPoolExecutor(3) as pool:
    print(repr(list(pool.map(likelihood, range(6)))))
"""

# A search is announced, and the process is through before anything of it is built.
ANNOUNCE = """
from diagnosis.kit import make_kit
from tests.plants import bound

kit = make_kit(bound("emps"))
kit.prepare()
kit.prepare_bristles()
"""

WAIT = """
import signal, sys
from diagnosis.abreast import through_when_interrupted

signal.signal(signal.SIGINT, signal.default_int_handler)
try:
    with through_when_interrupted():
        print("announced", flush=True)
        signal.pause()
except KeyboardInterrupt:
    sys.exit(3)
"""


def test_two_processes_and_their_threads_on_an_empty_cache_get_the_same_filters(tmp_path: Path) -> None:
    # The compiler keeps its own cache, which knows of processes; the project's starts empty.
    (tmp_path / "zig").symlink_to(CACHE_DIR / "zig")
    environment = {**os.environ, "TWINLAW_CACHE": str(tmp_path)}
    command = [sys.executable, "-c", ASK]
    pipe = subprocess.PIPE
    both = [subprocess.Popen(command, cwd=ROOT, env=environment, stdout=pipe, stderr=pipe, text=True) for _ in range(2)]
    said = [process.communicate() for process in both]
    assert [process.returncode for process in both] == [0, 0], said
    (first, _), (second, _) = said
    assert first == second
    assert len(set(first.strip("[]\n").split(", "))) == 1
    left = sorted(path.name.split("-")[0] for path in (tmp_path / "host").iterdir() if "filter" in path.name)
    assert left == ["filter", "filter"]
    assert not [path for path in (tmp_path / "host").iterdir() if path.is_dir()]
    assert not list((tmp_path / "kits").glob(".*"))


def test_what_was_announced_is_there_when_the_process_ends(tmp_path: Path) -> None:
    (tmp_path / "zig").symlink_to(CACHE_DIR / "zig")
    environment = {**os.environ, "TWINLAW_CACHE": str(tmp_path)}
    said = subprocess.run(
        [sys.executable, "-c", ANNOUNCE], cwd=ROOT, env=environment, capture_output=True, text=True, check=False
    )
    assert (said.returncode, said.stderr) == (0, "")
    # The plant alone, with the whole library, with what has no state, with the one sensor's lag, with axes that yield.
    assert len([path for path in (tmp_path / "host").iterdir() if path.suffix == ".so"]) == 5
    assert not [path for path in (tmp_path / "host").iterdir() if path.is_dir()]


def test_a_lag_alone_is_carried_without_the_library(plant: BoundPlant) -> None:
    kit = make_kit(plant)
    alone, beside = (kit.variant(names) for names in (["psi_sensor.lag"], ["psi_sensor.lag", kit.names[0]]))
    assert alone.names == {"psi_sensor.lag"}
    assert alone.states == beside.states
    assert beside.names == {"psi_sensor.lag", *kit.names}


def test_of_what_brings_states_one_or_all_are_carried(plant: BoundPlant) -> None:
    kit = make_kit(plant)
    first, second, *_ = kit.wide_names
    one, two = kit.variant([first]), kit.variant([first, second])
    assert one.names == {first, *kit.names}
    assert two.names == {*kit.names, *kit.wide_names}
    assert len(kit.states) < len(one.states) < len(two.states)


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
    # Two were at work; the three behind them are never begun.
    assert len(list((tmp_path / "host").glob("*.so"))) <= WORKERS
    assert not [path for path in (tmp_path / "host").glob("*") if path.is_dir()]
