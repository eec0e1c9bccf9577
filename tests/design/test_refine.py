"""Eq (26) to rounding: against forty digits, and where the paper's powers of z^-1 lose it."""

import mpmath
import numpy as np
import pytest

from design.direct_form import to_delta
from design.discretise import sample
from design.linearise import linearise, subsystem
from design.loop import plant_polynomials
from design.operating_points import design_point, rest
from design.pole_placement import FREE_DEGREES, characteristic, poles_z, refined
from design.settings import read_settings
from design.transfer import transfer_function
from records.loops import LOOPS
from records.table import AXES
from sim.equilibrium import equilibrium
from tests.design.helicopter import DOM2, SAMPLE_PERIOD_S, helicopter, place
from tests.plants import bound

DIGITS = 40


def delta_of_forty_digits(b, a, poles, sample_period_s=SAMPLE_PERIOD_S):
    """q and p of the delta form with P(1) = 0 for polynomials in gamma (n + 1,), solved in powers of gamma with forty digits."""
    states, order = len(a) - 1, len(poles) - len(a) + 1
    with mpmath.workdps(DIGITS):
        products = [mpmath.mpf(1)]
        for pole in poles:
            gamma = mpmath.expm1(mpmath.mpmathify(pole) * mpmath.mpf(sample_period_s))
            products = [
                (products[k - 1] if k else 0) - (gamma * products[k] if k < len(products) else 0)
                for k in range(len(products) + 1)
            ]
        # z^n delta^k = gamma^k (1 + gamma)^(n - k); P = delta - z^-1 (c_1 delta + c_2 delta^2 ..) as c_0 = 0.
        q_rows = [binomial(k, order - k) for k in range(states + 1)]
        p_rows = [[-value for value in binomial(k, order - 1 - k)] + [0] for k in range(1, order)]
        columns = [convolved(b, row) for row in q_rows] + [convolved(a, row) for row in p_rows]
        fixed = convolved(a, binomial(1, order - 1))
        system = mpmath.matrix([[column[k] for column in columns] for k in range(states + order)])
        target = mpmath.matrix([mpmath.re(products[k]) - fixed[k] for k in range(states + order)])
        solved = mpmath.lu_solve(system, target)
    return np.array([float(value) for value in solved])


def polynomials_of_forty_digits(linear, sample_period_s):
    """b and a in gamma, (n + 1,), of the plant sampled: C adj(gamma I - N) B and det(gamma I - N) by Faddeev and LeVerrier."""
    n = len(linear.A)
    with mpmath.workdps(DIGITS):
        block = mpmath.zeros(n + 1)
        block[:n, :n], block[:n, n] = mpmath.matrix(linear.A.tolist()), mpmath.matrix(linear.B.tolist())
        step = mpmath.expm(block * mpmath.mpf(sample_period_s)) - mpmath.eye(n + 1)
        N, B, C = step[:n, :n], step[:n, n], mpmath.matrix(linear.C.tolist())
        a, b, adjugate = [mpmath.mpf(0)] * n + [mpmath.mpf(1)], [mpmath.mpf(0)] * (n + 1), mpmath.eye(n)
        for power in range(n - 1, -1, -1):
            b[power] = (C * adjugate * B)[0]
            product = N * adjugate
            a[power] = -sum(product[k, k] for k in range(n)) / (n - power)
            adjugate = product + a[power] * mpmath.eye(n)
    return b, a


def binomial(shift, power):
    """gamma^shift (1 + gamma)^power, ascending, a coefficient for each power up to that."""
    return [0] * shift + [int(mpmath.binomial(power, k)) for k in range(power + 1)]


def convolved(one, other):
    total = [mpmath.mpf(0)] * (len(one) + len(other) - 1)
    for i, x in enumerate(one):
        for j, y in enumerate(other):
            total[i + j] += mpmath.mpf(x) * y
    return total


@pytest.mark.skipif(np.finfo(np.longdouble).eps > 2e-19, reason="no numbers of more than 53 bits here")
@pytest.mark.parametrize("psi_rad", [-0.5, 0.0, 0.5])
def test_a_plant_of_two_rotor_lags_keeps_the_digits_of_its_table(psi_rad):
    """Truth: forty digits from the linear plant on. In doubles the ninth digit of q is gone: B is a millionth of A, and a last bit of
    A P shows in B Q. A table keeps eight; 1e-11 of each coefficient leaves them alone but for one in a thousand."""
    plant = bound("ce150_velagic")
    settings = read_settings(plant)
    wishes, point = settings.axes[0], rest(plant, settings, psi_rad)
    linear = subsystem(plant, linearise(plant, point), settings.loops[0], settings.loops)
    exact = delta_of_forty_digits(
        *polynomials_of_forty_digits(linear, settings.sample_period_s), wishes.placed_rad_s, settings.sample_period_s
    )
    found = design_point(plant, point, settings, wishes, psi_rad).delta
    np.testing.assert_allclose(np.append(found.q, found.p[1:]), exact, rtol=1e-11)


@pytest.mark.parametrize("axis", ["elevation", "azimuth"])
@pytest.mark.parametrize("psi_deg", [-40.0, 0.0, 40.0])
def test_every_coefficient_is_known_to_rounding(axis, psi_deg):
    # Truth: forty digits. 1e-12 of each coefficient, Q(1) included, whose neighbours are 3e4 times larger.
    linear = subsystem(
        helicopter(), linearise(helicopter(), equilibrium(helicopter(), np.radians(psi_deg))), LOOPS[AXES.index(axis)]
    )
    plant = plant_polynomials(sample(linear, SAMPLE_PERIOD_S))
    transfer = transfer_function(linear, SAMPLE_PERIOD_S, axis)
    wanted = characteristic(poles_z(DOM2, SAMPLE_PERIOD_S))
    placement = place(transfer.b, transfer.a, wanted, FREE_DEGREES["integral"], axis)
    exact = delta_of_forty_digits(plant.b, plant.a, DOM2)
    found = refined(plant, to_delta(placement.controller), DOM2, FREE_DEGREES["integral"])
    np.testing.assert_allclose(np.append(found.q, found.p[1:]), exact, rtol=1e-12)
    assert abs(found.p[0]) < 1e-12
    plain = to_delta(placement.controller)
    assert abs(plain.q[0] / exact[0] - 1.0) < 1e-6


def test_a_condition_on_the_paper_s_coefficients_still_holds():
    linear = subsystem(helicopter(), linearise(helicopter(), equilibrium(helicopter(), 0.0)), LOOPS[0])
    plant = plant_polynomials(sample(linear, SAMPLE_PERIOD_S))
    transfer = transfer_function(linear, SAMPLE_PERIOD_S, "elevation")
    wanted = characteristic(poles_z(DOM2, SAMPLE_PERIOD_S))
    for name, free in FREE_DEGREES.items():
        placement = place(transfer.b, transfer.a, wanted, free, name)
        found = refined(plant, to_delta(placement.controller), DOM2, free)
        np.testing.assert_allclose(found.q, to_delta(placement.controller).q, rtol=1e-6)
