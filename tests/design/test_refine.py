"""Eq (26) to rounding: against forty digits, and where the paper's powers of z^-1 lose it."""

import mpmath
import numpy as np
import pytest

from design.direct_form import to_delta
from design.discretise import sample
from design.linearise import linearise, subsystem
from design.loop import plant_polynomials
from design.pole_placement import FREE_DEGREES, characteristic, poles_z, refined
from design.transfer import transfer_function
from records.loops import LOOPS
from records.table import AXES
from sim.equilibrium import equilibrium
from tests.design.helicopter import DOM2, SAMPLE_PERIOD_S, helicopter, place

DIGITS = 40


def delta_of_forty_digits(b, a, poles):
    """q and p of the delta form with P(1) = 0 for polynomials in gamma (4,), solved in powers of gamma with forty digits."""
    with mpmath.workdps(DIGITS):
        products = [mpmath.mpf(1)]
        for pole in poles:
            gamma = mpmath.expm1(mpmath.mpf(pole) * mpmath.mpf(SAMPLE_PERIOD_S))
            products = [
                (products[k - 1] if k else 0) - (gamma * products[k] if k < len(products) else 0)
                for k in range(len(products) + 1)
            ]
        # z^3 delta^k = gamma^k (1 + gamma)^(3 - k); P = delta - z^-1 (c_1 delta + c_2 delta^2) as c_0 = 0.
        q_rows = [binomial(k, 3 - k) for k in range(4)]
        p_rows = [[-value for value in binomial(k, 2 - k)] + [0] for k in (1, 2)]
        columns = [convolved(b, row) for row in q_rows] + [convolved(a, row) for row in p_rows]
        fixed = convolved(a, binomial(1, 2))
        system = mpmath.matrix([[column[k] for column in columns] for k in range(6)])
        target = mpmath.matrix([products[k] - fixed[k] for k in range(6)])
        solved = mpmath.lu_solve(system, target)
    return np.array([float(value) for value in solved])


def binomial(shift, power):
    """gamma^shift (1 + gamma)^power, ascending, four coefficients or one fewer where they end there."""
    return [0] * shift + [int(mpmath.binomial(power, k)) for k in range(power + 1)]


def convolved(one, other):
    total = [mpmath.mpf(0)] * 7
    for i, x in enumerate(one):
        for j, y in enumerate(other):
            total[i + j] += mpmath.mpf(x) * y
    return total


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
