"""One case: a rig, its hidden effects, three runs, and the truth about them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from blind.cases.sealed import Hold, TrueEffect, Truth
from blind.cases.severity import STEP_S, floor_rad, moved_rig, retune, rms, sensitivity, severity, severity_left
from blind.effects.effect import Effect, Shape, Visited
from blind.rigs.bench import Bench, Logging, Plan, RigKind
from blind.simulation.ce150 import Rig
from blind.simulation.record import Loss, Model, Record

Array = NDArray[np.float64]
TRIALS = 5
STOP_SHARE = 0.1
ATTEMPTS = 20
LIVELY_FROM = 2  # what no quiet run shows is flown excited
CONTENT_FROM = 4  # and then taken as it comes


@dataclass(frozen=True)
class Injected:
    """An effect with its size and shape, and how severe it was alone on a short run."""

    effect: Effect
    m: float
    shape: Shape
    trial_severity: float


@dataclass(frozen=True, eq=False)
class Case:
    """Runs (training, hold-out last), how they are logged, what the plant file states otherwise, and the truth."""

    records: tuple[Record, ...]
    logging: Logging
    restated: Mapping[tuple[str, str], str]
    truth: Truth


def build_case(kind: RigKind, nominal: Rig, plan: Plan, seed: Sequence[int]) -> Case:
    """Draw until the rig stays off its stops and each effect has about its wanted severity; the same seed gives the same case."""
    for attempt in range(ATTEMPTS):
        rng = np.random.default_rng([*seed, attempt])
        if attempt == LIVELY_FROM and plan.effects:
            plan = replace(plan, excited=True)
        bench = kind.draw_bench(nominal, plan, rng)
        wanted = zip(plan.effects, plan.targets, strict=True)
        milder = 0.75 ** max(0, attempt - CONTENT_FROM)
        sized = [_sized(bench, effect, milder * target, rng, attempt) for effect, target in wanted]
        injected = [entry for entry in sized if entry is not None]
        if len(injected) < len(sized):
            continue
        loss = _loss(injected)
        flights = (bench.lab.flight(rng, loss, run) for run in range(bench.training + 1))
        records = tuple(_run(bench, injected, flight) for flight in flights)
        if all(_flown(record) for record in records) and _as_expected(bench, injected, records, attempt):
            return Case(records, bench.logging, bench.restated, _truth(bench, plan, injected, records))
    names = " + ".join(effect.name for effect in plan.effects)
    raise RuntimeError(f"no flyable draw of {names or 'a rig without effect'} in {ATTEMPTS} attempts")


def _model(bench: Bench, injected: Sequence[Injected], leave_out: int | None = None) -> Model:
    """The rig with its effects, less one of them, or less all (leave_out = -1)."""
    kept = [e for i, e in enumerate(injected) if leave_out is None or (leave_out >= 0 and i != leave_out)]
    settings: dict[tuple[str, int], float] = {}
    coulomb = {}
    for entry in kept:
        settings |= entry.effect.settings(entry.m, entry.shape)
        for axis, size in entry.effect.coulomb.items():
            coulomb[("b_cE", "b_cA")[axis]] = np.array([size * entry.m])
    lacks_sensor = any(e.effect.sensor and e not in kept for e in injected)
    loses = any(e.effect.loss > 0.0 for e in kept)
    return Model(bench.true.with_values(coulomb), settings, placed=lacks_sensor, loses=loses)


def _run(bench: Bench, injected: Sequence[Injected], flight: Any) -> Record:
    """Shadows: the rig itself, without any effect, then without each effect where there are several."""
    whole = _model(bench, injected)
    single = range(len(injected)) if len(injected) > 1 else ()
    shadows = [whole, _model(bench, injected, -1), *(_model(bench, injected, i) for i in single)]
    return bench.lab.fly(whole, shadows, flight)


def _flown(record: Record) -> bool:
    return not record.failed and record.stop_share <= STOP_SHARE


def _loss(injected: Sequence[Injected]) -> Loss:
    share = sum(min(entry.effect.loss * entry.m, 0.6) for entry in injected)
    return Loss(share, max((entry.shape.get("burst_frames", 1.0) for entry in injected), default=1.0))


def _as_expected(bench: Bench, injected: Sequence[Injected], records: Sequence[Record], attempt: int) -> bool:
    """Whether the whole runs came out about as severe as the trials: one hit on a stop can make an effect look huge."""
    if not injected:
        return True
    found = severity(bench.nominal, records[:-1], 1, _coarse(injected))
    expected = float(np.sqrt(sum(entry.trial_severity**2 for entry in injected)))
    return found <= 4.0 * expected and (found >= 0.25 * expected or attempt >= CONTENT_FROM)


def _coarse(injected: Sequence[Injected]) -> Array:
    """Encoder steps that the effects bring, by output in rad."""
    settings = [entry.effect.settings(entry.m, entry.shape) for entry in injected]
    return np.array([sum(s.get(("count_rad", axis), 0.0) for s in settings) for axis in range(2)])


def _sized(bench: Bench, effect: Effect, target: float, rng: Generator, attempt: int) -> Injected | None:
    """The effect with the size that gives about `target` alone on a short run; None when no size flies or comes near.

    Late attempts take the nearest there is: some effects cannot be severe in a quiet run.
    """
    shape = effect.draw(rng)
    trial_seed = int(rng.integers(2**32))
    low, high = effect.bounds
    m, best, miss = 1.0, None, np.inf
    for _ in range(TRIALS):
        entry = _tried(bench, effect, m, shape, trial_seed)
        if entry is None:
            high, m = m, max(low, 0.4 * m)
            continue
        ratio = max(entry.trial_severity, 1e-6) / target
        if abs(np.log(ratio)) < miss:
            best, miss = entry, abs(float(np.log(ratio)))
        top = high if high == effect.bounds[1] else 0.8 * high
        after = float(np.clip(m * np.clip(1.0 / ratio, 0.05, 20.0), low, top))
        if miss < 0.15 or after == m:
            break
        m = after
    return best if miss < np.log(2.0) or attempt >= CONTENT_FROM else None


def _tried(bench: Bench, effect: Effect, m: float, shape: Shape, seed: int) -> Injected | None:
    """The effect with its severity on a short run; None when the rig did not stay in its range."""
    entry = Injected(effect, m, shape, 0.0)
    record = _run(bench, [entry], bench.lab.flight(np.random.default_rng(seed), _loss([entry]), None))
    return (
        replace(entry, trial_severity=severity(bench.nominal, [record], 1, _coarse([entry])))
        if _flown(record)
        else None
    )


def _truth(bench: Bench, plan: Plan, injected: Sequence[Injected], records: Sequence[Record]) -> Truth:
    rig, train, hold, coarse = bench.nominal, records[:-1], records[-1], _coarse(injected)
    slopes = [sensitivity(bench.lab, bench.nominal, record) for record in train]
    visited = _visited(bench, train)
    shadows = [2 + i if len(injected) > 1 else 1 for i in range(len(injected))]
    alone = [severity(rig, train, k, _coarse([e])) for k, e in zip(shadows, injected, strict=True)]
    left = [severity_left(rig, train, slopes, k, _coarse([e])) for k, e in zip(shadows, injected, strict=True)]
    return Truth(
        kind=plan.kind,
        effects=tuple(_described(*entry, visited) for entry in zip(injected, alone, left, strict=True)),
        severity=severity(rig, train, 1, coarse) if injected else 0.0,
        severity_left=severity_left(rig, train, slopes, 1, coarse) if injected else 0.0,
        floor_rad=_by_output(floor_rad(rig, train)),
        hold=_hold(bench, train, hold, slopes),
        excited=plan.excited,
        rotor_speeds=plan.rotor_speeds,
        defects=("jitter",) if bench.lab.jitter else (),
    )


def _described(entry: Injected, size: float, left: float, visited: Visited) -> TrueEffect:
    effect = entry.effect
    return TrueEffect(
        name=effect.name,
        known=effect.known,
        places=effect.places,
        depends=effect.depends,
        severity=size,
        severity_left=left,
        parameters=dict(effect.equivalent(entry.m, entry.shape, visited)),
        twins=effect.twins,
        keywords=effect.keywords,
    )


def _hold(bench: Bench, train: Sequence[Record], hold: Record, slopes: Sequence[Array]) -> Hold:
    """The bars of the hold-out run; the re-tune is fitted on the training runs, re-linearised at its own answer."""
    floor = floor_rad(bench.nominal, train)
    predict = bench.lab.predict
    stated = predict(bench.nominal, hold, STEP_S)
    rig, total = bench.nominal, np.zeros(len(slopes[0]))
    for _ in range(3):
        gaps = [(record.y_rad - predict(rig, record, STEP_S))[:: record.thin] for record in train]
        linear = [gap + np.tensordot(total, slope, axes=1) for gap, slope in zip(gaps, slopes, strict=True)]
        total = retune(linear, slopes, floor)
        rig = moved_rig(bench.nominal, total)
    return Hold(
        rms_sensor=_by_output(rms(hold.y_rad - hold.exact_rad)),
        rms_true=_by_output(rms(hold.y_rad - hold.shadow[:, 0])),
        rms_nominal=_by_output(rms(hold.y_rad - stated)),
        rms_retuned=_by_output(rms(hold.y_rad - predict(rig, hold, STEP_S))),
    )


def _by_output(values: Array) -> dict[str, float]:
    return {"psi_rad": float(values[0]), "phi_rad": float(values[1])}


def _visited(bench: Bench, records: Sequence[Record]) -> Visited:
    apparent = np.concatenate([record.apparent for record in records])
    u = np.concatenate([record.u_V for record in records])
    thrust = np.polynomial.Polynomial(bench.true.values["p_FT"])
    return Visited(
        t_s=np.concatenate([record.t_s for record in records]),
        psi=apparent[:, 0],
        psi_dot=apparent[:, 1],
        phi=apparent[:, 2],
        phi_dot=apparent[:, 3],
        omega_M=apparent[:, 4],
        omega_T=apparent[:, 5],
        u_M=u[:, 0],
        u_T=u[:, 1],
        gravity_Nm=bench.true.value("tau_gE"),
        tail_thrust=lambda w: np.sign(w) * thrust(np.abs(w)),
        start_s=bench.logging.start_s,
    )
