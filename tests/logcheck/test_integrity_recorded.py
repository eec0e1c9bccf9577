"""Published recordings of real rigs go through the integrity checks whole: no row left out, none refused. Skipped without them.

In a soak all of them, else one of each dataset.
"""

import pytest

from logcheck.integrity import examine
from recordings.datasets.library import import_record, records
from tests.plants import bound
from tests.recorded import FIRST_RECORD, dataset_folder
from tests.soak import SOAK


@pytest.mark.parametrize("dataset", FIRST_RECORD)
def test_no_row_of_a_published_recording_is_left_out_and_none_is_refused(dataset: str) -> None:
    dataset_folder(dataset)
    plant = bound(dataset)
    for record in records(dataset) if SOAK else [FIRST_RECORD[dataset]]:
        found = examine([import_record(dataset, record)], plant, names=[record])
        assert not found.refusals, record
        assert not found.logs[0].excluded.any(), record
