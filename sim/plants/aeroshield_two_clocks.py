"""An AeroShield whose logs carry the host's and the board's clock: a pendulum pushed in proportion to the duty of its motor.

    (1)  theta'' = b u - w2 sin(theta) - d theta'

theta from where the arm hangs; u the mean motor voltage, the PWM duty times u_max; t_s is the board's clock.
"""

from functools import cache

import sympy

from sim.model import TIME, Axis, Model, ParameterSpec, named_symbols, symbol
from sim.places import AxisPlace, InputPlace, Places, RotorPlace, SensorPlace

THETA, THETA_DOT = symbol("theta_rad"), symbol("theta_dot_rad_s")
U = symbol("u_V")

PARAMETERS = (
    ParameterSpec("b", 1, "rad s^-2 V^-1", "positive"),
    ParameterSpec("w2", 1, "s^-2", "positive"),
    ParameterSpec("d", 1, "s^-1", "non-negative"),
    ParameterSpec("u_max", 1, "V", "positive"),
)


@cache
def model() -> Model:
    """Eq (1) as a Model, scaled to a moment of inertia of 1."""
    p = named_symbols(PARAMETERS)
    torque = p["b"] * U - p["w2"] * sympy.sin(THETA) - p["d"] * THETA_DOT
    return Model(
        name="aeroshield_two_clocks",
        states=(THETA, THETA_DOT),
        inputs=(U,),
        outputs={"theta_rad": THETA},
        parameters=PARAMETERS,
        rates={THETA: THETA_DOT},
        axes=(Axis("arm", THETA, THETA_DOT, sympy.Integer(1), torque, sympy.Integer(0), None, None),),
        input_limits={U: (sympy.Integer(0), p["u_max"])},
        signals={"t_host_s": TIME},  # ideally the same time
        places=Places(
            inputs={"input": InputPlace(U, "V", 3.7)},
            rotors={"rotor": RotorPlace(U, "", U, 3.7, {"arm": p["b"] * U}, 3.7, linear=True)},
            axes={
                "arm": AxisPlace(
                    "theta_rad",
                    "rad s^-2",
                    90.0,
                    speed_size=3.0,
                    gravity=-p["w2"] * sympy.sin(THETA),
                    gravity_moment=p["w2"],
                )
            },
            sensors={"theta_sensor": SensorPlace("theta_rad", "rad", 1.0)},
        ),
    )
