"""A line of a table as its cells."""

import csv
import re

from records.errors import BadInput

SEPARATORS: dict[str, str | None] = {"comma": ",", "semicolon": ";", "tab": "\t", "bar": "|", "blanks": None}


def split(text: str, separator: str) -> list[str]:
    """The stripped cells of a line; quotes hold what is between them together."""
    sign = SEPARATORS[separator]
    if '"' in text:
        text = re.sub(r"\s+", " ", text.strip()) if sign is None else text
        return [cell.strip() for cell in next(csv.reader([text], delimiter=sign or " ", skipinitialspace=True))]
    return [cell.strip() for cell in text.split(sign)]


def name_of_separator(separator: str) -> str:
    """The name of a separator that a user gave as a sign or by its name; raises BadInput."""
    signs = {sign: name for name, sign in SEPARATORS.items() if sign} | {"\\t": "tab", " ": "blanks", "space": "blanks"}
    name = signs.get(separator, separator)
    if name not in SEPARATORS:
        known_names = ", ".join(f"{name} {sign!r}" if sign else name for name, sign in SEPARATORS.items())
        raise BadInput("separator", "--separator", repr(separator), f"one of {known_names}", "choose one of these")
    return name


def filled_cells(text: str, separator: str) -> int:
    """How many cells of a line there are up to its last filled one: a signal of few samples has none in most rows."""
    sign = SEPARATORS[separator]
    return len(text.split()) if sign is None else text.rstrip(f"{sign} \t").count(sign) + 1


def trimmed(row: list[str]) -> list[str]:
    """A row without the empty cells behind its last separator."""
    while len(row) > 1 and not row[-1]:
        row = row[:-1]
    return row
