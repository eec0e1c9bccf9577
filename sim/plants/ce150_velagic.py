"""The CE150 as seed 001 models it (Velagic and Osmic), eqs (3)-(7): double lags, square laws of thrust, a gyroscopic torque.

The paper counts psi from the vertical and voltages in machine units (MU); here Psi = psi - 90 deg and voltages are in V, so its logs and
those of `ce150` are alike. Equations, with w_j = omega_j / omega_j1 the speed as a share of that at 1 MU:

    (6)  T_1 lag_M' = omega_M1 u_M/MU - lag_M,  T_1 omega_M' = lag_M - omega_M, and alike with T_2 for the tail rotor
    (7)  tau_j = a_j w|w| + b_j w:  lift (1) and reaction (3) with the main rotor's w, push (2) with the tail rotor's
    (3)  Psi''/I_inv = tau_1 - tau_G L/(2 g) Phi'^2 sin(2 Psi) - tau_G cos(Psi) - B_psi Psi' - C_psi sgn(Psi') - k_G Phi' w_M sin(Psi)
    (4)  cos(Psi) Phi''/Ic_inv = (tau_2 - tau_3) cos(Psi) - B_phi Phi' - C_phi sgn(Phi')

Where the text cannot be right, this is taken (numbers and figures of the paper decide):
- (7) prints a u^2 + b; with b u the arm hovers at 0.56 MU as in Fig. 12, with the text's form at 0.28 MU. Powers are odd, as u_T has
  both signs.
- I = 184 and Ic = 494.3 cannot be kg m^2: they are the inverse inertias 1/I that stand in a block diagram, hence I_inv and Ic_inv.
- B_psi = 0.08 and B_phi = 0.04 bear no unit; as torques over speed, N m s, they let the azimuth drift as slowly as Fig. 13b shows.
- tau_G names the weight's torque and the gyroscopic one; the latter is k_G Phi' w_M cos(psi) here, that is - sin(Psi).
- The centrifugal torque m l phi'^2 sin(psi) cos(psi) lacks a length, `cf_length`.
- (4) subtracts viscous friction from Coulomb friction (they add), and gives sin(psi) to the inertia and tau_2 but not to the reaction:
  the main rotor's axis tilts with the arm, so all three bear it here, as in (9) of seed 000.
- "14 unknown parameters" counts T_1 and T_2, which are given. C_psi and C_phi are in the equations and not among the 14.
Motion alone tells ratios: a_1, b_1, tau_G, B_psi, k_G and 1/I_inv may all be multiplied by one factor, and a_2, b_2, a_3, b_3, B_phi and
1/Ic_inv by another. The plant file therefore holds tau_G and B_phi.
"""

from collections.abc import Mapping
from functools import cache
from typing import Any

import sympy

from sim.model import Axis, Model, ParameterSpec, named_symbols, symbol
from sim.places import AxisPlace, InputPlace, Places, RotorPlace, SensorPlace
from sim.plants.ce150 import OMEGA_M, OMEGA_T, PHI, PHI_DOT, PSI, PSI_DOT, U_M, U_T

LAG_M, LAG_T = symbol("lag_M_rad_s"), symbol("lag_T_rad_s")

PARAMETERS = (
    ParameterSpec("T_1", 1, "s", "positive"),
    ParameterSpec("T_2", 1, "s", "positive"),
    ParameterSpec("a_1", 1, "N m", "positive"),
    ParameterSpec("b_1", 1, "N m", "non-negative"),
    ParameterSpec("a_2", 1, "N m", "positive"),
    ParameterSpec("b_2", 1, "N m", "non-negative"),
    ParameterSpec("a_3", 1, "N m", "non-negative"),
    ParameterSpec("b_3", 1, "N m", "non-negative"),
    ParameterSpec("I_inv", 1, "kg^-1 m^-2", "positive"),
    ParameterSpec("B_psi", 1, "N m s", "non-negative"),
    ParameterSpec("C_psi", 1, "N m", "non-negative"),
    ParameterSpec("tau_G", 1, "N m", "positive"),
    ParameterSpec("k_G", 1, "N m s"),
    ParameterSpec("Ic_inv", 1, "kg^-1 m^-2", "positive"),
    ParameterSpec("B_phi", 1, "N m s", "non-negative"),
    ParameterSpec("C_phi", 1, "N m", "non-negative"),
    ParameterSpec("MU", 1, "V", "positive"),
    ParameterSpec("omega_M1", 1, "rad s^-1", "positive"),
    ParameterSpec("omega_T1", 1, "rad s^-1", "positive"),
    ParameterSpec("g", 1, "m s^-2", "positive"),
    ParameterSpec("cf_length", 1, "m", "non-negative"),
    ParameterSpec("u_min", 1, "V"),
    ParameterSpec("u_max", 1, "V"),
    ParameterSpec("uT_min", 1, "V"),
    ParameterSpec("uT_max", 1, "V"),
    ParameterSpec("Psi_lim", 1, "rad", "positive"),
    ParameterSpec("Phi_lim", 1, "rad", "positive"),
)
Parameters = Mapping[str, Any]


