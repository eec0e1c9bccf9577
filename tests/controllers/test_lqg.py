"""The LQG: its model is the sampled plant, its poles are as fast as asked for, and what is missing is found."""

from typing import Any

import numpy as np
import pytest

from controllers.coupled import coupled_poles, coupled_sensitivity
from controllers.lqg_gains import Gains, Speeds, gains_at
from controllers.lqg_loop import controller_at, open_loop
from design.discretise import sample
from design.linear_plant import LinearPlant
from design.loop import PlantPolynomials, closed_loop_poles, plant_polynomials
from records.table import changed_axis
from sim.loop import fly
from sim.manoeuvres import Leg, Manoeuvre, hop, manoeuvre
from sim.simulate import Conditions, simulate
from tests.controllers.rows import ce150, designed
from tests.plants import bound
from verification.comparison.conditions import spread
from verification.comparison.manoeuvres import FIGURES
from verification.comparison.measures import Merit, merit
from verification.flown_law import FlownLaw

# Unstable, integrating, slow and swinging, of one to five states.
A_OF = {
    "one slow state": [[-0.02]],
    "double integrator": [[0.0, 1.0], [0.0, 0.0]],
    "inverted arm": [[0.0, 1.0], [20.0, -0.5]],
    "rotor and arm": [[0.0, 1.0, 0.0], [2.0, -0.4, 9.0], [0.0, 0.0, -7.0]],
    "two elastic masses": [
        [0.0, 1.0, 0.0, 0.0, 0.0], [-300.0, -1.0, 300.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0, 0.0],
        [300.0, 0.0, -300.0, -1.0, 5.0], [0.0, 0.0, 0.0, 0.0, -40.0],
    ],
}  # fmt: skip
SPEEDS = Speeds(3.5, 20.0)
TS_S = 0.005


def plant(name: str) -> tuple[LinearPlant, PlantPolynomials]:
    """The last state is driven, the first one measured."""
    A = np.array(A_OF[name])
    order = len(A)
    linear = LinearPlant(A, np.eye(order)[:, -1:] * 3.0, np.eye(order)[:1])
    return linear, plant_polynomials(sample(linear, TS_S))


@pytest.mark.parametrize("name", A_OF)
def test_the_model_in_moves_is_the_plant_sampled_by_python_control(name: str) -> None:
    # Truth: forty samples of the output under steps of the input from rest, by python-control; (C.13) with no measurement, to 1e-9.
    import control  # a second and a half of modules, which one worker alone is to load

    linear, polynomials = plant(name)
    gains = gains_at(polynomials, SPEEDS)
    u = np.repeat(np.random.default_rng(5).normal(size=8), 5)
    system = control.sample_system(control.ss(linear.A, linear.B, linear.C, 0.0), TS_S, method="zoh")
    response = control.forced_response(system, np.arange(41) * TS_S, np.append(u, 0.0))
    truth = np.asarray(response.outputs)
    y, x, held, found = 0.0, np.zeros(len(gains.a)), 0.0, [0.0]
    for value in u:
        x = x + np.append(x[1:], 0.0) - gains.a * x[0] + gains.b * (value - held) / gains.g
        y, held = y + x[0], value
        found.append(y)
    assert found == pytest.approx(truth, rel=1e-9, abs=1e-9 * np.max(np.abs(truth)))


@pytest.mark.parametrize("name", A_OF)
def test_poles_go_to_their_mirror_images_at_the_stability_asked_for(name: str) -> None:
    # Truth: the plant's own poles by numpy and one at 0 for the moves; of regulator and filter each is what it was, or its mirror image, to
    # 0.1 % (a double pole is told to the root of rounding).
    linear, polynomials = plant(name)
    poles = closed_loop_poles(open_loop(controller_at(_Constant(gains_at(polynomials, SPEEDS)), 0.0), polynomials))
    own = np.append(np.linalg.eigvals(linear.A).astype(complex), 0.0)
    wanted = [
        complex(-2.0 * stability - pole.real if pole.real > -stability else pole.real, pole.imag)
        for stability in vars(SPEEDS).values()
        for pole in own
    ]
    found = np.poly(poles / 10.0).real
    assert found == pytest.approx(np.poly(np.array(wanted) / 10.0).real, rel=1e-3)


