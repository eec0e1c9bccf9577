"""Tables of pages that a program of the tests prints: rows of names and whole numbers, and the file in which they are kept."""

import json
from collections.abc import Sequence
from pathlib import Path


def keep(rows: Sequence[Sequence[str | int]], told: Sequence[str]) -> None:
    """Print the rows as a page has them, and keep them in the file that the command line names behind its options, if it does."""
    print("\n".join(line(row) for row in rows))
    if told:
        Path(told[0]).write_text("[\n" + ",\n".join(f" {json.dumps(row)}" for row in rows) + "\n]\n", encoding="utf-8")


def line(row: Sequence[str | int]) -> str:
    """A row of a page's table."""
    return f"| {' | '.join(cell if isinstance(cell, str) else grouped(cell) for cell in row)} |"


def grouped(count: int) -> str:
    """A count as pages write it: 11 994, and 5533."""
    return f"{count:,}".replace(",", " ")
