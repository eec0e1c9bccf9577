"""How fast the closed loop is simulated, next to the usual tools on the same equations in the same run. Time is measured only here."""

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from records.table import ControllerTable
from sim import bench_compiled, bench_peers
from sim.bind import BoundPlant
from sim.loop import Controller
from sim.manoeuvres import Manoeuvre, flight
from sim.simulate import simulate

BATCH = 256
SHORT_S = 4.0  # of the flight, for tools that need a second of computing for some seconds of flight
SECONDS_PER_TOOL = 1.0


@dataclass(frozen=True)
class BenchRow:
    """One tool: simulated seconds per second of CPU time on one core, and how many times slower than the kernel that is.

    `single` tells whether one run is simulated at a time or many; the ratio is to the kernel's row of the same kind. `note` says what
    was left out or done differently; `simulated_s_per_cpu_s` is None for a tool that is not installed.
    """

    tool: str
    single: bool
    simulated_s_per_cpu_s: float | None
    ratio: float | None
    note: str


def run(bound: BoundPlant, table: ControllerTable, controller: Callable[[], Controller]) -> tuple[BenchRow, ...]:
    """Fly the project's flight with the law of `table` by every tool; `controller` makes that law for the tools that call Python.

    The kernel runs with dry friction, stops and quantisation; peers have neither sticking nor stops: their friction is
    b_c tanh(v / 0.005 rad/s), and they fly the piece of the flight after take-off.
    """
    whole = flight(bound)
    p = bound.p + bound.sd * np.random.default_rng(0).normal(size=(BATCH, bound.p.size))

    def kernel(runs: np.ndarray) -> Callable[[], float]:
        def fly() -> float:
            simulate(bound, whole.t_s, whole.x0, table, reference=whole.reference_rad, p=runs, keep="uy")
            return float(whole.t_s[-1]) * (1 if runs.ndim == 1 else len(runs))

        return fly

    single, batch = speed(kernel(bound.p)), speed(kernel(p))
    rows = [
        BenchRow("twinlaw kernel", True, single, 1.0, "one RK4 step a sample, sticking, stops, quantisation"),
        BenchRow(f"twinlaw kernel, {BATCH} parameter sets", False, batch, 1.0, "the same bits as one by one"),
    ]
    piece = after_take_off(bound, table, whole)
    for name, peer in (*bench_peers.PEERS.items(), *bench_compiled.PEERS.items()):
        prepared = peer.prepare(bound, table, controller, piece)
        found = None if prepared is None else speed(prepared)
        rows.append(BenchRow(name, True, found, None if found is None else single / found, peer.note))
    return tuple(rows)


def speed(work: Callable[[], float]) -> float:
    """Simulated seconds per CPU second of `work`, which returns what it simulated: the best of as many goes as fit into a second."""
    work()
    best, spent = np.inf, 0.0
    while np.isinf(best) or spent < SECONDS_PER_TOOL:
        begin = time.process_time()
        simulated_s = work()
        took = max(time.process_time() - begin, 1e-6)  # the clock's own step
        best, spent = min(best, took / simulated_s), spent + took
    return float(1.0 / best)


def after_take_off(bound: BoundPlant, table: ControllerTable, whole: Manoeuvre) -> Manoeuvre:
    """The first `SHORT_S` of a step in the air, from the state in which the flight gets there."""
    start = int(np.argmax(whole.t_s >= 9.0))
    stop = start + int(np.argmax(whole.t_s >= SHORT_S))
    flown = simulate(bound, whole.t_s, whole.x0, table, reference=whole.reference_rad, keep="x").x
    assert flown is not None
    t_s = whole.t_s[start : stop + 1] - whole.t_s[start]
    return Manoeuvre("step", t_s, whole.reference_rad[start : stop + 1], flown[start])
