"""What happens to a signal on its way: stages with memory between command and rotor, or between axis and reading."""

from typing import Any, Protocol


class Stage(Protocol):
    """One stage: a piece of signal and the stage's memory go in, the signal behind it and the new memory come out."""

    def __call__(self, signal: Any, memory: Any) -> tuple[Any, Any]:
        """The signal behind the stage; memory None at the beginning."""
        ...
