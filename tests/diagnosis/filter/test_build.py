"""A filter that is compiled with a plant's equations knows their sizes; the same equations are compiled once."""

import numpy as np
import pytest

from diagnosis.filter.build import build_filter, equations_text, open_filter
from diagnosis.filter.filter_input import filter_input_of
from diagnosis.filter.kalman import FilterNoise, Wanted
from records.log import RunLog
from sim.columns import log_columns
from tests.diagnosis.arm import arm


def test_the_filter_of_a_plant_alone_keeps_it_where_it_rests() -> None:
    # Truth: an arm that hangs down without input stays there, to 1e-12 rad, and no reading of that says otherwise.
    plant = arm()
    path = build_filter(plant.model.name, equations_text(plant.model))
    assert build_filter(plant.model.name, equations_text(plant.model)) == path
    axes = tuple(axis.name for axis in plant.model.axes)
    states = len(plant.model.states)
    compiled = open_filter(path, {"states": states, "outputs": 1}, axes)
    t_s = 0.01 * np.arange(100)
    log = RunLog(log_columns(plant.model), 0.01, "open", t_s, np.zeros((100, 1)), np.zeros((100, 1)))
    noise = FilterNoise(
        np.full(states, 1e-6), np.zeros(1), np.full(states, 1e-4), np.zeros(states), np.zeros(states), 0.01
    )
    given = filter_input_of(log, plant.plant, tuple(map(str, plant.model.outputs)), None)
    run = compiled.run(given, plant.p, np.zeros(states), noise, Wanted([0]))
    assert run is not None
    assert run.x.shape == (100, states)
    assert run.x == pytest.approx(np.zeros((100, states)), abs=1e-12)
