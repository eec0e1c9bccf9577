"""Which columns the logs of a plant have."""

from dataclasses import dataclass


@dataclass(frozen=True)
class LogColumns:
    """Columns of a plant's logs: its inputs and outputs always, any of `optional`, after `t_s`; `axes` can be locked."""

    plant: str
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    optional: tuple[str, ...]
    axes: tuple[str, ...]
