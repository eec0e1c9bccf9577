"""Eqs (4)-(9) of the CE150 written out a second time, by hand and in floats, against what is derived from SymPy.

The other tests compare derived things with each other; a wrong sign in the one source would pass them.
"""

import numpy as np
import pytest

from sim.kernel.reference import reference

RANGES = (
    [-600, 600],
    [-0.78, 0.78],
    [-6, 6],
    [-800, 800],
    [-2.2, 2.2],
    [-6, 6],
)  # of omega_M, Psi, Psi', omega_T, Phi, Phi'


def polynomial(coefficients, omega):
    return sum(c * omega**power for power, c in enumerate(coefficients))


def right(p, x, u):
    """Odd extension to negative speeds, centrifugal torque towards the horizontal, J_A cos(Psi) of eq (9)."""
    omega_M, psi, _, omega_T, _, _ = x
    rotors = (
        p["K_M"][0] * u[0] - polynomial(p["p_bM"], abs(omega_M)) * omega_M,
        p["K_T"][0] * u[1] - polynomial(p["p_bT"], abs(omega_T)) * omega_T,
    )
    thrusts = [np.sign(w) * polynomial(p[f"p_F{r}"], abs(w)) for r, w in (("M", omega_M), ("T", omega_T))]
    return body(p, x, rotors, thrusts, -1.0, p["J_A"][0] * np.cos(psi))


def literal(p, x, u):
    """As printed: powers of the signed speed, plus sign in eq (8), J_A alone as in eq (15)."""
    omega_M, _, _, omega_T, _, _ = x
    rotors = (
        p["K_M"][0] * u[0] - polynomial(p["p_bM"], omega_M) * omega_M,
        p["K_T"][0] * u[1] - polynomial(p["p_bT"], omega_T) * omega_T,
    )
    thrusts = [polynomial(p[f"p_F{r}"], w) for r, w in (("M", omega_M), ("T", omega_T))]
    return body(p, x, rotors, thrusts, +1.0, p["J_A"][0])


def body(p, x, rotors, thrusts_N, centrifugal_sign, inertia_A):
    omega_M, psi, psi_dot, _, _, phi_dot = x
    one = {name: values[0] for name, values in p.items()}
    tau_E = one["l_M"] * thrusts_N[0]
    tau_E += centrifugal_sign * one["tau_gE"] * 1.0 / (2 * 9.81) * phi_dot**2 * np.sin(2 * psi)
    tau_E -= one["tau_gE"] * np.cos(psi) + one["b_vE"] * psi_dot + one["b_cE"] * np.sign(psi_dot)
    tau_E += one["K_E"] * phi_dot * omega_M * np.sin(psi)
    tau_A = one["l_T"] * thrusts_N[1] * np.cos(psi) - one["K_A"] * omega_M * np.cos(psi)
    tau_A -= one["b_vA"] * phi_dot + one["b_cA"] * np.sign(phi_dot)
    return np.array([rotors[0], psi_dot, tau_E / one["J_E"], rotors[1], phi_dot, tau_A / inertia_A])


@pytest.mark.parametrize(("plant", "by_hand"), [("bound", right), ("literal", literal)])
def test_the_rates_are_those_written_by_hand(plant, by_hand, request):
    bound, random = request.getfixturevalue(plant), np.random.default_rng(1)
    p = {name: parameter.values for name, parameter in bound.plant.parameters.items()}
    rates = reference(bound.model).rates
    for _ in range(200):
        x, u = np.array([random.uniform(*span) for span in RANGES]), random.uniform([0, -10], [10, 10])
        wanted = by_hand(p, x, u)
        found = rates(0.0, x, u, bound.p, np.sign(x[[2, 5]]))
        np.testing.assert_allclose(found, wanted, rtol=1e-12, atol=1e-12 * np.max(np.abs(wanted)))
