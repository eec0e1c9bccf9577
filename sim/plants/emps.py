"""Electro-mechanical positioning system (DC motor and ball screw) of Janot, Gautier and Brunot, a benchmark of identification.

    (1)  M q'' = gtau u - F_v q' - F_c sgn(q') - offset

q the position of the carriage, u the motor voltage behind its limits, gtau the force for one volt.
"""

from functools import cache

from sim.model import Axis, Model, ParameterSpec, named_symbols, symbol

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
    )
