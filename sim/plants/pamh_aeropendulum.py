"""Aeropendulum of the repository Jdavidmn/Lab_Control (commit ac497502), as the transfer function fitted there from volt to radian.

    (1)  theta(s) / u(s) = b / (s^2 + d s + k),   that is   theta'' = b u - k theta - d theta'

The fit is linear in the angle, although gravity is not.
"""

from functools import cache

import sympy

from sim.model import Axis, Model, ParameterSpec, named_symbols, symbol
from sim.places import AxisPlace, InputPlace, Places, RotorPlace, SensorPlace

THETA, THETA_DOT = symbol("theta_rad"), symbol("theta_dot_rad_s")
U = symbol("u_V")

PARAMETERS = (
    ParameterSpec("b", 1, "rad s^-2 V^-1", "positive"),
    ParameterSpec("d", 1, "s^-1", "non-negative"),
    ParameterSpec("k", 1, "s^-2", "positive"),
    ParameterSpec("u_max", 1, "V", "positive"),
)


@cache
def model() -> Model:
    """Eq (1) as a Model, scaled to a moment of inertia of 1."""
    p = named_symbols(PARAMETERS)
    torque = p["b"] * U - p["k"] * THETA - p["d"] * THETA_DOT
    return Model(
        name="pamh_aeropendulum",
        states=(THETA, THETA_DOT),
        inputs=(U,),
        outputs={"theta_rad": THETA},
        parameters=PARAMETERS,
        rates={THETA: THETA_DOT},
        axes=(Axis("arm", THETA, THETA_DOT, sympy.Integer(1), torque, sympy.Integer(0), None, None),),
        input_limits={U: (sympy.Integer(0), p["u_max"])},
        places=Places(
            inputs={"input": InputPlace(U, "V", 2.0)},
            rotors={"rotor": RotorPlace(U, "", U, 2.0, {"arm": p["b"] * U}, 2.0, linear=True)},
            axes={"arm": AxisPlace("theta_rad", "rad s^-2", 10.0)},
            sensors={"theta_sensor": SensorPlace("theta_rad", "rad", 1.0)},
        ),
    )
