"""What `identify` hands on to `diagnose`: sd and correlation are those by which a rig is judged."""

from dataclasses import replace

import numpy as np
import pytest

from design.settings import read_settings
from design.table import design
from diagnosis.diagnose import Material, diagnose
from identification.results.result import identification
from identification.runs.run import coefficient_names
from sim.bind import bind
from sim.equilibrium import equilibrium
from sim.loop import closed_loop_log
from sim.manoeuvres import Manoeuvre
from sim.simulate import simulate

T_S = 0.01 * np.arange(1000)


@pytest.fixture(scope="module")
def identified(bound, stages):
    return bind(identification(bound.plant, [(stage.kind, stage.result) for stage in stages], stages[-1].belief).plant)


@pytest.fixture(scope="module")
def thrust(identified):
    """The main rotor's thrust polynomial: its coefficients, and the directions of their correlation, the best known one first."""
    names = tuple(name for name in identified.plant.correlation.names if name.startswith("p_FM"))
    values, vectors = np.linalg.eigh(identified.plant.correlation.spread_over(names))
    assert values[0] < 1e-3 < 3.0 < values[-1]
    return names, vectors


def flown(plant, moved):
    """Ten seconds of a rig that is the plant with coefficients moved by so many of their own standard deviations."""
    p, names = plant.p.copy(), coefficient_names(plant.model)
    for name, by in moved.items():
        p[names.index(name)] += by * plant.sd[names.index(name)]
    table, _ = design(plant, read_settings(plant))
    reference = (
        np.column_stack([0.3 * np.sin(1.3 * T_S), 0.5 * np.sin(0.9 * T_S)]) * np.minimum(1.0, T_S / 2.0)[:, None]
    )
    flight = Manoeuvre("m", T_S, reference, equilibrium(plant, 0.0).x0)
    run = simulate(plant, T_S, flight.x0, table, reference=reference, p=p, keep="uy")
    return closed_loop_log(plant, flight, run.u, run.y, None)


def verdict(plant, log):
    return diagnose(plant, Material([log], [], [], [None], names=["flight"])).diagnosis.verdict


@pytest.mark.parametrize(("direction", "expected"), [(-1, "no gap"), (0, "gap")])
def test_a_rig_within_every_sd_is_judged_by_the_correlation(identified, thrust, direction, expected):
    """Truth: no coefficient is more than one sd off. Along the correlation the thrust is as known; against it, it is off far beyond.

    Without the correlation the second would be as good as the first, as each coefficient may move by itself.
    """
    names, vectors = thrust
    along = vectors[:, direction] / np.abs(vectors[:, direction]).max()
    log = flown(identified, dict(zip(names, along, strict=True)))
    assert verdict(identified, log) == expected
    assert verdict(bind(replace(identified.plant, correlation=None)), log) == "no gap"
