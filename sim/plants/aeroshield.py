"""AeroShield, an arm with one propeller, as the AutomationShield repository models it (commit bc0778f9).

    (1)  theta'' = K u / (l m) - (g/l) sin(theta) - c theta' / (m l^2)

theta from where the arm hangs; u the commanded RMS voltage, 0 to u_max, as the propeller pushes one way only.
Only three combinations show in the motion: g/l, K/(l m) and c/(m l^2); the mass is therefore taken as known.
"""

from functools import cache

import sympy

from sim.model import Axis, Model, ParameterSpec, named_symbols, symbol
from sim.places import AxisPlace, InputPlace, Places, RotorPlace, SensorPlace

THETA, THETA_DOT = symbol("theta_rad"), symbol("theta_dot_rad_s")
U = symbol("u_V")

PARAMETERS = (
    ParameterSpec("m", 1, "kg", "positive"),
    ParameterSpec("l", 1, "m", "positive"),
    ParameterSpec("c", 1, "N m s", "non-negative"),
    ParameterSpec("K", 1, "N V^-1", "positive"),
    ParameterSpec("g", 1, "m s^-2", "positive"),
    ParameterSpec("u_max", 1, "V", "positive"),
)


@cache
def model() -> Model:
    """Eq (1) as a Model; the axis is written as a balance of torques, m l^2 theta'' = l K u - m g l sin(theta) - c theta'."""
    p = named_symbols(PARAMETERS)
    gravity = p["m"] * p["g"] * p["l"] * sympy.sin(THETA)
    torque = p["l"] * p["K"] * U - gravity - p["c"] * THETA_DOT
    return Model(
        name="aeroshield",
        states=(THETA, THETA_DOT),
        inputs=(U,),
        outputs={"theta_rad": THETA},
        parameters=PARAMETERS,
        rates={THETA: THETA_DOT},
        axes=(Axis("arm", THETA, THETA_DOT, p["m"] * p["l"] ** 2, torque, sympy.Integer(0), None, None),),
        input_limits={U: (sympy.Integer(0), p["u_max"])},
        places=Places(
            inputs={"input": InputPlace(U, "V", 3.7)},
            rotors={"rotor": RotorPlace(U, "", U, 3.7, {"arm": p["l"] * p["K"] * U}, 3.7, linear=True)},
            axes={
                "arm": AxisPlace("theta_rad", "N m", 0.004, gravity=-gravity, gravity_moment=p["m"] * p["g"] * p["l"])
            },
            sensors={"theta_sensor": SensorPlace("theta_rad", "rad", 1.0)},
        ),
    )
