"""A line of a text file by its number."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Line:
    """A line of a file that is neither empty nor a comment, by its number from 1."""

    number: int
    text: str
