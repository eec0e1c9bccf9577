"""Recordings are found by name, read only when unchanged, and become valid run logs; what is missing is said with its origin."""

import shutil
from pathlib import Path

import numpy as np
import pytest

from recordings.datasets.files import datasets_folder, verified_bytes
from recordings.datasets.library import IMPORTERS, import_record, records
from recordings.datasets.registry import dataset, datasets
from records.errors import BadInput
from records.log import load_log, save_log
from sim.plants import MODELS
from tests.recorded import FIRST_RECORD, dataset_folder, recorded
from tests.soak import SOAK

NO_RUN = {"identified_model_data.mat"}  # parameters of a model


def test_the_registry_names_origin_licence_and_hashes_of_every_dataset() -> None:
    assert set(datasets()) == set(IMPORTERS) == set(FIRST_RECORD)
    for name, entry in datasets().items():
        assert name in MODELS
        assert "/" in entry.repository
        assert entry.commit
        assert entry.licence
        assert entry.citation
        assert all(len(digest) == 64 and int(digest, 16) >= 0 for digest in entry.files.values())


@pytest.mark.parametrize("name", list(IMPORTERS))
def test_every_record_becomes_a_log_that_reads_back_equal(name: str, tmp_path: Path) -> None:
    """In a soak every record, else one of each dataset: they are read by the same code, and saved by one for all."""
    dataset_folder(name)
    for record in records(name) if SOAK else [FIRST_RECORD[name]]:
        log = import_record(name, record)
        path = tmp_path / "log.csv"
        save_log(path, log)
        again = load_log(path, log.columns)
        assert again.source == log.source
        assert (again.loop, again.locked, again.sample_period_s) == (log.loop, log.locked, log.sample_period_s)
        for column in ("t_s", *log.columns.inputs, *log.columns.outputs, *log.extra):
            np.testing.assert_array_equal(again.column(column), log.column(column))


@pytest.mark.parametrize("name", list(IMPORTERS))
def test_every_file_of_the_registry_is_read_by_some_record(name: str) -> None:
    dataset_folder(name)
    read: set[str] = set()

    def load(file: str) -> bytes:
        read.add(file)
        return verified_bytes(dataset(name), file)

    for record in records(name):
        IMPORTERS[name].read(record, load)
    assert read == set(dataset(name).files) - NO_RUN


@pytest.mark.parametrize("name", list(IMPORTERS))
def test_a_missing_file_is_named_with_its_origin_and_the_way_to_give_it(name: str, tmp_path: Path) -> None:
    with pytest.raises(BadInput) as missing:
        import_record(name, FIRST_RECORD[name], tmp_path)
    message = str(missing.value)
    for part in (str(tmp_path), dataset(name).repository, dataset(name).commit, "TWINLAW_DATASETS"):
        assert part in message


def test_a_file_with_one_changed_bit_is_refused(tmp_path: Path) -> None:
    source = dataset_folder("pamh_aeropendulum") / "PAMH_3set.csv"
    changed = bytearray(source.read_bytes())
    changed[-3] ^= 1
    target = tmp_path / "pamh_aeropendulum" / source.name
    target.parent.mkdir()
    target.write_bytes(bytes(changed))
    with pytest.raises(BadInput, match=r"SHA-256.*fetch it again"):
        import_record("pamh_aeropendulum", "PAMH_3set", tmp_path)


def test_the_environment_names_another_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    source = dataset_folder("pamh_aeropendulum")
    expected = recorded("pamh_aeropendulum", "PAMH_3set")
    shutil.copytree(source, tmp_path / "pamh_aeropendulum")
    monkeypatch.setenv("TWINLAW_DATASETS", str(tmp_path))
    assert datasets_folder() == tmp_path
    np.testing.assert_array_equal(import_record("pamh_aeropendulum", "PAMH_3set").y, expected.y)


@pytest.mark.parametrize(
    ("name", "record", "meant"),
    [
        ("quanser_aero", "dynamic_coupling/free_pitch", "dynamic_coupling_free_pitch"),
        ("quanser_aero", "model_verification/full_model.mat", "full_model"),
        ("aeroshield", "val_data.txt", "val_data"),
        ("aeroshield", "Identification_Data", "Identification_Data"),
        ("antx_2dof_drone", "Lab01_part2 log_1", "Lab01_part2__log_1_2024-5-22-17-23-18_2dd"),
        ("aeroshield_two_clocks", "dynamic", "dynamic_char"),
    ],
)
def test_a_record_is_found_by_its_path_or_its_beginning(name: str, record: str, meant: str) -> None:
    log = recorded(name, record)
    assert log.source is not None
    assert log.source.record == meant


@pytest.mark.parametrize(("name", "record"), [("emps", "nothing"), ("antx_2dof_drone", "Lab01"), ("emps", "")])
def test_an_unknown_or_ambiguous_record_lists_those_there_are(name: str, record: str) -> None:
    with pytest.raises(BadInput) as unknown:
        import_record(name, record)
    assert all(known in str(unknown.value) for known in records(name))


def test_an_unknown_dataset_lists_those_there_are() -> None:
    with pytest.raises(BadInput) as unknown:
        import_record("nothing", "x")
    assert all(known in str(unknown.value) for known in datasets())
