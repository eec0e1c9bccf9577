"""A DC motor with an encoder.

(1)  L i' = u - R i - K omega
(2)  J omega' = K i - b omega - tau_c sgn(omega)
"""

from functools import cache

from sim.model import Axis, Model, ParameterSpec, named_symbols, symbol
from sim.places import AxisPlace, InputPlace, Places, SensorPlace

CURRENT = symbol("i_A")
THETA, OMEGA = symbol("theta_rad"), symbol("omega_rad_s")
U = symbol("u_V")

PARAMETERS = (
    ParameterSpec("R", 1, "V A^-1", "positive"),
    ParameterSpec("L", 1, "V s A^-1", "positive"),
    ParameterSpec("K", 1, "N m A^-1", "positive"),
    ParameterSpec("J", 1, "kg m^2", "positive"),
    ParameterSpec("b", 1, "N m s", "non-negative"),
    ParameterSpec("tau_c", 1, "N m", "non-negative"),
    ParameterSpec("u_max", 1, "V", "positive"),
)


@cache
def model() -> Model:
    """Eqs (1) and (2) as a Model."""
    p = named_symbols(PARAMETERS)
    torque = p["K"] * CURRENT - p["b"] * OMEGA
    return Model(
        name="dc_motor",
        states=(CURRENT, THETA, OMEGA),
        inputs=(U,),
        outputs={"theta_rad": THETA},
        parameters=PARAMETERS,
        rates={CURRENT: (U - p["R"] * CURRENT - p["K"] * OMEGA) / p["L"], THETA: OMEGA},
        axes=(Axis("shaft", THETA, OMEGA, p["J"], torque, p["tau_c"], None, None),),
        input_limits={U: (-p["u_max"], p["u_max"])},
        places=Places(
            inputs={"input": InputPlace(U, "V", 12.0)},
            axes={"shaft": AxisPlace("theta_rad", "N m", 0.02, speed_size=50.0)},
            sensors={"theta_sensor": SensorPlace("theta_rad", "rad")},
        ),
    )
