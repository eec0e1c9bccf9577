"""How fast ten parameters come back from a minute of flight, next to the usual tools on the same data. Time is measured only here."""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from identification.fit.belief import NOTHING
from identification.fit.ranges import ranges_of
from identification.fit.solve import solve
from identification.proof.bench_slopes import FitProblem, Fitted, casadi_fit, jax_fit
from identification.runs.log_run import log_run
from identification.runs.run import Run, coefficient_names
from identification.stages.estimate import problem_of
from identification.stages.logs import identify_logs
from records.log import RunLog
from sim.bench.peers import module
from sim.bind import BoundPlant, bind
from sim.columns import log_columns
from sim.equilibrium import equilibrium
from sim.runs.stepped import SteppedPlant
from sim.simulate import Conditions, simulate

Array = NDArray[np.float64]
NAMES = ("K_M", "J_E", "tau_gE", "b_vE", "b_cE", "K_T", "J_A", "b_vA", "b_cA", "K_A")
DURATION_S, PERIOD_S, SUBSTEPS = 60.0, 0.01, 4
TURN_DEG = 30.0
OFF = 0.3
NEARER = (
    1.0 / 3.0
)  # of that, for tools that predict a whole log at once with slopes that a run out of bounds does not have
COARSE_S, COARSE_EVERY, COARSE_SETTLED = 0.5, 4, 10.0
MOST_RUNS = 3000


@dataclass(frozen=True)
class FitRow:
    """One tool: CPU seconds of one core, how many times faster the project is, worst error of the ten parameters, what it does."""

    tool: str
    cpu_s: float | None
    ratio: float | None
    worst_error: float | None
    note: str


@dataclass(frozen=True, eq=False)
class BenchFlight:
    """A minute of flight below the horizon with both axes kept moving, its true parameters, and a start 30 % off either way."""

    bound: BoundPlant
    log: RunLog
    x0: Array
    truth: Array
    start: Array


def task(bound: BoundPlant, seed: int = 1) -> BenchFlight:
    """Fly the CE150 from balance at -25 deg: main rotor steps, and a tail rotor that turns the azimuth back at 30 deg."""
    rng = np.random.default_rng(seed)
    balance = equilibrium(bound, np.radians(-25.0))
    plant, n = SteppedPlant(bound, balance.x0), round(DURATION_S / PERIOD_S) + 1
    t_s, u, y = np.linspace(0.0, DURATION_S, n), np.empty((n, 2)), np.empty((n, 2))
    side, strength, level = 1.0, 1.5, 0.0
    for k in range(n):
        y[k] = plant.measured()
        if k % 150 == 0:
            level = rng.uniform(0.98, 1.02) * balance.u0[0]
        if side * y[k, 1] > np.radians(TURN_DEG):
            side, strength = -side, rng.uniform(0.6, 2.0)
        u[k] = level, balance.u0[1] + side * strength
        if k + 1 < n:
            plant.advance(u[k].tolist(), float(t_s[k + 1]), SUBSTEPS)
    truth = bound.p[[coefficient_names(bound.model).index(name) for name in NAMES]]
    start = truth * (1.0 + OFF * rng.choice([-1.0, 1.0], truth.size))
    return BenchFlight(bound, RunLog(log_columns(bound.model), PERIOD_S, "open", t_s, u, y), balance.x0, truth, start)


def fit(work: BenchFlight) -> Array:
    """The ten parameters (10,) by the project's way: a quarter of the data in short windows, then the whole log at once."""
    ranges = {
        name: replace(entry, start=float(start))
        for (name, entry), start in zip(ranges_of(work.bound, NAMES).items(), work.start, strict=True)
    }
    runs = (log_run(work.bound, work.log, "bench", COARSE_S, COARSE_EVERY, work.x0),)
    coarse = solve(problem_of(runs, NAMES, ranges, NOTHING), settled=COARSE_SETTLED)
    closer = {
        name: replace(entry, start=float(value))
        for (name, entry), value in zip(ranges.items(), coarse.theta, strict=True)
    }
    whole = _from_rest(log_run(work.bound, work.log, "bench", np.inf, at_first=work.x0))
    return solve(problem_of((whole,), NAMES, closer, NOTHING)).theta


def _from_rest(run: Run) -> Run:
    """The run of one window that begins at rest, as this one does for every tool here: its axes' first velocities are not free."""
    velocities = {str(axis.velocity) for axis in run.bound.model.axes}
    kept = [place for place, state in enumerate(run.free) if state not in velocities]
    return replace(run, free=tuple(run.free[place] for place in kept), start_sd=run.start_sd[:, kept])


