"""Tables of text: decimal commas, stray columns, and the line of a cell that is no number."""

import numpy as np
import pytest

from recordings.datasets.texts import cells, column
from records.errors import BadInput


def test_a_spreadsheet_with_decimal_commas_and_stray_remarks_reads_by_column_name() -> None:
    content = "t ;u;y;;\n-0,4;1.5;0,25;;Valor máximo\n\n-0,38;2;0,5;;\n".encode("latin-1")
    header, rows = cells(content, ";", "sheet.csv")
    np.testing.assert_array_equal(column(header, rows, "t", "sheet.csv"), [-0.4, -0.38])
    np.testing.assert_array_equal(column(header, rows, "u", "sheet.csv"), [1.5, 2.0])
    np.testing.assert_array_equal(column(header, rows, "y", "sheet.csv"), [0.25, 0.5])


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"t,y\n0,1\n1,x\n", "line 3.*'x'"),
        (b"t,y\n0,1\n1\n", "line 3.*1 cells"),
        (b"t,z\n0,1\n", "'y'.*t, z"),
        (b"t,y\n", "1 lines"),
        (b"", "0 lines"),
    ],
)
def test_a_damaged_table_is_refused_with_its_line(content: bytes, said: str) -> None:
    with pytest.raises(BadInput, match=said):
        column(*cells(content, ",", "table.csv"), "y", "table.csv")
