"""Quanser Aero with two free axes, as its author published it: static rotors, thrust by the square of their speed.

Equations of motion of the repository finnferdinand/orbital-stabilization-quanser-aero (commit 3fd8f4c1), pitch theta and yaw psi:

    (1)  I_b theta'' = d_t (K_mt w_m^2 + K_tt w_t^2) - I_b psi'^2 cos(theta) sin(theta) - d_x g m_e sin(theta) - d_1 theta'
    (2)  (I_y + I_b cos^2 theta) psi'' = d_t cos(theta) (K_tp w_t^2 - K_mp w_m^2) + 2 I_b theta' psi' cos(theta) sin(theta) - d_2 psi'
    (3)  w = K_omega V, the demanded voltage V clipped at +-u_max by the motor driver
    (4)  I_b = 2 m_pa d_t^2 + 2 m_e d_t^2 + m_e d_x^2 + m_rod l_t^2 / 12,   I_y = m_y r_y^2 / 2

Kept with what one may object to: a rotor has no lag, a negative speed pushes the same way as a positive one, friction is viscous.
"""

from collections.abc import Mapping
from functools import cache
from typing import Any

import sympy

from sim.model import Axis, Model, ParameterSpec, named_symbols, symbol
from sim.places import AxisPlace, InputPlace, Places, RotorPlace, SensorPlace

THETA, THETA_DOT = symbol("theta_rad"), symbol("theta_dot_rad_s")
PSI, PSI_DOT = symbol("psi_rad"), symbol("psi_dot_rad_s")
U_M, U_T = symbol("u_M_V"), symbol("u_T_V")

PARAMETERS = (
    ParameterSpec("dt", 1, "m", "positive"),
    ParameterSpec("me", 1, "kg", "positive"),
    ParameterSpec("dx", 1, "m", "positive"),
    ParameterSpec("mpa", 1, "kg", "positive"),
    ParameterSpec("lt", 1, "m", "positive"),
    ParameterSpec("mrod", 1, "kg", "positive"),
    ParameterSpec("ry", 1, "m", "positive"),
    ParameterSpec("my", 1, "kg", "positive"),
    ParameterSpec("g", 1, "m s^-2", "positive"),
    ParameterSpec("K_omega", 1, "rad s^-1 V^-1", "positive"),
    ParameterSpec("Kmt", 1, "N s^2", "positive"),
    ParameterSpec("Ktt", 1, "N s^2", "positive"),
    ParameterSpec("Kmp", 1, "N s^2", "positive"),
    ParameterSpec("Ktp", 1, "N s^2", "positive"),
    ParameterSpec("d1", 1, "N m s", "non-negative"),
    ParameterSpec("d2", 1, "N m s", "non-negative"),
    ParameterSpec("u_max", 1, "V", "positive"),
)
Parameters = Mapping[str, Any]


@cache
def model() -> Model:
    """The equations of the Quanser Aero as a Model."""
    p = named_symbols(PARAMETERS)
    omega_M, omega_T = p["K_omega"] * U_M, p["K_omega"] * U_T  # (3)
    return Model(
        name="quanser_aero",
        states=(THETA, THETA_DOT, PSI, PSI_DOT),
        inputs=(U_M, U_T),
        outputs={"theta_rad": THETA, "psi_rad": PSI},
        parameters=PARAMETERS,
        rates={THETA: THETA_DOT, PSI: PSI_DOT},
        axes=(pitch(p, omega_M, omega_T), yaw(p, omega_M, omega_T)),
        input_limits={U_M: (-p["u_max"], p["u_max"]), U_T: (-p["u_max"], p["u_max"])},
        signals={"omega_M_rad_s": omega_M, "omega_T_rad_s": omega_T},
        places=places(p, omega_M, omega_T),
    )


def pitch(p: Parameters, omega_M: sympy.Expr, omega_T: sympy.Expr) -> Axis:
    """Eq (1)."""
    inertia = body_inertia(p)
    thrust = p["dt"] * (p["Kmt"] * omega_M**2 + p["Ktt"] * omega_T**2)
    centrifugal = inertia * PSI_DOT**2 * sympy.cos(THETA) * sympy.sin(THETA)
    torque = thrust - centrifugal - p["dx"] * p["g"] * p["me"] * sympy.sin(THETA) - p["d1"] * THETA_DOT
    return Axis("pitch", THETA, THETA_DOT, inertia, torque, sympy.Integer(0), None, None)


def yaw(p: Parameters, omega_M: sympy.Expr, omega_T: sympy.Expr) -> Axis:
    """Eq (2)."""
    inertia = p["my"] * p["ry"] ** 2 / 2 + body_inertia(p) * sympy.cos(THETA) ** 2
    thrust = p["dt"] * sympy.cos(THETA) * (p["Ktp"] * omega_T**2 - p["Kmp"] * omega_M**2)
    coriolis = 2 * body_inertia(p) * THETA_DOT * PSI_DOT * sympy.cos(THETA) * sympy.sin(THETA)
    return Axis("yaw", PSI, PSI_DOT, inertia, thrust + coriolis - p["d2"] * PSI_DOT, sympy.Integer(0), None, None)


def body_inertia(p: Parameters) -> sympy.Expr:
    """I_b of eq (4) [kg m^2]."""
    return 2 * (p["mpa"] + p["me"]) * p["dt"] ** 2 + p["me"] * p["dx"] ** 2 + p["mrod"] * p["lt"] ** 2 / 12


def places(p: Parameters, omega_M: sympy.Expr, omega_T: sympy.Expr) -> Places:
    """Where effects act; both rotors push both axes."""
    lever = p["dt"] * sympy.cos(THETA)
    main = {"pitch": p["dt"] * p["Kmt"] * omega_M**2, "yaw": -lever * p["Kmp"] * omega_M**2}
    tail = {"pitch": p["dt"] * p["Ktt"] * omega_T**2, "yaw": lever * p["Ktp"] * omega_T**2}
    moment = p["dx"] * p["g"] * p["me"]
    return Places(
        inputs={"main_input": InputPlace(U_M, "V", 24.0), "tail_input": InputPlace(U_T, "V", 24.0)},
        rotors={
            "main_rotor": RotorPlace(U_M, "M", omega_M, 400.0, main, 24.0, two_way=True),
            "tail_rotor": RotorPlace(U_T, "T", omega_T, 400.0, tail, 24.0, two_way=True),
        },
        axes={
            "pitch": AxisPlace("theta_rad", "N m", 0.03, gravity=-moment * sympy.sin(THETA), gravity_moment=moment),
            "yaw": AxisPlace("psi_rad", "N m", 0.03, level=True),
        },
        sensors={"theta_sensor": SensorPlace("theta_rad", "rad"), "psi_sensor": SensorPlace("psi_rad", "rad")},
    )
