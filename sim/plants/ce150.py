"""Humusoft CE150 two-rotor laboratory helicopter: gray-box model of seed 000, eqs (4)-(9), in its physically right form.

Where the paper's text cannot be right the choice is named here; `ce150_seed_literal` keeps the text.
- Negative speeds: P_b(|w|) and F(w) = sgn(w) P_F(|w|). The tail rotor is driven both ways and even powers alone would push the wrong way.
- Eq (8), centrifugal torque: the factor tau_gE/(2 g) lacks a length; `cf_length` (1 m, within 6 % of J_A/2) supplies it, and its sign is
  `cf_sign` = -1, as rotation pulls the arm towards the horizontal.
- Eq (9) is kept with J_A cos(Psi) on the left, not eq (15), which divides by J_A alone.
- Reciprocal terms that energy would ask for in (9) are absent in the seed and here; they are effects of the library.
"""

from collections.abc import Mapping
from functools import cache
from typing import Any

import sympy

from sim.model import Axis, Model, ParameterSpec, named_symbols, odd_polynomial, polynomial, symbol
from sim.places import AxisPlace, InputPlace, Places, RotorPlace, SensorPlace

OMEGA_M, OMEGA_T = symbol("omega_M_rad_s"), symbol("omega_T_rad_s")
PSI, PSI_DOT = symbol("psi_rad"), symbol("psi_dot_rad_s")
PHI, PHI_DOT = symbol("phi_rad"), symbol("phi_dot_rad_s")
U_M, U_T = symbol("u_M_V"), symbol("u_T_V")

STATES = (OMEGA_M, PSI, PSI_DOT, OMEGA_T, PHI, PHI_DOT)

PARAMETERS = (
    ParameterSpec("l_M", 1, "m", "positive"),
    ParameterSpec("l_T", 1, "m", "positive"),
    ParameterSpec("p_bM", 3, "[s^-1, rad^-1, rad^-2 s]"),
    ParameterSpec("K_M", 1, "rad s^-2 V^-1", "positive"),
    ParameterSpec("p_bT", 3, "[s^-1, rad^-1, rad^-2 s]"),
    ParameterSpec("K_T", 1, "rad s^-2 V^-1", "positive"),
    ParameterSpec("p_FM", 5, "[N, N s, N s^2, N s^3, N s^4]"),
    ParameterSpec("p_FT", 5, "[N, N s, N s^2, N s^3, N s^4]"),
    ParameterSpec("J_E", 1, "kg m^2", "positive"),
    ParameterSpec("tau_gE", 1, "N m", "positive"),
    ParameterSpec("b_vE", 1, "N m s", "non-negative"),
    ParameterSpec("b_cE", 1, "N m", "non-negative"),
    ParameterSpec("K_E", 1, "kg m^2"),
    ParameterSpec("J_A", 1, "kg m^2", "positive"),
    ParameterSpec("b_vA", 1, "N m s", "non-negative"),
    ParameterSpec("b_cA", 1, "N m", "non-negative"),
    ParameterSpec("K_A", 1, "N m s"),
    ParameterSpec("g", 1, "m s^-2", "positive"),
    ParameterSpec("u_min", 1, "V"),
    ParameterSpec("u_max", 1, "V"),
    ParameterSpec("uT_min", 1, "V"),
    ParameterSpec("uT_max", 1, "V"),
    ParameterSpec("Psi_lim", 1, "rad", "positive"),
    ParameterSpec("Phi_lim", 1, "rad", "positive"),
    ParameterSpec("cf_sign", 1, "-"),
    ParameterSpec("cf_length", 1, "m", "positive"),
)


Parameters = Mapping[str, Any]


@cache
def model() -> Model:
    """The equations of the CE150 as a Model."""
    p = named_symbols(PARAMETERS)
    thrust_M_N, thrust_T_N = odd_polynomial(p["p_FM"], OMEGA_M), odd_polynomial(p["p_FT"], OMEGA_T)  # (6), (7)
    return Model(
        name="ce150",
        states=STATES,
        inputs=(U_M, U_T),
        outputs={"psi_rad": PSI, "phi_rad": PHI},
        parameters=PARAMETERS,
        rates={
            OMEGA_M: p["K_M"] * U_M - polynomial(p["p_bM"], sympy.Abs(OMEGA_M)) * OMEGA_M,  # (4)
            PSI: PSI_DOT,
            OMEGA_T: p["K_T"] * U_T - polynomial(p["p_bT"], sympy.Abs(OMEGA_T)) * OMEGA_T,  # (5)
            PHI: PHI_DOT,
        },
        axes=(
            elevation(p, thrust_M_N),
            azimuth(p, thrust_T_N, p["J_A"] * sympy.cos(PSI)),
        ),
        input_limits={U_M: (p["u_min"], p["u_max"]), U_T: (p["uT_min"], p["uT_max"])},
        places=places(p, thrust_M_N, thrust_T_N),
    )


def elevation(p: Parameters, thrust_N: sympy.Expr) -> Axis:
    """Eq (8) driven by the main rotor's thrust."""
    centrifugal = p["cf_sign"] * p["tau_gE"] * p["cf_length"] / (2 * p["g"]) * PHI_DOT**2 * sympy.sin(2 * PSI)
    gyroscopic = p["K_E"] * PHI_DOT * OMEGA_M * sympy.sin(PSI)
    torque = p["l_M"] * thrust_N + centrifugal - p["tau_gE"] * sympy.cos(PSI) - p["b_vE"] * PSI_DOT + gyroscopic
    return Axis("elevation", PSI, PSI_DOT, p["J_E"], torque, p["b_cE"], -p["Psi_lim"], p["Psi_lim"])


def azimuth(p: Parameters, thrust_N: sympy.Expr, inertia: sympy.Expr) -> Axis:
    """Eq (9) driven by the tail rotor's thrust and the main rotor's reaction."""
    torque = (p["l_T"] * thrust_N - p["K_A"] * OMEGA_M) * sympy.cos(PSI) - p["b_vA"] * PHI_DOT
    return Axis("azimuth", PHI, PHI_DOT, inertia, torque, p["b_cA"], -p["Phi_lim"], p["Phi_lim"])


def places(p: Parameters, thrust_M_N: sympy.Expr, thrust_T_N: sympy.Expr) -> Places:
    """Where effects act: two drivers, two rotors, two axes, two encoders."""
    lift, push = p["l_M"] * thrust_M_N, p["l_T"] * thrust_T_N * sympy.cos(PSI)
    gravity = -p["tau_gE"] * sympy.cos(PSI)
    return Places(
        inputs={"main_input": InputPlace(U_M, "V", 10.0), "tail_input": InputPlace(U_T, "V", 10.0)},
        rotors={
            "main_rotor": RotorPlace(U_M, "M", OMEGA_M, 600.0, {"elevation": lift}, 10.0, p["K_M"] * U_M),
            "tail_rotor": RotorPlace(U_T, "T", OMEGA_T, 800.0, {"azimuth": push}, 10.0, p["K_T"] * U_T, two_way=True),
        },
        axes={
            "elevation": AxisPlace(
                "psi_rad", "N m", 0.04, gravity=gravity, gravity_moment=p["tau_gE"], spun_by="tail_rotor"
            ),
            "azimuth": AxisPlace("phi_rad", "N m", 0.04, level=True, spun_by="main_rotor"),
        },
        sensors={"psi_sensor": SensorPlace("psi_rad", "rad"), "phi_sensor": SensorPlace("phi_rad", "rad")},
    )
