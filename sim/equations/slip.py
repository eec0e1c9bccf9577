"""What is wrong with a file of equations, in words."""

from dataclasses import dataclass
from typing import Any

from sim.equations.own_file import REMEDY


@dataclass(frozen=True)
class Slip:
    """What is wrong; `words` lead to its line: the first that the file holds."""

    words: tuple[str, ...]
    what: str
    got: str
    expected: str
    remedy: str = REMEDY


def listed(names: Any) -> str:
    """Names in a sentence."""
    return ", ".join(sorted(map(str, names))) or "none"
