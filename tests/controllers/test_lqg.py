"""The LQG: its model is the sampled plant, its loops are stable at every operating point, and what is missing is found."""

from typing import Any

import numpy as np
import pytest

from controllers.equations.designing import points_of
from controllers.lqg_gains import WEIGHTS, gains_at, sampled
from design.settings import read_settings
from records.table import AXES, changed_axis
from sim.loop import fly
from sim.manoeuvres import Leg, Manoeuvre, hop, manoeuvre
from sim.simulate import simulate
from tests.controllers.rows import ce150, designed
from tests.plants import bound
from verification.comparison.conditions import spread
from verification.comparison.manoeuvres import FIGURES
from verification.comparison.measures import Merit, merit
from verification.flown_law import FlownLaw


def test_the_model_is_the_plant_sampled_by_python_control() -> None:
    # Truth: m' = 7 (u - m), x'' = 9 m - 0.4 v + 2 x from rest at x = 0, sampled with a zero-order hold by python-control.
    import control  # a second and a half of modules, which one worker alone is to load

    lag, k, a, b = 7.0, 9.0, 2.0, 0.4
    system = control.ss([[-lag, 0, 0], [0, 0, 1], [k, a, -b]], [[lag], [0], [0]], np.eye(3), np.zeros((3, 1)))
    truth = control.sample_system(system, 0.01, method="zoh")
    model = sampled(lag, k, a, b, 0.01)
    m, v, u = 0.3, -0.2, 1.1
    after = truth.A @ [m, 0.0, v] + truth.B[:, 0] * u
    x = model["beta_p"] * m + model["beta_v"] * v + model["beta_u"] * (u - m)
    rate = v + model["gamma_p"] * m + model["gamma_v"] * v + model["gamma_u"] * (u - m)
    assert [m + model["alpha"] * (u - m), x, rate] == pytest.approx(after, rel=1e-12)


@pytest.mark.parametrize("axis", AXES)
def test_regulator_and_filter_are_stable_at_every_operating_point(axis: str) -> None:
    points = points_of(ce150(), read_settings(ce150()))
    for plant in points.behind_one_lag(axis):
        c = gains_at(plant, WEIGHTS[axis], 0.01, 1.534e-3)
        lag, a = -plant.A[0, 0], plant.A[2, 1]
        k = plant.A[2, 0] * plant.B[0, 0] / lag
        angle = [1.0 + c["beta_p"] * a / k, c["beta_v"], c["beta_p"]]
        rate = [c["gamma_p"] * a / k, 1.0 + c["gamma_v"], c["gamma_p"]]
        body = np.array([angle, rate, [0.0, 0.0, 1.0]])
        seen = body @ (np.eye(3) - np.outer([c["l_x"], c["l_v"], c["l_d"]], [1.0, 0.0, 0.0]))
        assert np.max(np.abs(np.linalg.eigvals(seen))) < 1.0


def test_a_weaker_rotor_and_more_weight_leave_no_steady_error() -> None:
    # Truth: 0.1 deg, about one encoder step, with 10 % less voltage gain and 5 % more weight than designed for.
    row, table = designed("lqg")
    other = bound("ce150", K_M=0.9 * 363.0, tau_gE=1.05 * 0.0383)
    still = manoeuvre("still", hop(other).x0, 15.0, 0.01, ((Leg(0.0, -10.0), Leg(5.0, 5.0)), (Leg(0.0, 0.0),)))
    log = fly(other, row.float_law(table), still)
    error_deg = np.degrees(still.reference_rad - log.y)[-200:]
    assert np.max(np.abs(np.mean(error_deg, axis=0))) < 0.1


def test_on_fresh_spread_plants_it_is_faster_than_the_scheduled_law_behind_any_filter_that_does_not_overshoot() -> None:
    # Truth: the manoeuvre of Fig. 23, ten plants of a seed that nothing was tuned on; both overshoot by at most 5 % of a step.
    plan = FIGURES["fig-23"].manoeuvre(ce150(), 0.01)
    plants = spread(ce150(), 10, 4711)
    lqg = _merits(designed("lqg")[1], "lqg", plan, plants)
    assert max(entry.overshoot for entry in lqg) < 0.05
    table = designed("scheduled")[1]
    for share in (1.0, 0.75):
        filtered = changed_axis(
            table, "elevation", prefilter_time_constant_s=share * table.axes[0].prefilter_time_constant_s
        )
        other = _merits(filtered, "scheduled", plan, plants)
        assert np.median([entry.iae_rad_s for entry in lqg]) < 0.75 * np.median([entry.iae_rad_s for entry in other])


def _merits(table: Any, name: str, plan: Manoeuvre, plants: Any) -> list[Merit]:
    """The elevation's merits on each plant."""
    law = FlownLaw(designed(name)[0].generate(table))
    found = []
    for p in plants:
        drive = law.controller(plan.t_s.size)
        runs = simulate(ce150(), plan.t_s, plan.x0, drive, reference=plan.reference_rad, p=p)
        found.append(merit(plan.t_s, plan.reference_rad, runs.y, runs.u, 0))
    return found
