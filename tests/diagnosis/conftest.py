"""Flights of a CE150 that its own controller holds, with and without an effect; the same for all tests of the diagnosis."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from diagnosis.diagnose import Material, diagnose
from diagnosis.library.effect_library import EffectLibrary, effect_library
from diagnosis.result import Result
from records.log import RunLog
from records.plant import load_plant
from sim.added_effects import library, with_effects
from sim.bind import BoundPlant, bind
from sim.loop import closed_loop_log
from sim.simulate import Conditions, Noise, simulate
from tests.diagnosis.arm import arm, arm_log
from tests.plants import lively_table
from tests.soak import SOAK

Fly = Callable[..., RunLog]
LONG_S = 30.0  # of flights of which a number is asked that few rows do not tell; in a soak of all
SECONDS = LONG_S if SOAK else 20.0
RIG = 7
SPRUNG_SECONDS = 20.0 if SOAK else 16.0
# What many flights here have: a rig of one of them has all, the others at no size, so that one kernel flies them all.
AT_NO_SIZE: dict[str, Mapping[str, float]] = {
    "azimuth.cable_spring": {},
    "azimuth.coulomb": {},
    "azimuth.detent": {},
    "azimuth.tilt": {},
    "elevation.cable_spring": {},
    "elevation.periodic_torque": {},
    "elevation.quadratic_drag": {},
    "tail_rotor.reverse_asymmetry": {},
    "tail_rotor.warmup": {},
}
RUB: Mapping[str, Mapping[str, float]] = {"arm.coulomb": {"b": 4e-4}}
SPRING: Mapping[str, Mapping[str, float]] = {"azimuth.cable_spring": {"k": 0.004, "angle_0": 0.2, "h": 0.0}}


@pytest.fixture(scope="session")
def plant() -> BoundPlant:
    """The CE150 as stated."""
    return bind(load_plant(Path("plants/ce150.toml")))


def without_states(whole: EffectLibrary) -> EffectLibrary:
    """The library without effects that bring a state, which take longest to build."""
    kept = {name: effect for name, effect in whole.effects.items() if name not in whole.wide_names}
    return replace(whole, effects=kept, wide_names=())


@pytest.fixture(scope="session")
def stateless(plant: BoundPlant) -> EffectLibrary:
    """That of the CE150, whose whole filter takes ten seconds to build."""
    return without_states(effect_library(plant))


@pytest.fixture(scope="session")
def fly(plant: BoundPlant) -> Fly:
    """fly(seed, effects): a run of SECONDS about level under lively references, with turbulence and parameters of `seed`.

    With a `rig_seed` the parameters are that rig's, the same in every run; without `air` nothing pushes at random;
    `jumps_rad` make the references jump so far every 50 ms, and `gusts` are how many times the usual the air pushes;
    axes that are `locked` are held.
    """
    table, known = lively_table(), library(plant)

    def flown(
        seed: int,
        effects: Mapping[str, Mapping[str, float]] | None = None,
        seconds: float = SECONDS,
        factors: Mapping[str, float] | None = None,
        rig_seed: int | None = None,
        air: bool = True,
        jumps_rad: float = 0.0,
        gusts: float = 1.0,
        locked: tuple[str, ...] = (),
    ) -> RunLog:
        rng = np.random.default_rng(seed)
        t_s = np.arange(0.0, seconds, 0.01)
        waves = rng.uniform(0.1, 0.9, (2, 4))
        phases = rng.uniform(0.0, 6.0, (2, 4))
        reach = np.array([0.6, 1.2])
        swing = np.sin(2 * np.pi * waves[:, :, None] * t_s + phases[:, :, None]).mean(axis=1) * reach[:, None]
        reference = (swing - swing[:, :1]).T
        if jumps_rad:
            reference = (
                reference + jumps_rad * rng.choice([-1.0, 1.0], (len(t_s) // 5 + 1, 2)).repeat(5, axis=0)[: len(t_s)]
            )
        moving = {name for name in effects or () if known[name].on_equations}
        shared = AT_NO_SIZE if moving and moving <= AT_NO_SIZE.keys() else {}
        rig = with_effects(plant, {**shared, **effects}) if effects else plant
        p = rig.p.copy()
        own = len(plant.p)
        own_rng = rng if rig_seed is None else np.random.default_rng(rig_seed)
        p[:own] += 0.5 * plant.sd * own_rng.standard_normal(own)
        names = [str(symbol) for symbol in plant.model.parameter_symbols]
        for name, factor in (factors or {}).items():
            p[names.index(name)] = factor * plant.p[names.index(name)]
        x0 = np.array([470.0, *(0.0, 0.0), 150.0, *(0.0, 0.0)])
        noise = Noise(seed, process_sd=[0.0, 0.0, 1e-3 * gusts, 0.0, 0.0, 1e-3 * gusts]) if air else None
        run = simulate(rig, t_s, x0, table, Conditions(reference=reference, p=p, noise=noise, keep="uy", locked=locked))
        manoeuvre = _Flown(t_s, reference)
        return replace(closed_loop_log(plant, manoeuvre, run.u, run.y, None), extra={}, locked=locked)  # type: ignore[arg-type]

    return flown


@pytest.fixture(scope="session")
def rubbed() -> Result:
    """What the diagnosis makes of an arm that rubs and whose plant file knows no friction, from one run with another held out."""
    logs = [arm_log(RUB, seed=seed) for seed in (11, 12)]
    return diagnose(arm(), Material(logs[:1], logs[1:], ["hold"], [None, None]))


@pytest.fixture(scope="session")
def sprung(plant: BoundPlant, fly: Fly) -> Result:
    """What the diagnosis makes of a rig with a spring on its azimuth, from one flight with another held out."""
    logs = [fly(seed, SPRING, SPRUNG_SECONDS, rig_seed=RIG) for seed in (11, 12)]
    return diagnose(plant, Material(logs[:1], logs[1:], ["hold"], [None, None]))


class _Flown:
    """What closed_loop_log asks of a manoeuvre."""

    def __init__(self, t_s: np.ndarray, reference_rad: np.ndarray) -> None:
        self.t_s, self.reference_rad = t_s, reference_rad
