"""How many float operations one step of a table's law takes: what a core without FPU spends its time on."""

from dataclasses import dataclass, field

from codegen.law_constants import law_constants
from codegen.law_equations import law_step, state_from_words, state_words
from codegen.law_frame import LawInput
from records.table import ControllerTable


@dataclass
class OperationCount:
    """Products and sums (differences included) of one step of all axes, in the unsaturated and the saturated case alike."""

    products: int = 0
    sums: int = 0


@dataclass(frozen=True)
class _Counted:
    count: OperationCount = field(compare=False)

    def __mul__(self, other: "_Counted") -> "_Counted":
        self.count.products += 1
        return self

    def __add__(self, other: "_Counted") -> "_Counted":
        self.count.sums += 1
        return self

    __sub__ = __add__


class _NoDecisions:
    """Every decision of the law passes its first value on."""

    def finite_or(self, value: _Counted, last: _Counted) -> _Counted:
        return value

    def clamp(self, value: _Counted, low: _Counted, high: _Counted) -> _Counted:
        return value

    def saturate(self, value: _Counted, low: _Counted, high: _Counted, safe: _Counted) -> _Counted:
        return value

    def settle(self, value: _Counted, least: _Counted) -> _Counted:
        return value

    def advanced(self, last: _Counted, step: _Counted, target: _Counted) -> _Counted:
        return last + step

    def is_plausible(self, value: _Counted, bound: _Counted) -> bool:
        return True

    def choose(self, condition: bool, value: _Counted, otherwise: _Counted) -> _Counted:
        return value


def operation_count(table: ControllerTable) -> OperationCount:
    """Counted by running the law once on numbers that only count; raises BadInput for a table whose law could not run."""
    count = OperationCount()
    number = _Counted(count)
    law = law_constants(table, lambda _: number)
    state = state_from_words(table, [number] * state_words(table))
    law_step(law, _NoDecisions(), state, LawInput.of([number] * (2 * len(table.loops))))
    return count
