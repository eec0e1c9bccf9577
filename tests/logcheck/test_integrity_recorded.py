"""Every published recording of a real rig goes through the integrity checks whole: no row left out, none refused. Skipped without them."""

import pytest

from logcheck.integrity import examine
from recordings.datasets.library import import_record, records
from tests.plants import bound
from tests.recorded import FIRST_RECORD, dataset_folder


@pytest.mark.parametrize("dataset", FIRST_RECORD)
def test_no_row_of_a_published_recording_is_left_out_and_none_is_refused(dataset: str) -> None:
    dataset_folder(dataset)
    plant = bound(dataset)
    for record in records(dataset):
        found = examine([import_record(dataset, record)], plant, names=[record])
        assert not found.refusals, record
        assert not found.logs[0].excluded.any(), record
