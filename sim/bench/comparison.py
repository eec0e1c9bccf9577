"""How fast the closed loop is simulated, next to the usual tools on the same equations in the same run. Time is measured only here."""

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from records.table import ControllerTable
from sim.bench.compiled_peers import PEERS as COMPILED_PEERS
from sim.bench.peak import ProcessorShare, share
from sim.bench.peers import PEERS, Peer, Task
from sim.bind import BoundPlant
from sim.halving import step_error
from sim.loop import Controller
from sim.manoeuvres import Manoeuvre, flight
from sim.simulate import Conditions, Runs, simulate

Array = NDArray[np.float64]

BATCH = 256
SHORT_S = 4.0  # of the flight, for tools that need a second of computing for some seconds of flight
SECONDS_PER_TOOL = 1.0
SHORTEST_S = 0.2  # of one measurement, so that a coarse clock (16 ms on some systems) can tell
FINE_SUBSTEPS = 100


@dataclass(frozen=True)
class BenchRow:
    """One tool: simulated seconds per second of CPU time on one core, and how many times faster the kernel is.

    `kernel_ratio` is that of the kernel flying one run at a time, None for a tool that flies many at once; `batch_ratio` that of the
    kernel flying many. `apart_rad` is how far the tool's angles at the end are from the kernel's, which tells that it flew the same.
    `note` says what was done differently. A tool that is not installed has None everywhere.
    """

    tool: str
    simulated_s_per_cpu_s: float | None
    kernel_ratio: float | None
    batch_ratio: float | None
    apart_rad: float | None
    note: str


@dataclass(frozen=True)
class StepAccuracy:
    """Error of one step a sample over the whole flight, in rad for each output: as step halving reports it, and as it is.

    `halving_rad` is Richardson's estimate from one and two steps, `true_rad` the largest difference to FINE_SUBSTEPS steps.
    """

    halving_rad: tuple[float, ...]
    true_rad: tuple[float, ...]


def run(
    bound: BoundPlant, table: ControllerTable, controller: Callable[[], Controller]
) -> tuple[tuple[BenchRow, ...], ProcessorShare]:
    """Fly the project's flight with the law of `table` by every tool; `controller` makes that law for the tools that call Python.

    Returns a row for each, and what of the processor's peak the kernel reaches.

    The kernel runs with dry friction, stops and quantisation; peers have neither sticking nor stops: their friction is
    b_c tanh(v / 0.005 rad/s), and they fly what comes after take-off: all of it where they compile plant and law, as a call costs
    such a tool a third of four seconds' time, else the first SHORT_S.
    """
    whole = flight(bound, table.sample_period_s)
    p = bound.p + bound.sd * np.random.default_rng(0).normal(size=(BATCH, bound.p.size))
    rest = after_take_off(bound, table, whole)
    task, long_task = (Task(bound, table, controller, piece, p) for piece in (beginning(rest, SHORT_S), rest))
    single, batch = (
        speed(partial(_fly, bound, table, whole, sets, "uy"), _simulated_s(whole, sets)) for sets in (bound.p, p)
    )
    rows = [
        BenchRow(
            "twinlaw kernel", single, 1.0, batch / single, 0.0, "one RK4 step a sample, sticking, stops, encoders"
        ),
        BenchRow(f"twinlaw kernel, {BATCH} sets", batch, None, 1.0, 0.0, "the same, parameter sets side by side"),
    ]
    others = (
        _row(name, peer, flown, single, batch)
        for peers, flown in ((PEERS, task), (COMPILED_PEERS, long_task))
        for name, peer in peers.items()
    )
    return (*rows, *others), share(task, single, batch)


def _fly(bound: BoundPlant, table: ControllerTable, manoeuvre: Manoeuvre, p: Array, keep: str) -> Runs:
    return simulate(
        bound, manoeuvre.t_s, manoeuvre.x0, table, Conditions(reference=manoeuvre.reference_rad, p=p, keep=keep)
    )


def _simulated_s(manoeuvre: Manoeuvre, p: Array) -> float:
    return float(manoeuvre.t_s[-1] - manoeuvre.t_s[0]) * (1 if p.ndim == 1 else len(p))


def _row(name: str, peer: Peer, task: Task, single: float, batch: float) -> BenchRow:
    work = peer.prepare(task)
    if work is None:
        return BenchRow(name, None, None, None, None, peer.note)
    sets = task.p if peer.batched else task.bound.p
    x = _fly(task.bound, task.table, task.piece, sets, "x").x
    assert x is not None
    apart_rad = float(np.max(np.abs(np.asarray(work()) - x[..., -1, task.output_rows])))
    found = speed(work, _simulated_s(task.piece, sets))
    return BenchRow(name, found, None if peer.batched else single / found, batch / found, apart_rad, peer.note)


def speed(work: Callable[[], object], simulated_s: float, clock: Callable[[], float] = time.process_time) -> float:
    """Simulated seconds per CPU second of `work`, which simulates `simulated_s`: the best of what fits into SECONDS_PER_TOOL.

    The work is repeated until one measurement lasts longer than SHORTEST_S.
    """
    work()
    repeats, best, spent = 1, 0.0, 0.0
    while best == 0.0 or spent < SECONDS_PER_TOOL:
        begin = clock()
        for _ in range(repeats):
            work()
        took = clock() - begin
        spent += took
        if took > SHORTEST_S:
            best = max(best, repeats * simulated_s / took)
        else:
            repeats *= 2
    return best


def step_accuracy(bound: BoundPlant, table: ControllerTable) -> StepAccuracy:
    """The step-halving check of the whole flight, next to the error against FINE_SUBSTEPS times finer steps; both in rad, per output."""
    whole = flight(bound, table.sample_period_s)
    halved = step_error(bound, whole.t_s, whole.x0, table, reference=whole.reference_rad)
    coarse, fine = (
        simulate(
            bound,
            whole.t_s,
            whole.x0,
            table,
            Conditions(
                reference=whole.reference_rad, resolution=np.zeros(len(bound.model.outputs)), substeps=count, keep="y"
            ),
        ).y
        for count in (1, FINE_SUBSTEPS)
    )
    assert coarse is not None
    assert fine is not None
    return StepAccuracy(tuple(halved.estimate.tolist()), tuple(np.max(np.abs(coarse - fine), axis=0).tolist()))


def after_take_off(bound: BoundPlant, table: ControllerTable, whole: Manoeuvre) -> Manoeuvre:
    """The flight from a step in the air on, from the state in which it gets there."""
    start = int(np.argmax(whole.t_s >= 9.0))
    flown = simulate(bound, whole.t_s, whole.x0, table, Conditions(reference=whole.reference_rad, keep="x")).x
    assert flown is not None
    return Manoeuvre("steps", whole.t_s[start:] - whole.t_s[start], whole.reference_rad[start:], flown[start])


def beginning(whole: Manoeuvre, last_s: float) -> Manoeuvre:
    """The first `last_s` of it."""
    stop = int(np.argmax(whole.t_s >= last_s))
    return replace(whole, t_s=whole.t_s[: stop + 1], reference_rad=whole.reference_rad[: stop + 1])