def identified(work: BenchFlight) -> Array:
    """The same parameters (10,) with their intervals, weights and tests, as `twinlaw identify` finds them."""
    numbers = dict(zip(NAMES, work.start.tolist(), strict=True))
    parameters = dict(work.bound.plant.parameters)
    parameters |= {name: replace(parameters[name], value=value) for name, value in numbers.items()}
    start = bind(replace(work.bound.plant, parameters=parameters))
    found = identify_logs(start, {"bench": work.log}, NAMES).belief
    return np.array([found.value(name) for name in NAMES])


def _residual(work: BenchFlight) -> Callable[[Array], Array]:
    """Output error over the whole log by one parameter set, relative to the start, on the compiled simulation."""
    places = [coefficient_names(work.bound.model).index(name) for name in NAMES]

    def residual(relative: Array) -> Array:
        p = work.bound.p.copy()
        p[places] = np.maximum(relative, 1e-3) * work.start
        run = simulate(work.bound, work.log.t_s, work.x0, work.log.u, Conditions(p=p, resolution=[0.0, 0.0], keep="y"))
        assert run.y is not None
        return np.asarray((run.y - work.log.y).ravel())

    return residual


def _scipy(work: BenchFlight) -> Array:
    found = least_squares(_residual(work), np.ones(len(NAMES)), method="trf", max_nfev=MOST_RUNS // len(NAMES))
    return np.asarray(found.x * work.start)


def _lmfit(work: BenchFlight) -> Fitted | None:
    lmfit = module("lmfit")
    if lmfit is None:
        return None
    parameters = lmfit.Parameters()
    for name in NAMES:
        parameters.add(name, value=1.0)
    residual = _residual(work)

    def fitted() -> Array:
        found = lmfit.minimize(
            lambda values: residual(np.array([values[name].value for name in NAMES])), parameters, max_nfev=MOST_RUNS
        )
        return np.array([found.params[name].value for name in NAMES]) * work.start

    return fitted


def _differentiated(prepare: Callable[[FitProblem], Fitted | None]) -> Callable[[BenchFlight], Fitted | None]:
    """A tool that brings its own simulation and slopes, compiled before the fit is timed."""

    def prepared(work: BenchFlight) -> Fitted | None:
        names = coefficient_names(work.bound.model)
        places = [names.index(name) for name in NAMES]
        start = work.truth + NEARER * (work.start - work.truth)
        return prepare(FitProblem(work.bound, PERIOD_S, work.log.u, work.log.y, work.x0, places, start))

    return prepared


def _at_once(fitted: Callable[[BenchFlight], Array]) -> Callable[[BenchFlight], Fitted]:
    return lambda work: lambda: fitted(work)


DIFFERENCES = "finite differences of the same compiled simulation, whole log"
EXACT = (
    "SciPy's trust region on its own simulation and exact slopes, compiled before, friction smoothed, whole log; "
    "from a start 10 % off, as from 30 % it ends where it began"
)
PEERS: Mapping[str, tuple[Callable[[BenchFlight], Fitted | None], str]] = {
    "SciPy least_squares": (_at_once(_scipy), DIFFERENCES),
    "lmfit leastsq": (_lmfit, DIFFERENCES),
    "CasADi": (_differentiated(casadi_fit), EXACT),
    "JAX": (_differentiated(jax_fit), EXACT),
}


def run(bound: BoundPlant) -> tuple[FitRow, ...]:
    """Fit by every tool from the same start; raises nothing for a tool that is absent or ends elsewhere: its error tells."""
    work = task(bound)
    fit(work)  # compiled and warm
    own_s, own = min((_timed(lambda: fit(work)) for _ in range(3)), key=lambda pair: pair[0])
    all_s, every = min((_timed(lambda: identified(work)) for _ in range(3)), key=lambda pair: pair[0])
    rows = [
        FitRow("twinlaw, the fit", own_s, 1.0, _worst(work, own), "exact slopes, windows first, then the whole log"),
        FitRow("twinlaw identify", all_s, all_s / own_s, _worst(work, every), "weights, intervals, tests too"),
    ]
    for tool, (prepare, note) in PEERS.items():
        fitted = prepare(work)
        if fitted is None:
            rows.append(FitRow(tool, None, None, None, note))
            continue
        took_s, found = _timed(fitted)
        rows.append(FitRow(tool, took_s, took_s / own_s, _worst(work, found), note))
    return tuple(rows)


def _timed(work: Fitted) -> tuple[float, Array]:
    begin = time.process_time()
    found = work()
    return max(time.process_time() - begin, 1e-6), found


def _worst(work: BenchFlight, found: Array) -> float:
    return float(np.max(np.abs(found / work.truth - 1.0)))
