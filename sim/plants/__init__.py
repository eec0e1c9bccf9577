"""The name of a model in; its equations out: one file for each, and the table that alone names them all."""

from collections.abc import Callable, Mapping

from sim.model import Model
from sim.plants import (
    aeroshield,
    aeroshield_two_clocks,
    antx_2dof_drone,
    ce150,
    ce150_seed_literal,
    ce150_velagic,
    emps,
    maglev_coil,
    pamh_aeropendulum,
    quanser_aero,
    torque_limited_pendulum,
)

MODELS: Mapping[str, Callable[[], Model]] = {
    "ce150": ce150.model,
    "ce150_seed_literal": ce150_seed_literal.model,
    "ce150_velagic": ce150_velagic.model,
    "quanser_aero": quanser_aero.model,
    "aeroshield": aeroshield.model,
    "aeroshield_two_clocks": aeroshield_two_clocks.model,
    "antx_2dof_drone": antx_2dof_drone.model,
    "emps": emps.model,
    "pamh_aeropendulum": pamh_aeropendulum.model,
    "maglev_coil": maglev_coil.model,
    "torque_limited_pendulum": torque_limited_pendulum.model,
}
