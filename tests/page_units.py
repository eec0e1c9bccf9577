"""Numbers of a page's tables that say no unit: not in their cell, the heading of their column, the row's name or a column of units."""

import re
from html.parser import HTMLParser

NUMBER = re.compile(r"[+-]?\d[\d.]*(e[+-]?\d+)?( (\.\.|to|/) [+-]?\d[\d.]*(e[+-]?\d+)?)?")
BARE = {  # what has none: counts, names, ratios, and figures in the unit of their row's criterion
    *("holds", "samples", "row", "bits", "how many", "worst", "green up to", "amber up to", "flash", "bytes"),
    *("correlation", "coherence", "cost J", "misfit", "z", "weight", "octaves", "radius, open", "closed", "Ms"),
    *("gain up / down", "linear rms / polynomial rms"),
}  # fmt: skip


class _Tables(HTMLParser):
    """The rows of cells of each table."""

    def __init__(self) -> None:
        super().__init__()
        self.tables: list[list[list[str]]] = []
        self.inside = False

    def handle_starttag(self, tag: str, attrs: object) -> None:
        if tag == "table":
            self.tables.append([])
        elif tag == "tr":
            self.tables[-1].append([])
        elif tag in ("td", "th"):
            self.tables[-1][-1].append("")
            self.inside = True

    def handle_endtag(self, tag: str) -> None:
        self.inside = self.inside and tag not in ("td", "th")

    def handle_data(self, data: str) -> None:
        if self.inside:
            self.tables[-1][-1][-1] += data


def without_unit(page: str) -> list[tuple[str, str]]:
    """Heading and cell of each number for which no unit is said."""
    parser = _Tables()
    parser.feed(page)
    assert parser.tables
    return [found for heading, *rows in parser.tables if "unit" not in heading for found in _bare(heading, rows)]


def _bare(heading: list[str], rows: list[list[str]]) -> list[tuple[str, str]]:
    whole = "[" in heading[0]  # the unit of the table
    return [
        (title, cell)
        for row in rows
        for title, cell in zip(heading, row, strict=False)
        if NUMBER.fullmatch(cell.strip())
        and not (whole or "[" in row[0] or "[" in title or "%" in title or title in BARE)
    ]
