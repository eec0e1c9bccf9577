"""Who flies the real rigs: commands of an open loop from a trim found by hand, or references with a PID and what it is given besides."""

from collections.abc import Callable, Mapping

from numpy.random import Generator

from blind.rigs.real import one_axis, two_axes
from blind.rigs.real.orders import Asked, Orders
from blind.rigs.real.plant import RealPlant
from blind.simulation.ce150 import Rig

# Of the logs.
CLOSED_SHARE = {
    "ce150": 0.6,
    "aeroshield": 0.3,
    "emps": 0.7,
    "quanser_aero": 0.5,
    "antx_2dof_drone": 0.6,
    "dc_motor": 0.5,
}


def opened(plant: RealPlant, true: Rig, asked: Asked, rng: Generator) -> Orders:
    """Commands made beforehand, about a trim that the operator found on the rig itself."""
    return OPEN[plant.name](true, asked, rng)


def closed(plant: RealPlant, nominal: Rig, asked: Asked, rng: Generator) -> Orders:
    """References, and a controller that knows the rig as it is stated."""
    return CLOSED[plant.name](nominal, asked, rng)


Operator = Callable[[Rig, Asked, Generator], Orders]
OPEN: Mapping[str, Operator] = {
    "ce150": two_axes.ce150_open,
    "aeroshield": one_axis.aeroshield_open,
    "emps": one_axis.emps_open,
    "quanser_aero": two_axes.aero_open,
    "antx_2dof_drone": one_axis.antx_open,
    "dc_motor": one_axis.motor_open,
}
CLOSED: Mapping[str, Operator] = {
    "ce150": two_axes.ce150_closed,
    "aeroshield": one_axis.aeroshield_closed,
    "emps": one_axis.emps_closed,
    "quanser_aero": two_axes.aero_closed,
    "antx_2dof_drone": one_axis.antx_closed,
    "dc_motor": one_axis.motor_closed,
}
