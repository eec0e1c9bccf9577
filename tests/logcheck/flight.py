"""A flight of the compiled law as a rig would log it, what spoils one column of it, and what the log check finds."""

from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import numpy as np

from logcheck.integrity import Integrity, examine
from records.log import RunLog
from sim.simulate import Conditions, simulate
from tests.law_tables import ce150_table
from tests.replay.firmware_flights import flown, lively, plant
from verification.host_law import host_law

TURN_STEP_RAD = 2.0 * np.pi / 4096.0


@cache
def clean(duration_s: float = 20.0) -> RunLog:
    """A flight of the compiled law, with rotor speeds and rates as a rig would log them."""
    log = flown(host_law(ce150_table()), duration_s=duration_s)
    runs = simulate(plant(), log.t_s, lively(duration_s).x0, log.u, Conditions(keep="x"))
    assert runs.x is not None
    rng, states = np.random.default_rng(2), [str(state) for state in plant().model.states]
    measured = {name: runs.x[:, states.index(name)] for name in ("omega_M_rad_s", "omega_T_rad_s", "psi_dot_rad_s")}
    noisy = {name: np.round(values + rng.normal(0.0, 0.02, values.shape), 4) for name, values in measured.items()}
    return replace(log, extra={**log.extra, **noisy})


def other_flight() -> RunLog:
    """Another run of the same rig: the same manoeuvre with another law."""
    return flown(host_law(ce150_table(prefilter_time_constant_s=0.5)))


def examined(*logs: RunLog, holdout: Sequence[RunLog] = ()) -> Integrity:
    return examine(logs, plant(), holdout=holdout)


def kinds(found: Integrity, severity: str | None = None) -> set[str]:
    return {finding.kind for finding in found.findings if severity in (None, finding.severity)}


def with_column(log: RunLog, name: str, values: np.ndarray) -> RunLog:
    """The log with the column `name` replaced."""
    if name == "t_s":
        return replace(log, t_s=values)
    if name in log.extra:
        return replace(log, extra={**log.extra, name: values})
    block = "u" if name in log.columns.inputs else "y"
    names = log.columns.inputs if block == "u" else log.columns.outputs
    changed = getattr(log, block).copy()
    changed[:, names.index(name)] = values
    return replace(log, **{block: changed})  # type: ignore[arg-type]


def read_in(log: RunLog, column: str, step_rad: float, scale: float) -> RunLog:
    return with_column(log, column, np.round(log.column(column) / step_rad) * step_rad * scale)
