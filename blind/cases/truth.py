"""What is true of a flown case: severities, parameters in the library's words, what predictions of its hold-out run leave."""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from blind.cases.injection import Injected, coarse_rad
from blind.cases.sealed import Hold, TrueEffect, Truth
from blind.cases.severity import (
    PREDICTION_STEP_S,
    floor_rad,
    moved_rig,
    retune,
    rms,
    sensitivity,
    severity,
    severity_left,
)
from blind.effects.visited import Visited
from blind.rigs.bench import Bench, Plan
from blind.simulation.ce150 import Rig
from blind.simulation.record import Record
from blind.simulation.rest import rotor_thrust

Array = NDArray[np.float64]
LOST_RAD = 1e3  # no rig turns so far within a second


def truth_of(bench: Bench, plan: Plan, injected: Sequence[Injected], records: Sequence[Record]) -> Truth:
    """The truth of a case; the last of its records is the hold-out run."""
    rig, train = bench.nominal, records[:-1]
    outputs, coarse = bench.columns.outputs, coarse_rad(injected, len(bench.columns.outputs))
    own = [coarse_rad([entry], len(outputs)) for entry in injected]
    slopes = [sensitivity(bench.lab, rig, record) for record in train]
    visited = _visited(bench, train)
    shadows = [2 + i if len(injected) > 1 else 1 for i in range(len(injected))]
    alone = [severity(rig, train, k, steps) for k, steps in zip(shadows, own, strict=True)]
    left = [severity_left(rig, train, slopes, k, steps) for k, steps in zip(shadows, own, strict=True)]
    return Truth(
        kind=plan.kind,
        effects=tuple(_described(*entry, visited) for entry in zip(injected, alone, left, strict=True)),
        severity=severity(rig, train, 1, coarse) if injected else 0.0,
        severity_left=severity_left(rig, train, slopes, 1, coarse) if injected else 0.0,
        floor_rad=_by_output(floor_rad(rig, train), outputs),
        hold=_hold(bench, records, slopes),
        excited=plan.excited,
        rotor_speeds=plan.rotor_speeds and bool(bench.columns.speeds),
        defects=(*(("jitter",) if bench.lab.jitter else ()), *bench.faults),
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


def _hold(bench: Bench, records: Sequence[Record], slopes: Sequence[Array]) -> Hold:
    """What predictions of the hold-out run leave; the re-tune is fitted on the training runs."""
    hold, names = records[-1], bench.columns.outputs
    stated = bench.lab.predict(bench.nominal, hold, PREDICTION_STEP_S)
    retuned = bench.lab.predict(_retuned(bench, records[:-1], slopes), hold, PREDICTION_STEP_S)
    return Hold(
        rms_sensor=_by_output(rms(hold.y_rad - hold.exact_rad), names),
        rms_true=_by_output(rms(hold.y_rad - hold.shadow[:, 0]), names),
        rms_nominal=_by_output(rms(hold.y_rad - stated), names),
        rms_retuned=_by_output(rms(hold.y_rad - (stated if _lost([retuned]) else retuned)), names),
    )


def _retuned(bench: Bench, train: Sequence[Record], slopes: Sequence[Array]) -> Rig:
    """Re-linearised at its own answer; a step of many spreads that leads to a rig which no longer flies is taken back."""
    floor = floor_rad(bench.nominal, train)
    before = rig = bench.nominal
    total = np.zeros(len(slopes[0]))
    for _ in range(3):
        predicted = [bench.lab.predict(rig, record, PREDICTION_STEP_S) for record in train]
        if _lost(predicted):
            return before
        gaps = [(record.y_rad - run)[:: record.thin] for record, run in zip(train, predicted, strict=True)]
        linear = [gap + np.tensordot(total, slope, axes=1) for gap, slope in zip(gaps, slopes, strict=True)]
        total = retune(linear, slopes, floor)
        before, rig = rig, moved_rig(bench.nominal, total)
    return rig


def _lost(predicted: Sequence[Array]) -> bool:
    """Whether a prediction left every range."""
    return not all(np.all(np.abs(run) < LOST_RAD) for run in predicted)


def _by_output(values: Array, names: Sequence[str]) -> dict[str, float]:
    return dict(zip(names, map(float, values), strict=True))


def _visited(bench: Bench, records: Sequence[Record]) -> Visited:
    psi, psi_dot, phi, phi_dot, omega_M, omega_T = np.concatenate([record.apparent for record in records]).T
    u = np.concatenate([record.u_V for record in records])
    tail = _tail_thrust(bench)
    return Visited(
        t_s=np.concatenate([record.t_s for record in records]),
        psi=psi,
        psi_dot=psi_dot,
        phi=phi,
        phi_dot=phi_dot,
        omega_M=omega_M,
        omega_T=omega_T,
        u_M=u[:, 0],
        u_T=u[:, -1] if u.shape[1] > 1 else np.zeros(len(u)),
        gravity_Nm=bench.gravity_Nm,
        tail_thrust=tail,
        start_s=bench.logging.start_s,
    )


def _tail_thrust(bench: Bench) -> Callable[[Array], Array]:
    """rad/s -> N; nothing where the plant has no such rotor."""
    if "p_FT" not in bench.true.values:
        return np.zeros_like
    tail = rotor_thrust(bench.true, "T")
    return lambda w: np.asarray(np.sign(w) * tail(np.abs(w)))
