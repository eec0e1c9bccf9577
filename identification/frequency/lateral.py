"""The lateral/directional model of a helicopter in forward flight, eqs (1) to (3) of seed 002, in SI units.

    x = [v p r phi],  u = [delta_lat delta_ped],  x' = A x + B u,  y = C x + D u,  y = [p r a_y]

        | Y_v  Y_p + W_0  Y_r - U_0       g cos(Theta_0) |        | Y_lat  Y_ped |
    A = | L_v  L_p        L_r             0              |    B = | L_lat  L_ped |
        | N_v  N_p        N_r             0              |        | N_lat  N_ped |
        | 0    1          cos(Phi_0) tan(Theta_0)      0 |        | 0      0     |

    a_y = v' + U_0 r - W_0 p - g cos(Theta_0) phi = Y_v v + Y_p p + Y_r r + Y_lat delta_lat + Y_ped delta_ped

a_y is what an accelerometer at the centre of gravity reads. The text of eq (8) has lost every sign; `PLANT` in plants/raptor50.toml has
them as physics demands. One cause fixes most: the tail rotor's force -k (v - l r + h p), behind and above the centre of gravity, makes
Y_v, Y_p, L_v, N_r negative and Y_r, L_r, N_v positive; printed with W_0 and U_0, 2.6336 = Y_p + W_0 and -25.8835 = Y_r - U_0 agree with
that. Rolling is damped (L_p < 0), sticks to the right roll and push to the right (L_lat, Y_lat > 0), a right pedal turns to the right
(N_ped > 0) by a force to the left at the tail (Y_ped, L_ped < 0). N_p and N_lat are left: |N_p / L_p| = 0.334 and |N_lat / L_lat| = 0.364
are so near that both come from one cause, the product of inertia of a high tail, which gives both the sign of L: N_p < 0, N_lat > 0.

Two more slips: the element g cos(Theta_0) is printed 32.174 ft/s^2, which is g; with 4.48 deg it is 32.076. And cos(Phi_0) tan(Theta_0)
is 0.0783, printed 0.08. Both are known, not estimated, and computed here. The unit of the sticks is not stated; `delta` counts in it.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from logcheck.facts import PlantFacts
from records.errors import BadInput
from records.logs.columns import LogColumns
from records.plant import Plant
from records.text.units import dimensions

Array = NDArray[np.float64]
MODEL = "lateral_directional"
INPUTS = ("delta_lat", "delta_ped")
OUTPUTS = ("p_rad_s", "r_rad_s", "a_y_m_s2")
MEASURED = ("p_rad_s", "q_rad_s", "r_rad_s", "a_y_m_s2")
STATES = ("v_m_s", "p_rad_s", "r_rad_s", "phi_rad")
UNITS: Mapping[str, str] = {
    "Y_v": "s^-1", "Y_p": "m s^-1", "Y_r": "m s^-1",
    "L_v": "rad m^-1 s^-1", "L_p": "s^-1", "L_r": "s^-1",
    "N_v": "rad m^-1 s^-1", "N_p": "s^-1", "N_r": "s^-1",
    "Y_lat": "m s^-2", "Y_ped": "m s^-2",
    "L_lat": "rad s^-2", "L_ped": "rad s^-2",
    "N_lat": "rad s^-2", "N_ped": "rad s^-2",
    "U_0": "m s^-1", "W_0": "m s^-1", "Theta_0": "rad", "Phi_0": "rad", "g": "m s^-2", "r_s": "m",
}  # fmt: skip
LENGTHS: Mapping[str, int] = {"r_s": 3}


@dataclass(frozen=True, eq=False)
class StateSpace:
    """x' = A x + B u, y = C x + D u; shapes (n, n), (n, m), (k, n), (k, m)."""

    A: Array
    B: Array
    C: Array
    D: Array


def log_columns() -> LogColumns:
    """Columns of a flight's log: sticks, the body's rates, the accelerometer's lateral reading where it is mounted."""
    return LogColumns(MODEL, INPUTS, MEASURED, (), ())


def lateral_facts(plant: Plant) -> PlantFacts:
    """What its plant file fixes about its logs; the pitch rate q answers no stick."""
    moved_by = {name: frozenset(INPUTS if name in OUTPUTS else ()) for name in MEASURED}
    return PlantFacts(dict(plant.sensors), {}, {}, frozenset(), moved_by)


def check_plant(plant: Plant) -> None:
    """Raise BadInput for a missing or unknown parameter or sensor, a wrong count or unit."""
    where = f"plant {plant.name!r}"
    for kind, wanted, got in (("parameter", tuple(UNITS), plant.parameters), ("sensor", MEASURED, plant.sensors)):
        for name in (*wanted, *got):
            if name not in got or name not in wanted:
                state = "nothing" if name not in got else "an unknown name"
                raise BadInput(f"{kind} {name!r}", where, state, f"{', '.join(wanted)}", "add, remove or rename it")
    for name, entry in plant.parameters.items():
        count = LENGTHS.get(name, 1)
        if len(entry.values) != count or dimensions(entry.unit) != dimensions(UNITS[name]):
            got_text = f"{len(entry.values)} values in {entry.unit!r}"
            raise BadInput(f"parameters.{name}", where, got_text, f"{count} in {UNITS[name]!r}", "correct it")


def state_space(value: Mapping[str, float]) -> StateSpace:
    """Eq (3) and the outputs from the parameters by name, SI."""
    U, W, k = value["U_0"], value["W_0"], value["g"] * np.cos(value["Theta_0"])
    Y, L, N = (np.array([value[f"{row}_{column}"] for column in "vpr"]) for row in "YLN")
    turning = np.cos(value["Phi_0"]) * np.tan(value["Theta_0"])
    A = np.array([[Y[0], Y[1] + W, Y[2] - U, k], [*L, 0.0], [*N, 0.0], [0.0, 1.0, turning, 0.0]])
    B = np.array([[value[f"{row}_{stick}"] for stick in ("lat", "ped")] for row in "YLN"] + [[0.0, 0.0]])
    C = np.array([[0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [*Y, 0.0]])
    return StateSpace(A, B, C, np.vstack([np.zeros((2, 2)), B[0]]))
