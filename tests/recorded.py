"""Recordings of real rigs for tests: a run log, or a skip that says what is missing and where it comes from."""

from pathlib import Path

import pytest

from recordings.datasets.files import datasets_folder
from recordings.datasets.library import import_record
from records.errors import BadInput
from records.log import RunLog


def recorded(dataset: str, record: str) -> RunLog:
    """The record as a run log; the test is skipped where the dataset's folder is absent, never where a file in it is wrong."""
    dataset_folder(dataset)
    return import_record(dataset, record)


def dataset_folder(dataset: str) -> Path:
    """The folder of the dataset's files; the test is skipped where there is none."""
    folder = datasets_folder() / dataset
    if not folder.is_dir():
        with pytest.raises(BadInput) as missing:
            import_record(dataset, FIRST_RECORD[dataset])
        pytest.skip(str(missing.value))
    return folder


FIRST_RECORD = {
    "quanser_aero": "model_verification",
    "aeroshield": "ident_data",
    "antx_2dof_drone": "Lab01_part2__log_0",
    "emps": "DATA_EMPS",
    "pamh_aeropendulum": "PAMH_3set",
    "aeroshield_two_clocks": "dynamic_char",
    "maglev_coil": "c12",
    "torque_limited_pendulum": "sac",
}
