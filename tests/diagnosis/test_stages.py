"""Stages on the way of a reading: each kind has its rows, one without is no silence, and an effect needs no name to be found."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np
import pytest

import sim.effects
from diagnosis.detect.linearisation import linearised
from diagnosis.detect.score_tests import score_effects
from diagnosis.filter.filter_input import filter_input_of
from diagnosis.fit.free_numbers import free_numbers
from diagnosis.hypothesis.case import make_case
from diagnosis.library.effect_library import effect_library
from diagnosis.library.sensor_effects import READ_BACK, sensed
from diagnosis.validate.prediction import READ
from sim.added_effects import every_effect
from sim.bind import BoundPlant
from sim.effect import Effect, EffectParameter, Role
from sim.paths.output_stages import OutputSteps
from sim.paths.path import Trace
from tests.diagnosis.conftest import Fly
from tests.diagnosis.nominal import nominal_fit


@dataclass(frozen=True)
class Mirrored:
    """A stage that no diagnosis has heard of."""

    output: int
    order: ClassVar[int] = 9
    linear: ClassVar[bool] = True

    def __call__(self, signal: Trace, memory: Any) -> tuple[Trace, Any]:
        """See OutputStage; remembers nothing."""
        return Trace(signal.t_s, -signal.y, -signal.rate), None


def own_effect(name: str, symbol: str, role: Role, stage: Any) -> Effect:
    """What a file of one's own would give, as plain as it may be."""
    size = EffectParameter(symbol, "rad", 0.0, 0.2, 0.006, 0.0, role=role)
    return Effect(name, "reading", (size,), "y", "A story.", "a test", on_output=stage, smooth=False)


@pytest.fixture
def adding(monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[[Effect], None]]:
    """Make an effect known to every plant, by a row of the table."""

    def add(effect: Effect) -> None:
        monkeypatch.setattr(sim.effects, "FAMILIES", (*sim.effects.FAMILIES, lambda model: [effect]))
        sim.effects.effects_for.cache_clear()

    yield add
    monkeypatch.undo()
    sim.effects.effects_for.cache_clear()


def test_every_stage_of_the_library_has_its_rows() -> None:
    stages = [effect.on_output(effect.absent) for effect in every_effect() if effect.on_output is not None]
    kinds = {type(stage) for stage in stages}
    assert kinds == set(READ_BACK) == set(READ)


def test_a_stage_without_a_row_is_told_and_not_ignored(
    plant: BoundPlant, fly: Fly, adding: Callable[[Effect], None]
) -> None:
    adding(own_effect("psi_sensor.mirror", "m", Role.NUMBER, lambda values: Mirrored(0)))
    library = effect_library(plant)
    filter_input = filter_input_of(fly(3, seconds=2.0), plant.plant, library.outputs)
    with pytest.raises(
        NotImplementedError, match=r"READ_BACK of .*sensor_effects\.py has no row for the stage Mirrored"
    ):
        sensed(library, filter_input, {"psi_sensor.mirror": {"m": 0.1}})


def test_an_effect_of_one_s_own_is_found_by_its_roles(
    plant: BoundPlant, fly: Fly, adding: Callable[[Effect], None]
) -> None:
    # Truth: readings of psi on a grid of 11 mrad, under an effect whose name and symbol stand in no other file.
    grid_rad = 0.011
    coarse = own_effect("psi_sensor.lattice", "mesh", Role.STEP, lambda values: OutputSteps(0, values["mesh"]))
    adding(coarse)
    log = fly(3, seconds=10.0)
    y = log.y.copy()
    step = plant.plant.sensors["psi_rad"]
    y[:, 0] = step * np.round(grid_rad * np.round(y[:, 0] / grid_rad) / step)
    case = make_case(effect_library(plant), [replace(log, y=y)])
    nominal = nominal_fit(case)
    (found,) = score_effects(case, linearised(case, nominal), [coarse.name])
    assert found.values["mesh"] == pytest.approx(grid_rad, rel=2e-3)
    assert found.gain > 100.0
    assert free_numbers(case, nominal.hypothesis.with_effects({coarse.name: found.values})) == ()
