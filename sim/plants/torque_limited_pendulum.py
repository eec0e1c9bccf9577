"""A rigid pendulum on a quasi-direct drive, of dfki-ric-underactuated-lab/torque_limited_simple_pendulum (commit ed17ea2d).

    (1)  J theta'' = tau - b theta' - G sin(theta) - tau_c sgn(theta')

theta from where the pendulum hangs; tau the torque of the drive, G the torque that gravity has of a level pendulum.
"""

from functools import cache

import sympy

from sim.model import Axis, Model, ParameterSpec, named_symbols, symbol
from sim.places import AxisPlace, InputPlace, Places, RotorPlace, SensorPlace

THETA, THETA_DOT = symbol("theta_rad"), symbol("theta_dot_rad_s")
TAU = symbol("tau_Nm")

PARAMETERS = (
    ParameterSpec("J", 1, "kg m^2", "positive"),
    ParameterSpec("G", 1, "N m", "positive"),
    ParameterSpec("b", 1, "N m s", "non-negative"),
    ParameterSpec("tau_c", 1, "N m", "non-negative"),
    ParameterSpec("tau_max", 1, "N m", "positive"),
)
COMMANDED_NM = 2.0  # the limit that the authors' own simulation has for the torque of a swing-up


@cache
def model() -> Model:
    """Eq (1) as a Model."""
    p = named_symbols(PARAMETERS)
    gravity = -p["G"] * sympy.sin(THETA)
    drive = RotorPlace(TAU, "", TAU, COMMANDED_NM, {"pendulum": TAU}, COMMANDED_NM, linear=True, two_way=True)
    pendulum = AxisPlace("theta_rad", "N m", 3.0, speed_size=5.0, gravity=gravity, gravity_moment=p["G"])
    torque = TAU - p["b"] * THETA_DOT + gravity
    return Model(
        name="torque_limited_pendulum",
        states=(THETA, THETA_DOT),
        inputs=(TAU,),
        outputs={"theta_rad": THETA},
        parameters=PARAMETERS,
        rates={THETA: THETA_DOT},
        axes=(Axis("pendulum", THETA, THETA_DOT, p["J"], torque, p["tau_c"], None, None),),
        input_limits={TAU: (-p["tau_max"], p["tau_max"])},
        places=Places(
            inputs={"input": InputPlace(TAU, "N m", COMMANDED_NM)},
            rotors={"drive": drive},
            axes={"pendulum": pendulum},
            sensors={"theta_sensor": SensorPlace("theta_rad", "rad", 3.0)},
        ),
    )
