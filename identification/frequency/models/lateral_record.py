"""Flights of the lateral/directional model as records: rates as they are read, accelerations carried to the centre of gravity."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from identification.frequency.flights.transfer import to_centre_of_gravity
from identification.frequency.lateral import INPUTS, MEASURED, OUTPUTS, UNITS
from identification.frequency.models.linear_model import LateralModel
from identification.frequency.responses.record import Record, record_of
from records.log import RunLog
from records.plant import Plant


def lateral_record(log: RunLog, name: str, plant: Plant) -> Record:
    """p, r and a_y at the centre of gravity, eq (4), from p, q, r and the accelerometer at r_s."""
    raw = record_of(log, name, MEASURED)
    omega, a_meas = raw.y[:, :3], np.zeros((raw.y.shape[0], 3))
    a_meas[:, 1] = raw.y[:, 3]
    a_cg = to_centre_of_gravity(a_meas, omega, plant.parameters["r_s"].values, raw.period_s)
    return replace(raw, y=np.column_stack([omega[:, 0], omega[:, 2], a_cg[:, 1]]))


def lateral_records(logs: Mapping[str, RunLog], plant: Plant) -> tuple[Record, ...]:
    """All of them."""
    return tuple(lateral_record(log, name, plant) for name, log in logs.items())


def lateral_model(plant: Plant, names: tuple[str, ...] | None = None) -> LateralModel:
    """The model with the parameters `names` free, by default those whose sd is above 0."""
    free = names or tuple(name for name in UNITS if plant.parameters[name].sds[0] > 0.0)
    return LateralModel(plant, free, INPUTS, OUTPUTS)
