"""The coil of a magnetic levitation rig whose ball is held, as Bocchio01/062020-Lab-Mechatronics models it (commit 0d77d8e5).

    (1)  L i' = k d - R i

i the current, d the duty of the driver, 0 to 1, k the voltage at full duty. Nothing moves: the plant has no axis.
Only k/L and R/L show in the current; the voltage is therefore taken as known.
"""

from functools import cache

import sympy

from sim.model import Model, ParameterSpec, named_symbols, symbol
from sim.places import InputPlace, Places, SensorPlace

CURRENT = symbol("i_A")
DUTY = symbol("u_1")

PARAMETERS = (
    ParameterSpec("k", 1, "V", "positive"),
    ParameterSpec("R", 1, "V A^-1", "positive"),
    ParameterSpec("L", 1, "V s A^-1", "positive"),
)


@cache
def model() -> Model:
    """Eq (1) as a Model."""
    p = named_symbols(PARAMETERS)
    return Model(
        name="maglev_coil",
        states=(CURRENT,),
        inputs=(DUTY,),
        outputs={"i_A": CURRENT},
        parameters=PARAMETERS,
        rates={CURRENT: (p["k"] * DUTY - p["R"] * CURRENT) / p["L"]},
        axes=(),
        input_limits={DUTY: (sympy.Integer(0), sympy.Integer(1))},
        places=Places(
            inputs={"input": InputPlace(DUTY, "-", 1.0)},
            sensors={"i_sensor": SensorPlace("i_A", "A", 2.7)},
        ),
    )
