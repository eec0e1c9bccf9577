"""A plant flown through the filters' own equations moves as the simulation's plant does: same RK4 step, same events, to the count."""

from collections.abc import Mapping

import numpy as np
import pytest

from diagnosis.hypothesis.case import Case, make_case
from diagnosis.hypothesis.hypothesis import Hypothesis, nominal_hypothesis
from diagnosis.library.effect_library import effect_library
from diagnosis.validate.simulated import Flown
from sim.added_effects import with_effects
from sim.bind import BoundPlant
from sim.equilibrium import equilibrium
from sim.runs.stepped import SteppedPlant
from tests.diagnosis.conftest import Fly
from tests.law_tables import ce150_table
from verification.host_law import HostLaw, host_law

STEP_RAD = 2.0 * np.pi / 4096.0


@pytest.fixture(scope="module")
def case(plant: BoundPlant, fly: Fly) -> Case:
    return make_case(effect_library(plant), [fly(3, seconds=2.0)])


@pytest.fixture(scope="module")
def law() -> HostLaw:
    return host_law(ce150_table())


def readings(law: HostLaw, rig: Flown | SteppedPlant, samples: int = 500) -> np.ndarray:
    """Angles read in a closed loop along two slow waves."""
    t_s = 0.01 * np.arange(samples)
    reference = np.column_stack([0.3 * np.sin(1.5 * t_s), 0.8 * np.sin(t_s)])
    found = np.empty((samples, 2))
    law.reset(*map(float, rig.measured()))
    for k in range(samples):
        found[k] = rig.measured()
        rig.advance(np.array(law.step(*reference[k].tolist(), *found[k].tolist())), t_s[k] + 0.01)  # type: ignore[arg-type]
    return found


@pytest.mark.parametrize(
    "effects",
    [
        {},
        {"azimuth.cable_spring": {"k": 0.003, "angle_0": 0.1, "h": 0.0}},
        {"main_input.delay": {"tau": 0.013}, "psi_sensor.delay": {"tau": 0.033, "jitter": 0.0}},
    ],
)
def test_it_moves_as_the_simulation_does(
    plant: BoundPlant, case: Case, law: HostLaw, effects: Mapping[str, Mapping[str, float]]
) -> None:
    # The other effects of a variant's equations stand a billionth away from nothing: at most a count may round otherwise.
    x0 = equilibrium(plant, 0.0).x0
    own = readings(law, Flown(case, _hypothesis(case, effects), x0))
    simulated = readings(law, SteppedPlant(with_effects(plant, effects) if effects else plant, x0))
    assert np.ptp(simulated[:, 1]) > 0.5
    assert np.abs(own - simulated).max() <= 1.01 * STEP_RAD


def test_a_lagging_sensor_begins_where_the_arm_is(plant: BoundPlant, case: Case) -> None:
    # Else its first readings would be those of a jump that nothing made, by which it could be told from a delay.
    x0 = equilibrium(plant, 0.3).x0
    rig = Flown(case, _hypothesis(case, {"psi_sensor.lag": {"tau": 0.1}}), x0)
    assert rig.measured()[0] == pytest.approx(0.3, abs=STEP_RAD)


def test_process_noise_shakes_by_its_seed_and_locks_hold(plant: BoundPlant, case: Case, law: HostLaw) -> None:
    x0 = equilibrium(plant, 0.0).x0
    restless = nominal_hypothesis(case, -1.0)
    one, same, other = (readings(law, Flown(case, restless, x0, seed=seed), 200) for seed in (1, 1, 2))
    assert np.array_equal(one, same)
    assert not np.array_equal(one, other)
    held = readings(law, Flown(case, restless, x0, locked=("elevation",), seed=1), 200)
    assert np.all(held[:, 0] == 0.0)
    assert np.ptp(held[:, 1]) > 0.0


def test_a_delay_scatters_by_the_seed_and_not_at_all_on_average(plant: BoundPlant, case: Case, law: HostLaw) -> None:
    x0 = equilibrium(plant, 0.0).x0
    steady, unsteady = (
        _hypothesis(case, {"phi_sensor.delay": {"tau": 0.033, "jitter": jitter_s}}) for jitter_s in (0.0, 0.005)
    )
    assert np.array_equal(readings(law, Flown(case, unsteady, x0)), readings(law, Flown(case, steady, x0)))
    shaken = [readings(law, Flown(case, hypothesis, x0, seed=1)) for hypothesis in (steady, unsteady)]
    assert not np.array_equal(*shaken)


def test_what_leaves_all_bounds_is_lost(plant: BoundPlant, case: Case) -> None:
    x0 = equilibrium(plant, 0.0).x0
    x0[0] = 2e9
    rig = Flown(case, nominal_hypothesis(case, -3.0), x0)
    rig.advance(np.zeros(2), 0.01)
    assert rig.lost
    assert not np.isfinite(rig.measured()).all()


def _hypothesis(case: Case, effects: Mapping[str, Mapping[str, float]]) -> Hypothesis:
    return nominal_hypothesis(case, -3.0).with_effects(effects)
