"""A plan flown in the simulation under one hypothesis, and how far another would miss what is then recorded.

Data are made by hypothesis B without noise but in the sensors' steps; the filter of hypothesis A runs over them. In units of what noise and
process noise leave, its innovations are w_A, and what a re-tune to first order cannot take away is

    z^2 = m(A) - m(B),   m(A) = min over v of |w_A + J_A v|^2 + v' I_A v

with J_A its slopes by the plant's coefficients and those of its effects that the equations carry, and I_A what the logs so far and the
plant file say of them. z standard deviations apart, the log likelihoods of A and B will differ by about z^2 / 2.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from diagnosis import decisions
from diagnosis.experiment.menu import Plan, gravity_parameters
from diagnosis.experiment.stand_in import StandIn, steered
from diagnosis.fit.likelihood import flat_slopes, stacked
from diagnosis.fit.linear_problem import Fit
from diagnosis.hypothesis.case import Case, make_case
from diagnosis.hypothesis.hypothesis import Hypothesis, passes
from diagnosis.validate.simulated import Flown
from records.log import RunLog
from sim.start import start_state

Array = NDArray[np.float64]
GONE = 1e-9  # of gravity's moment where the rig is turned


@dataclass(frozen=True, eq=False)
class SimulatedExperiment:
    """A plan flown under one hypothesis: the log that it would leave, and whether stops and inputs stayed within their limits."""

    log: RunLog
    within_limits: bool


def setting(case: Case, plan: Plan) -> Case:
    """The case as the plan mounts the rig: without gravity's moment where it is turned."""
    if not plan.weightless:
        return case
    model, bound = case.library.bound.model, case.library.bound
    p, sd = bound.p.copy(), bound.sd.copy()
    for name in gravity_parameters(model):
        place = [str(symbol) for symbol in model.parameter_symbols].index(name)
        p[place], sd[place] = GONE * p[place], GONE * sd[place]
    return replace(case, library=replace(case.library, bound=replace(bound, p=p, sd=sd)))


def simulate_experiment(case: Case, plan: Plan, law: StandIn, hypothesis: Hypothesis) -> SimulatedExperiment | None:
    """Fly the plan under a hypothesis; None where the plant leaves all bounds or the law's arm hits a stop and stays there."""
    library, course = case.library, plan.course
    model, own = library.bound.model, len(library.states)
    start_s = max(float(flight.log.t_s[-1]) for flight in case.flights)
    x0 = np.asarray(start_state(library.bound, law.rest.x0), dtype=float)
    plant = Flown(case, _mounted(case, plan, hypothesis), x0, start_s, locked=plan.locked)
    columns = [k for k, axis in enumerate(steered(model)) if axis.name not in plan.locked]
    u, z = np.empty((len(course.t_s), len(model.inputs))), np.zeros(len(law.tracked))
    y, x = np.empty((len(course.t_s), len(model.outputs))), np.empty((len(course.t_s), own))
    idle = law.within(np.zeros(len(model.inputs)))
    for k in range(len(course.t_s)):
        y[k], x[k] = plant.measured(), plant.x[:own]
        if course.off[k]:
            wanted, z = idle + course.dither[k], np.zeros(len(z))
        else:
            wanted, z = law.command(x[k], z, course.reference[k, columns])
            wanted = wanted + course.dither[k]
        u[k] = law.within(wanted)
        plant.advance(u[k], start_s + float(course.t_s[k]) + law.period_s)
        if plant.lost:
            return None
    extra = {}
    if plan.speeds:
        extra = {name: x[:, k] for k, name in enumerate(library.states) if name in library.rotor_speeds}
    log = RunLog(
        case.flights[0].log.columns,
        law.period_s,
        "closed",
        start_s + course.t_s,
        u,
        y,
        extra=extra,
        locked=plan.locked,
    )
    clipped = np.any((u <= law.low) | (u >= law.high), axis=1)
    kept = course.off.any() or np.mean(clipped) <= decisions.NEGLIGIBLE_SHARE
    return SimulatedExperiment(log, bool(kept and _off_the_stops(case, plan, x)))


