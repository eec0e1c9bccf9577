"""Numbers whose thousands stand apart, and those of which nobody can say whether they do."""

import re
from collections.abc import Sequence
from dataclasses import replace

from recordings.formats.text.cells import is_missing, may_be_grouped, number, without_groups
from recordings.formats.text.lines import Line
from recordings.formats.text.splitting import SEPARATORS, split


def ungrouped(lines: Sequence[Line], separator: str, decimal: str) -> list[Line]:
    """The lines with numbers whose thousands stood apart as plain ones."""
    sign = SEPARATORS[separator] or " "
    return [
        replace(
            line, text=sign.join(_whole(without_groups(cell, decimal), sign) for cell in split(line.text, separator))
        )
        for line in lines
    ]


def _whole(cell: str, sign: str) -> str:
    return f'"{cell}"' if sign in cell else cell


def are_thousands(rows: Sequence[Sequence[str]]) -> bool:
    """Whether a point parts thousands wherever one stands: `999` and `1.000` in one column, which no way to print decimals writes."""
    return bool(_beside_whole(rows)) and all(
        may_be_grouped(cell, ",") for row in rows for cell in row if _is_pointed(cell)
    )


def doubtful(rows: Sequence[Sequence[str]]) -> tuple[str, ...]:
    """What is said of such a column where the point is the decimal sign of others."""
    return tuple(
        f"{told} is read with a decimal point; if it parts the thousands, say --decimal ,"
        for told in _beside_whole(rows)
    )


def _beside_whole(rows: Sequence[Sequence[str]]) -> list[str]:
    """`1.000 beside 999` of the first column that has both and numbers of no other kind; empty without one."""
    for column in zip(*rows, strict=False):
        cells = [cell for cell in column if number(cell, ".") is not None and not is_missing(cell)]
        pointed = [cell for cell in cells if _is_pointed(cell)]
        forms = all(re.fullmatch(r"-?[1-9]\d{0,2}(\.\d{3})?|0", cell) for cell in cells)
        if forms and len(pointed) < len(cells) and any(cell.endswith("0") for cell in pointed):
            return [f"{pointed[0]} beside {next(cell for cell in cells if not _is_pointed(cell))}"]
    return []


def _is_pointed(cell: str) -> bool:
    return "." in cell and number(cell, ".") is not None