def test_no_other_regulator_of_that_stability_needs_less_input() -> None:
    # Truth: sum exp(2 alpha t) w^2 from a start, by running the plant; any other gain tried, near or far, pays more.
    _, polynomials = plant("inverted arm")
    gains = gains_at(polynomials, SPEEDS)
    start = np.array([0.3, -0.02, 0.001])
    least = _cost(gains, gains.k, start)
    for seed in range(40):
        drawn = np.random.default_rng(seed)
        other = gains.k * (1.0 + drawn.choice([1e-3, 1e-2, 0.1]) * drawn.normal(size=gains.k.size))
        assert _cost(gains, other, start) > least


def _cost(gains: Gains, k: Any, start: Any) -> float:
    """Sum of the weighted squares of w = -k x over 1200 samples of (C.8); infinite where the plant is then not at rest."""
    y, x, cost = start[0], start[1:].copy(), 0.0
    growth = np.exp(2.0 * SPEEDS.regulator_rad_s * TS_S)
    for sample_index in range(1200):
        w = -k[0] * y - k[1:] @ x
        cost += growth**sample_index * w * w
        x = x + np.append(x[1:], 0.0) - gains.a * x[0] + gains.b * w
        y = y + x[0]
    return cost


def test_the_poles_of_one_loop_are_those_of_its_polynomials() -> None:
    # Truth: a way without a shared matrix or polynomial of the loop, to 1e-4 of each pole.
    linear, polynomials = plant("rotor and arm")
    controller = controller_at(_Constant(gains_at(polynomials, SPEEDS)), 0.0)
    one = np.sort_complex(closed_loop_poles(open_loop(controller, polynomials)))
    other = np.sort_complex(coupled_poles(sample(linear, TS_S), [controller]))
    assert np.abs(one - other) == pytest.approx(0.0, abs=1e-4 * np.max(np.abs(one)))


def test_the_coupled_sensitivity_is_that_of_python_control() -> None:
    # Truth: two arms that push each other, both loops closed in python-control, to 1 % (its frequencies and ours differ).
    import control  # a second and a half of modules, which one worker alone is to load

    A = np.array([[0.0, 1.0, 0.0, 0.0], [20.0, -0.5, 4.0, 0.0], [0.0, 0.0, 0.0, 1.0], [-3.0, 0.0, 0.0, -0.5]])
    B, C = np.array([[0.0, 0.0], [3.0, 0.6], [0.0, 0.0], [0.9, 3.0]]), np.eye(4)[[0, 2]]
    whole = sample(LinearPlant(A, B, C), TS_S)
    parts = [LinearPlant(A[part, part], B[part, i : i + 1], C[i : i + 1, part]) for i, part in enumerate(_HALVES)]
    laws = [controller_at(_Constant(gains_at(plant_polynomials(sample(part, TS_S)), SPEEDS)), 0.0) for part in parts]
    plant_z = control.ss(np.eye(4) + whole.N, whole.B, whole.C, 0.0, TS_S)
    law_z = control.append(
        *[control.ss(np.eye(len(c.N)) + c.N, c.B[:, np.newaxis], c.C[np.newaxis], c.D, TS_S) for c in laws]
    )
    closed = control.feedback(control.ss([], [], [], np.eye(2), TS_S), law_z * plant_z, sign=1)
    omega = np.geomspace(1e-2, np.pi / TS_S, 4000)
    response = np.abs(control.frequency_response(closed, omega).frdata)
    truth = [response[i, i].max() for i in range(2)]
    assert coupled_sensitivity(whole, laws).tolist() == pytest.approx(truth, rel=0.01)


_HALVES = (slice(0, 2), slice(2, 4))


class _Constant:
    """Gains at one operating point as polynomials of degree 0."""

    def __init__(self, gains: Gains) -> None:
        self.a, self.b, self.k, self.l = (
            tuple((float(value),) for value in row) for row in (gains.a, gains.b, gains.k, gains.l)
        )
        self.g_V_rad, self.inverse_g_rad_V = (gains.g,), (1.0 / gains.g,)


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
        runs = simulate(ce150(), plan.t_s, plan.x0, drive, Conditions(reference=plan.reference_rad, p=p))
        found.append(merit(plan.t_s, plan.reference_rad, runs.y, runs.u, 0))
    return found
