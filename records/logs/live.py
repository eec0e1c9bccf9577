"""A sample of a rig in motion, as it comes."""

from dataclasses import dataclass


@dataclass(frozen=True)
class LiveRow:
    """What a run log's row holds: outputs `y` measured at `t_s`, inputs `u` commanded from then on, and the references; SI units.

    NaN stands for what was not measured or not asked for. A row that `begins` another log does not follow the one before.
    """

    t_s: float
    u: tuple[float, ...]
    y: tuple[float, ...]
    reference: tuple[float, ...]
    begins: bool = False