@cache
def model() -> Model:
    """Eqs (3)-(7) as a Model."""
    p = named_symbols(PARAMETERS)
    return Model(
        name="ce150_velagic",
        states=(LAG_M, OMEGA_M, PSI, PSI_DOT, LAG_T, OMEGA_T, PHI, PHI_DOT),
        inputs=(U_M, U_T),
        outputs={"psi_rad": PSI, "phi_rad": PHI},
        parameters=PARAMETERS,
        rates={
            LAG_M: (p["omega_M1"] * U_M / p["MU"] - LAG_M) / p["T_1"],
            OMEGA_M: (LAG_M - OMEGA_M) / p["T_1"],
            PSI: PSI_DOT,
            LAG_T: (p["omega_T1"] * U_T / p["MU"] - LAG_T) / p["T_2"],
            OMEGA_T: (LAG_T - OMEGA_T) / p["T_2"],
            PHI: PHI_DOT,
        },
        axes=(elevation(p), azimuth(p)),
        input_limits={U_M: (p["u_min"], p["u_max"]), U_T: (p["uT_min"], p["uT_max"])},
        places=places(p),
    )


def square_law(a: sympy.Expr, b: sympy.Expr, share: sympy.Expr) -> sympy.Expr:
    """Eq (7), odd: a w|w| + b w."""
    return share * (b + a * sympy.Abs(share))


def lift(p: Parameters) -> sympy.Expr:
    """tau_1, the main rotor's torque on the elevation."""
    return square_law(p["a_1"], p["b_1"], OMEGA_M / p["omega_M1"])


def push(p: Parameters) -> sympy.Expr:
    """tau_2, the tail rotor's torque on the azimuth of a level arm."""
    return square_law(p["a_2"], p["b_2"], OMEGA_T / p["omega_T1"])


def reaction(p: Parameters) -> sympy.Expr:
    """tau_3, the main rotor's torque on the azimuth of a level arm, which (4) calls tau_r."""
    return square_law(p["a_3"], p["b_3"], OMEGA_M / p["omega_M1"])


def elevation(p: Parameters) -> Axis:
    """Eq (3)."""
    centrifugal = -p["tau_G"] * p["cf_length"] / (2 * p["g"]) * PHI_DOT**2 * sympy.sin(2 * PSI)
    gyroscopic = -p["k_G"] * PHI_DOT * OMEGA_M / p["omega_M1"] * sympy.sin(PSI)
    torque = lift(p) + centrifugal - p["tau_G"] * sympy.cos(PSI) - p["B_psi"] * PSI_DOT + gyroscopic
    return Axis("elevation", PSI, PSI_DOT, 1 / p["I_inv"], torque, p["C_psi"], -p["Psi_lim"], p["Psi_lim"])


def azimuth(p: Parameters) -> Axis:
    """Eq (4)."""
    torque = (push(p) - reaction(p)) * sympy.cos(PSI) - p["B_phi"] * PHI_DOT
    inertia = sympy.cos(PSI) / p["Ic_inv"]
    return Axis("azimuth", PHI, PHI_DOT, inertia, torque, p["C_phi"], -p["Phi_lim"], p["Phi_lim"])


def places(p: Parameters) -> Places:
    """Where effects act: as on `ce150`, with the second lag of (6) as what drives a rotor's speed."""
    gravity = -p["tau_G"] * sympy.cos(PSI)
    push_N_m = {"azimuth": push(p) * sympy.cos(PSI)}
    return Places(
        inputs={"main_input": InputPlace(U_M, "V", 10.0), "tail_input": InputPlace(U_T, "V", 10.0)},
        rotors={
            "main_rotor": RotorPlace(U_M, "M", OMEGA_M, 600.0, {"elevation": lift(p)}, 10.0, LAG_M / p["T_1"]),
            "tail_rotor": RotorPlace(U_T, "T", OMEGA_T, 800.0, push_N_m, 10.0, LAG_T / p["T_2"], two_way=True),
        },
        axes={
            "elevation": AxisPlace(
                "psi_rad", "N m", 0.07, gravity=gravity, gravity_moment=p["tau_G"], spun_by="tail_rotor"
            ),
            "azimuth": AxisPlace("phi_rad", "N m", 0.07, level=True, spun_by="main_rotor"),
        },
        sensors={"psi_sensor": SensorPlace("psi_rad", "rad"), "phi_sensor": SensorPlace("phi_rad", "rad")},
    )
