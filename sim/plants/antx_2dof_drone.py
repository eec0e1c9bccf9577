"""Pitch of the ANT-X drone on its 2-DOF rig, as identified in the repository of M. Di Mauro (commit f8ab3e06).

    (1)  theta' = q,   q' = -2 xi omega_n q - omega_n^2 theta + mu M(t - tau)

M the commanded torque, normalised to -1..1. The delay is the Pade approximation of second order,

    (2)  exp(-tau s) = 1 - tau s / (1 + tau s / 2 + tau^2 s^2 / 12),

whose phase is wrong by less than 0.07 degrees up to 50 rad/s at tau = 20 ms, far above the
pitch mode. A step of M shows for a few ms in q' at once.
"""

from functools import cache

import sympy

from sim.model import Axis, Model, ParameterSpec, named_symbols, symbol
from sim.places import AxisPlace, InputPlace, Places, RotorPlace, SensorPlace

THETA, Q = symbol("theta_rad"), symbol("q_rad_s")
FILTERED, FILTERED_RATE = (
    symbol("M_filtered"),
    symbol("M_filtered_rate"),
)  # M / (1 + tau s / 2 + tau^2 s^2 / 12) and its rate
M = symbol("M")

PARAMETERS = (
    ParameterSpec("omega_n", 1, "rad s^-1", "positive"),
    ParameterSpec("xi", 1, "-", "non-negative"),
    ParameterSpec("mu", 1, "rad s^-2", "positive"),
    ParameterSpec("tau", 1, "s", "positive"),
)


@cache
def model() -> Model:
    """Eqs (1) and (2) as a Model, scaled to a moment of inertia of 1."""
    p = named_symbols(PARAMETERS)
    delayed = M - p["tau"] * FILTERED_RATE
    torque = p["mu"] * delayed - 2 * p["xi"] * p["omega_n"] * Q - p["omega_n"] ** 2 * THETA
    return Model(
        name="antx_2dof_drone",
        states=(THETA, Q, FILTERED, FILTERED_RATE),
        inputs=(M,),
        outputs={"theta_rad": THETA, "q_rad_s": Q},
        parameters=PARAMETERS,
        rates={
            THETA: Q,
            FILTERED: FILTERED_RATE,
            FILTERED_RATE: 12 / p["tau"] ** 2 * (M - FILTERED) - 6 / p["tau"] * FILTERED_RATE,
        },
        axes=(Axis("pitch", THETA, Q, sympy.Integer(1), torque, sympy.Integer(0), None, None),),
        input_limits={M: (sympy.Integer(-1), sympy.Integer(1))},
        places=Places(
            inputs={"input": InputPlace(M, "-", 1.0)},
            rotors={"rotor": RotorPlace(M, "", M, 1.0, {"pitch": p["mu"] * delayed}, 1.0, linear=True, two_way=True)},
            axes={"pitch": AxisPlace("theta_rad", "rad s^-2", 20.0)},
            sensors={"theta_sensor": SensorPlace("theta_rad", "rad", 1.0)},
        ),
    )
