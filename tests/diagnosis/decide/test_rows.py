"""Commands that stand a row or two late or early in a log are named; a plant that lacks something is not taken for a misplaced column."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis.decide.rows import EARLY, LATE, Misplaced, demand_rows, misplaced
from diagnosis.hypothesis.case import make_case
from diagnosis.library.effect_library import EffectLibrary, effect_library
from records.errors import BadInput
from records.log import RunLog
from sim.bind import BoundPlant
from tests.diagnosis.conftest import Fly
from tests.soak import sampled

SECONDS = 6.0
EFFECTS = [
    {"azimuth.cable_spring": {"k": 0.01, "angle_0": 0.2, "h": 0.0}},
    {"azimuth.coulomb": {"b": 0.004}},
    {"tail_rotor.reverse_asymmetry": {"r": 0.4}},
]


@pytest.fixture(scope="module")
def library(plant: BoundPlant) -> EffectLibrary:
    return effect_library(plant)


def logged(log: RunLog, slip: Misplaced) -> RunLog:
    """The log with commands as many rows late as `slip` says."""
    u, source = log.u.copy(), np.clip(np.arange(len(log.u)) - slip.rows, 0, len(log.u) - 1)
    for place in slip.inputs:
        u[:, place] = log.u[source, place]
    return replace(log, u=u)


@pytest.mark.parametrize(
    ("slip", "named"),
    [
        (Misplaced((0, 1), 1), "u_M_V and u_T_V stand one row late in the log"),
        (Misplaced((0,), 1), "u_M_V stands one row late in the log"),
        (Misplaced((1,), 2), "u_T_V stands two rows late in the log"),
        (Misplaced((0, 1), -1), "u_M_V and u_T_V stand one row early in the log, or the plant is so late"),
    ],
)
def test_commands_in_other_rows_are_refused_by_name(
    library: EffectLibrary, fly: Fly, slip: Misplaced, named: str
) -> None:
    case = make_case(library, [logged(fly(31, seconds=SECONDS), slip)])
    with pytest.raises(BadInput, match=named):
        demand_rows(case, "the logs to explain", (LATE, EARLY))


def test_commands_in_their_rows_are_not_doubted(library: EffectLibrary, fly: Fly) -> None:
    demand_rows(make_case(library, [fly(31, seconds=SECONDS)]), "the logs to explain", (LATE, EARLY))


@pytest.mark.parametrize(
    "effects", sampled(EFFECTS, keep=EFFECTS[2:]), ids=[next(iter(effects)) for effects in EFFECTS]
)
def test_a_plant_that_lacks_something_is_not_taken_for_commands_logged_late(
    library: EffectLibrary, fly: Fly, effects: dict[str, dict[str, float]]
) -> None:
    assert misplaced(make_case(library, [fly(32, effects, SECONDS)]), (LATE,)) is None
