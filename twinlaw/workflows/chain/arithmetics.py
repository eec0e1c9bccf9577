"""The arithmetics of the law: what each is verified with."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

from codegen.fixed.controllers import fixed_controllers
from codegen.fixed.twin import FixedTwin
from codegen.twin import Float32Twin
from design.analysis.rounding import FLOAT32, Rounding
from records.table import ControllerTable
from records.verification import RoundingBound
from verification.equality import BatchStepper
from verification.fixed_rounding import fixed_rounding_bound
from verification.fixed_stimuli import fixed_sequences, fixed_stimuli
from verification.ranges import Motion
from verification.rounding import rounding_bound
from verification.stimuli import Stimulus, sequences, standard_stimuli


class Bound(Protocol):
    """A proof of how far one step is from real arithmetic."""

    def __call__(self, table: ControllerTable, motion: Motion) -> RoundingBound: ...


@dataclass(frozen=True)
class Arithmetic:
    """The exact model of one arithmetic, stimuli for it with and without set states, its proof, and what it makes of controllers."""

    twin: Callable[[ControllerTable], BatchStepper]
    stimuli: Callable[[ControllerTable, int], Sequence[Stimulus]]
    sequences: Callable[[Any, int], Sequence[Stimulus]]  # float32 takes any table
    bound: Bound
    rounding: Rounding


ARITHMETICS: Mapping[str, Arithmetic] = {
    "float32": Arithmetic(Float32Twin, standard_stimuli, sequences, rounding_bound, FLOAT32),
    "fixed": Arithmetic(
        FixedTwin, fixed_stimuli, fixed_sequences, fixed_rounding_bound, Rounding("fixed", fixed_controllers)
    ),
}
