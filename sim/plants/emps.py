"""Electro-mechanical positioning system (DC motor and ball screw) of Janot, Gautier and Brunot, a benchmark of identification.

    (1)  M q'' = gtau u - F_v q' - F_c sgn(q') - offset

q the position of the carriage, u the motor voltage behind its limits, gtau the force for one volt.
"""

from functools import cache

from sim.model import Axis, Model, ParameterSpec, named_symbols, symbol
from sim.places import AxisPlace, InputPlace, Places, RotorPlace, SensorPlace

Q, Q_DOT = symbol("q_m"), symbol("q_dot_m_s")
U = symbol("u_V")

PARAMETERS = (
    ParameterSpec("M", 1, "kg", "positive"),
    ParameterSpec("F_v", 1, "N s m^-1", "non-negative"),
    ParameterSpec("F_c", 1, "N", "non-negative"),
    ParameterSpec("offset", 1, "N"),
    ParameterSpec("gtau", 1, "N V^-1", "positive"),
    ParameterSpec("u_max", 1, "V", "positive"),
)


@cache
def model() -> Model:
    """Eq (1) as a Model."""
    p = named_symbols(PARAMETERS)
    force = p["gtau"] * U - p["F_v"] * Q_DOT - p["offset"]
    return Model(
        name="emps",
        states=(Q, Q_DOT),
        inputs=(U,),
        outputs={"q_m": Q},
        parameters=PARAMETERS,
        rates={Q: Q_DOT},
        axes=(Axis("carriage", Q, Q_DOT, p["M"], force, p["F_c"], None, None),),
        input_limits={U: (-p["u_max"], p["u_max"])},
        places=Places(
            inputs={"input": InputPlace(U, "V", 10.0)},
            rotors={"motor": RotorPlace(U, "", U, 10.0, {"carriage": p["gtau"] * U}, 10.0, linear=True, two_way=True)},
            axes={"carriage": AxisPlace("q_m", "N", 100.0, length_unit="m", speed_size=0.1)},
            sensors={"q_sensor": SensorPlace("q_m", "m", 0.2)},
        ),
    )
