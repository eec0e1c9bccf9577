"""What a user says of how a table of text is laid out."""

from dataclasses import dataclass


@dataclass(frozen=True)
class TextLayout:
    """Separator (a sign or its name) and decimal sign, None where they are to be found; lines to pass over at the beginning."""

    separator: str | None = None
    decimal: str | None = None
    skip: int = 0


FOUND = TextLayout()  # all of it is found
