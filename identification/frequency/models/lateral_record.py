"""Flights of the lateral/directional model as records: rates as they are read, accelerations carried to the centre of gravity."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from identification.frequency.flights.transfer import Transferred, lever_noise_m_s2, to_centre_of_gravity
from identification.frequency.lateral import INPUTS, MEASURED, OUTPUTS, UNITS
from identification.frequency.models.linear_model import LateralModel
from identification.frequency.responses.record import Record, record_of
from records.log import RunLog
from records.plant import Plant

Array = NDArray[np.float64]


def lateral_record(log: RunLog, name: str, plant: Plant) -> Record:
    """p, r and a_y at the centre of gravity, eq (4), from p, q, r and the accelerometer at r_s."""
    raw = record_of(log, name, MEASURED)
    a_y_m_s2 = _transferred(raw, plant).a_cg_m_s2[:, 1]
    return replace(raw, y=np.column_stack([raw.y[:, 0], raw.y[:, 2], a_y_m_s2]))


def _transferred(raw: Record, plant: Plant) -> Transferred:
    """Of readings p, q, r and a_y."""
    a_meas = np.zeros((raw.y.shape[0], 3))
    a_meas[:, 1] = raw.y[:, 3]
    return to_centre_of_gravity(a_meas, raw.y[:, :3], plant.parameters["r_s"].values, raw.period_s)


@dataclass(frozen=True, eq=False)
class LateralFlight:
    """A flight as it was flown: sticks u (n, 2), the roll rate, the accelerometer's reading a_y, and what the transfer makes of that.

    `noise_m_s2` is what noise of the rates leaves in a_y through the transfer, by the plant file's noise.
    """

    name: str
    t_s: Array
    u: Array
    p_rad_s: Array
    a_y_m_s2: Array
    transferred: Transferred
    noise_m_s2: float


def lateral_flight(log: RunLog, name: str, plant: Plant) -> LateralFlight:
    """Figs. 2 and 3 of seed 002 of one record."""
    raw = record_of(log, name, MEASURED)
    sd = [plant.sensor_noise.get(rate, 0.0) for rate in MEASURED[:3]]
    noise = lever_noise_m_s2(sd, plant.parameters["r_s"].values, raw.period_s)[1]
    t_s = np.asarray(raw.period_s * np.arange(raw.u.shape[0]), dtype=float)
    return LateralFlight(name, t_s, raw.u, raw.y[:, 0], raw.y[:, 3], _transferred(raw, plant), float(noise))


def lateral_records(logs: Mapping[str, RunLog], plant: Plant) -> tuple[Record, ...]:
    """All of them."""
    return tuple(lateral_record(log, name, plant) for name, log in logs.items())


def lateral_model(plant: Plant, names: tuple[str, ...] | None = None) -> LateralModel:
    """The model with the parameters `names` free, by default those whose sd is above 0."""
    free = names or tuple(name for name in UNITS if plant.parameters[name].sds[0] > 0.0)
    return LateralModel(plant, free, INPUTS, OUTPUTS)