def _mounted(case: Case, plan: Plan, hypothesis: Hypothesis) -> Hypothesis:
    """The hypothesis as the plan mounts the rig: a moved weight turns no axis that gravity does not."""
    if not plan.weightless:
        return hypothesis
    effects = case.library.effects
    return hypothesis.with_effects({n: v for n, v in hypothesis.effects.items() if not effects[n].needs_gravity})


def _off_the_stops(case: Case, plan: Plan, x: Array) -> bool:
    """Whether no free axis touched a stop while its law was on."""
    bound, course = case.library.bound, plan.course
    flying = ~course.off
    for axis in bound.model.axes:
        if axis.position is None or axis.name in plan.locked or not flying.any() or course.off.any():
            continue
        way = x[flying, case.library.states.index(str(axis.position))]
        low, high = (None if s is None else bound.number(s) for s in (axis.lower, axis.upper))
        if (low is not None and way.min() <= low + 1e-6) or (high is not None and way.max() >= high - 1e-6):
            return False
    return True


def recorded(case: Case, simulated_experiment: SimulatedExperiment) -> Case:
    """A case of the simulated log alone, with what the given one states."""
    made = make_case(case.library, [simulated_experiment.log])
    return replace(made, stated=case.stated, stated_sd=case.stated_sd)


def missed(data: Case, one: Fit, plan: Plan, noisy: Hypothesis) -> float | None:
    """m(A): the squares of what a fitted hypothesis misses of the data, re-tuned; None where its filter cannot follow at all.

    Both hypotheses of a pair are given the process noise of the same `noisy` one: one that takes more of it would seem to miss less.
    """
    hypothesis = replace(
        _mounted(data, plan, one.hypothesis), process_noise=noisy.process_noise, state_noise=noisy.state_noise
    )
    compiled = data.library.compiled(hypothesis.effects)
    count = len(hypothesis.theta)
    numbers = [
        (row, entry)
        for row, entry in enumerate(one.free, count)
        if entry.effect in compiled.names and entry.effect in hypothesis.effects
    ]
    places = [*data.free.tolist(), *(compiled.place(e.effect, e.parameter.symbol) for _, e in numbers)]
    units = np.concatenate([data.sd, [entry.scale for _, entry in numbers]])
    rows = [*range(count), *(row for row, _ in numbers)]
    runs = passes(data, hypothesis, places, slopes=True)
    if runs is None:
        return None
    w = stacked(runs)
    J = np.concatenate([flat_slopes(run) for run in runs]) * units
    pull = J.T @ w
    information = J.T @ J + one.information[np.ix_(rows, rows)]
    return float(w @ w - pull @ np.linalg.lstsq(information, pull, rcond=None)[0])


def outcomes(logs: Sequence[RunLog], floor: Mapping[str, float]) -> tuple[str, float, tuple[float, float]] | None:
    """Where two simulated logs differ most in units of each column's floor: its name, when (s from the start), both values.

    An axis without stops may run away, and its angle then says nothing to who looks at the rig: what lies before goes first.
    """
    upright = min(_turned_round(log, floor) for log in logs)
    return _farthest_apart(logs, floor, upright) or _farthest_apart(logs, floor, len(logs[0].t_s))


def _farthest_apart(
    logs: Sequence[RunLog], floor: Mapping[str, float], rows: int
) -> tuple[str, float, tuple[float, float]] | None:
    """The same among the first rows."""
    first, second = logs
    best, found = 1.0, None
    for name, least in floor.items():
        gap = np.abs(first.column(name) - second.column(name))[:rows] / least
        row = int(np.argmax(gap))
        if gap[row] > best:
            values = float(first.column(name)[row]), float(second.column(name)[row])
            best, found = float(gap[row]), (name, float(first.t_s[row] - first.t_s[0]), values)
    return found


def _turned_round(log: RunLog, names: Iterable[str]) -> int:
    """The first row in which an angle is a whole turn and more from where it began; the number of rows where none is."""
    angles = [log.column(name) for name in names if name.endswith("_rad")]
    beyond = np.array([np.abs(angle - angle[0]) >= 2.0 * np.pi for angle in angles]).any(axis=0)
    return int(np.argmax(beyond)) if np.any(beyond) else len(log.t_s)
