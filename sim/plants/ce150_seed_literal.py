"""The CE150 exactly as seed 000 prints it, for comparison: eq (15) on the azimuth and polynomials that know no negative speed.

The sign of the centrifugal torque is the parameter `cf_sign`, +1 in plants/ce150_seed_literal.toml.
"""

from dataclasses import replace
from functools import cache

from sim.model import Model, named_symbols, polynomial
from sim.plants import ce150
from sim.plants.ce150 import OMEGA_M, OMEGA_T, PARAMETERS, U_M, U_T


@cache
def model() -> Model:
    """The paper's literal equations (4)-(8) and (15) as a Model."""
    p = named_symbols(PARAMETERS)
    right = ce150.model()
    thrust_M_N, thrust_T_N = polynomial(p["p_FM"], OMEGA_M), polynomial(p["p_FT"], OMEGA_T)
    return replace(
        right,
        name="ce150_seed_literal",
        rates={
            **right.rates,
            OMEGA_M: p["K_M"] * U_M - polynomial(p["p_bM"], OMEGA_M) * OMEGA_M,
            OMEGA_T: p["K_T"] * U_T - polynomial(p["p_bT"], OMEGA_T) * OMEGA_T,
        },
        axes=(
            ce150.elevation(p, thrust_M_N),
            ce150.azimuth(p, thrust_T_N, inertia=p["J_A"]),
        ),
        places=ce150.places(p, thrust_M_N, thrust_T_N),
    )
