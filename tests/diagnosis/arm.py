"""An arm with one propeller, whose equations are the smallest: logs and cases for tests of single modules."""

from collections.abc import Mapping
from functools import cache

import numpy as np

from diagnosis.detect.linearisation import Linearisation, linearised
from diagnosis.fit import nominal
from diagnosis.fit.evidence import FittedHypothesis, as_fitted
from diagnosis.hypothesis.case import Case, make_case
from diagnosis.hypothesis.hypothesis import nominal_hypothesis
from diagnosis.library.effect_library import effect_library
from records.log import RunLog
from sim.added_effects import library, with_effects
from sim.bind import BoundPlant
from sim.columns import log_columns
from sim.simulate import Conditions, Noise, simulate
from tests.diagnosis.nominal import nominal_fit
from tests.plants import bound
from tests.soak import SOAK

PERIOD_S = 0.01
KICKED_S = 1.0
LONG_S = 20.0  # of runs of which a number is asked that few rows do not tell; in a soak of all
SECONDS = LONG_S if SOAK else 14.0
# What many runs here have: an arm of one of them has all, the others at no size, so that one kernel flies them all.
AT_NO_SIZE: dict[str, Mapping[str, float]] = {
    "arm.cable_spring": {},
    "arm.coulomb": {},
    "arm.disturbance": {},
    "input.saturation": {},
    "rotor.warmup": {},
}


@cache
def arm() -> BoundPlant:
    """The AeroShield with parameters that are known well."""
    return bound("aeroshield")


def arm_log(
    effects: Mapping[str, Mapping[str, float]] | None = None,
    seed: int = 1,
    seconds: float = SECONDS,
    rows: int = 1,
    kick_V: float = 0.0,
    begins_s: float = 0.0,
    **changed: float,
) -> RunLog:
    """A run in open loop under five sines of the input, held for so many rows each; nothing but the encoder and a little torque noise
    disturbs it. The rig is as stated but for the parameters `changed`; each second one command is larger by `kick_V`;
    there is none before `begins_s`."""
    rng = np.random.default_rng(seed)
    t_s = PERIOD_S * np.arange(round(seconds / PERIOD_S))
    rates, phases = rng.uniform(0.5, 6.0, 5), rng.uniform(0.0, 2.0 * np.pi, 5)
    u = 1.8 + 0.28 * np.sin(np.outer(t_s, rates) + phases).sum(axis=1)
    u = np.repeat(u[::rows], rows)[: len(t_s)]
    u[:: round(KICKED_S / PERIOD_S)] += kick_V
    u[t_s < begins_s] = 0.0
    plain = bound("aeroshield", **changed) if changed else arm()
    moving = {name for name in effects or () if library(arm())[name].on_equations}
    shared = AT_NO_SIZE if moving and moving <= AT_NO_SIZE.keys() else {}
    rig = with_effects(plain, {**shared, **effects}) if effects else plain
    process = np.zeros(len(rig.model.states))
    process[1] = 0.01
    run = simulate(rig, t_s, np.zeros(2), u[:, None], Conditions(noise=Noise(seed, process_sd=process), keep="y"))
    y = np.asarray(run.y).reshape(len(t_s), -1)
    return RunLog(log_columns(arm().model), PERIOD_S, "open", t_s, u[:, None], y)


def arm_case(*logs: RunLog) -> Case:
    """A case of the arm with these logs."""
    return make_case(effect_library(arm()), list(logs))


@cache
def plain_linearisation() -> Linearisation:
    """The fit of a run without any effect, as score tests are taken from it."""
    case = arm_case(arm_log(seconds=LONG_S))
    return linearised(case, nominal_fit(case))


def settled(case: Case, effects: dict[str, dict[str, float]]) -> FittedHypothesis:
    """A fit of effects with the white noise that then remains."""
    return as_fitted(case, nominal.settled(case, nominal_hypothesis(case, -1.5).with_effects(effects)))
