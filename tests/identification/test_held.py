"""What an interval leaves out is told: parameters that were held at values which the plant file does not know exactly."""

from dataclasses import replace

import numpy as np
import pytest

from identification.fit.belief import NOTHING, stated
from identification.results.held import leaning
from identification.results.notes import leaning_notes
from identification.stages.staged import AskedOfStage, identify_stage


@pytest.fixture(scope="module")
def swing(experiments):
    return experiments["elevation_swing"]


def test_an_inertia_leans_on_the_gravity_torque_that_was_held(bound, swing):
    """Truth: the swing tells J_E / tau_gE; with tau_gE one sd higher a fit of its own finds J_E higher by `by`, to one in fifty."""
    names = ("J_E", "b_vE", "b_cE")
    fit = identify_stage(bound, swing, NOTHING, AskedOfStage(free=names)).result
    found = {entry.name: entry for entry in leaning(bound, fit)}
    assert found["J_E"].held == ("tau_gE",)
    place = [str(symbol) for symbol in bound.model.parameter_symbols].index("tau_gE")
    p = bound.p.copy()
    p[place] += bound.sd[place]
    moved = identify_stage(replace(bound, p=p), swing, NOTHING, AskedOfStage(free=names)).result
    assert moved.belief.value("J_E") - fit.belief.value("J_E") == pytest.approx(found["J_E"].by, rel=0.02)
    (note,) = leaning_notes("swing", list(found.values()))
    assert note.startswith("swing: the intervals take tau_gE as exact; by the sd in the plant file J_E may be off by ")
    assert " kg m^2, " in note


def test_what_counts_as_data_is_not_held(bound, swing):
    """With the plant file's knowledge in the fit nothing is taken as exact."""
    fit = identify_stage(bound, swing, stated(bound)).result
    assert leaning(bound, fit) == ()
    assert leaning_notes("swing", ()) == ()
    assert np.all(fit.belief.sd > 0.0)
