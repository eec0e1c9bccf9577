"""What `identify` hands on to `diagnose`: sd and correlation are those by which a rig is judged."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis.diagnose import Material, diagnose
from diagnosis.fit.nominal import plain_fit
from diagnosis.hypothesis.case import make_case
from diagnosis.library.effect_library import effect_library
from identification.results.result import identification
from identification.runs.run import coefficient_names
from sim.bind import bind
from sim.equilibrium import equilibrium
from sim.loop import closed_loop_log
from sim.manoeuvres import Manoeuvre
from sim.simulate import Conditions, simulate

T_S = 0.01 * np.arange(500)


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


def flight_of(plant, table, moved):
    """Five seconds of a rig that is the plant with coefficients moved by so many of their own standard deviations."""
    p, names = plant.p.copy(), coefficient_names(plant.model)
    for name, by in moved.items():
        p[names.index(name)] += by * plant.sd[names.index(name)]
    reference = (
        np.column_stack([0.3 * np.sin(1.3 * T_S), 0.5 * np.sin(0.9 * T_S)]) * np.minimum(1.0, T_S / 2.0)[:, None]
    )
    flight = Manoeuvre("m", T_S, reference, equilibrium(plant, 0.0).x0)
    run = simulate(plant, T_S, flight.x0, table, Conditions(reference=reference, p=p, keep="uy"))
    return closed_loop_log(plant, flight, run.u, run.y, None)


def turned(identified, thrust, table, direction):
    """The flight of a rig none of whose thrust coefficients is more than one sd off: 0 against their correlation, -1 along it."""
    names, vectors = thrust
    along = vectors[:, direction] / np.abs(vectors[:, direction]).max()
    return flight_of(identified, table, dict(zip(names, along, strict=True)))


def without_correlation(identified):
    return bind(replace(identified.plant, correlation=None))


def log_posterior(plant, log):
    """Of the plant's own parameters alone, at their best."""
    return plain_fit(make_case(effect_library(plant), [log])).log_posterior


def test_a_rig_within_every_sd_is_judged_by_the_correlation(identified, thrust, table):
    """Truth: along the correlation the thrust is as known; against it, it is off far beyond, and no likely parameters explain the flight.

    Without the correlation the second is as good as the first, as each coefficient may move by itself.
    """
    for direction, least, most in ((-1, -5.0, 5.0), (0, 50.0, np.inf)):
        log = turned(identified, thrust, table, direction)
        lost = log_posterior(without_correlation(identified), log) - log_posterior(identified, log)
        assert least < lost < most


@pytest.mark.soak
@pytest.mark.parametrize(("direction", "expected"), [(-1, "no gap"), (0, "gap")])
def test_the_whole_diagnosis_says_so(identified, thrust, table, direction, expected):
    log = turned(identified, thrust, table, direction)

    def verdict(plant):
        return diagnose(plant, Material([log], [], [], [None], names=["flight"])).diagnosis.verdict

    assert verdict(identified) == expected
    assert verdict(without_correlation(identified)) == "no gap"
