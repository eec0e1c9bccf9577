"""A report as one self-contained HTML page: sentences, tables and SVG plots, no script and no network."""

import re
from collections.abc import Sequence
from dataclasses import dataclass

from jinja2 import Environment, FileSystemLoader, StrictUndefined

from records.quality import Colour
from records.text.zeros import unsigned_zeros
from twinlaw.templates import TEMPLATES

Row = tuple[str, ...]


@dataclass(frozen=True)
class Table:
    """Rows of text under an optional heading; `folded` is what stands in the place of a table that opens at a click, "" of one that
    is open."""

    rows: Sequence[Sequence[str]]
    heading: Sequence[str] = ()
    folded: str = ""


@dataclass(frozen=True)
class Section:
    """One part of the page: what it says, then its tables, then its plots (SVG text)."""

    title: str
    sentences: Sequence[str] = ()
    tables: Sequence[Table] = ()
    plots: Sequence[str] = ()


@dataclass(frozen=True)
class Page:
    """A report: its verdict in one sentence, the colour of that and why, and named facts under it (digests, files)."""

    title: str
    verdict: str
    colour: Colour
    why: str
    facts: Sequence[tuple[str, str]]
    sections: Sequence[Section]


def as_sentence(note: str) -> str:
    """A note as a sentence of its own on a page: its first word with a capital letter, unless that is a name, and a full stop."""
    first = note.partition(" ")[0]
    begun = note[:1].upper() + note[1:] if first.isalpha() and first.islower() else note
    return begun if begun.endswith((".", "?", "!")) else f"{begun}."


def with_units(cell: str) -> str:
    """A cell in which no line ends between a number and what follows it."""
    return re.sub(r"(?<=\d) (?=[A-Za-z%])", "\u00a0", cell)


def parts(sentence: str) -> list[str]:
    """A sentence in parts, every second of which is an option and is broken into no lines; nor is one before a per cent sign."""
    return re.split(r"(--[a-z][a-z-]*)", sentence.replace(" %", "\u00a0%"))


def page_text(page: Page) -> str:
    """The page as HTML text; text is escaped, plots are not."""
    environment = Environment(
        loader=FileSystemLoader(TEMPLATES),
        undefined=StrictUndefined,
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["unsigned_zeros"] = unsigned_zeros
    environment.filters["parts"] = parts
    environment.filters["with_units"] = with_units
    facts = {name: getattr(page, name) for name in Page.__dataclass_fields__}
    return environment.get_template("report.html.j2").render(facts)
