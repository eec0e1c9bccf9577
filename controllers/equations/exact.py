"""A controller's equations run in double precision (its float law) and in float32 (the exact twin of its C)."""

import math
from typing import Any

import numpy as np

from codegen.law_frame import AxisEquations, LawInput, law_reset, law_step
from codegen.twin import Float32Lanes, Float32Scalars, Float32Twin
from controllers.equations.frame import numbers_of
from records.law_table import LawTable


class ExactScalars(Float32Scalars):
    """Decisions on single float32 numbers."""

    def is_less(self, value: np.float32, other: np.float32) -> bool:
        return bool(value < other)


class Lanes(Float32Lanes):
    """Decisions on arrays of float32, one lane each."""

    def is_less(self, value: Any, other: Any) -> Any:
        return value < other


class Doubles:
    """The same decisions on Python's floats."""

    def finite_or(self, value: float, last: float) -> float:
        return value if math.isfinite(value) else last if math.isfinite(last) else 0.0

    def clamp(self, value: float, low: float, high: float) -> float:
        return low if value < low else high if high < value else value

    def saturate(self, value: float, low: float, high: float, safe: float) -> float:
        return safe if math.isnan(value) else self.clamp(value, low, high)

    def settle(self, value: float, least: float) -> float:
        return 0.0 if abs(value) < least else value

    def advanced(self, last: float, step: float, target: float) -> float:
        return last + step

    def is_plausible(self, value: float, bound: float) -> bool:
        return abs(value) <= bound

    def is_less(self, value: float, other: float) -> bool:
        return value < other

    def choose(self, condition: bool, value: float, otherwise: float) -> float:
        return value if condition else otherwise


class EquationLaw:
    """The float64 law of a table: `reset`, then `step` once a sample."""

    def __init__(self, equations: AxisEquations, table: LawTable[Any]) -> None:
        self._equations = equations
        self._law = numbers_of(table, float)
        self.reset(*[0.0] * len(table.loops))

    def reset(self, *angles_rad: float) -> None:
        """Start at rest at the measured angles."""
        self._state = law_reset(self._equations, self._law, Doubles(), angles_rad)

    def step(self, *given_rad: float) -> tuple[float, ...]:
        """One sample of references, then angles: the voltages."""
        self._state, voltages_V = law_step(self._equations, self._law, Doubles(), self._state, LawInput.of(given_rad))
        return voltages_V


class EquationTwin(Float32Twin):
    """The float32 law of a table, operation by operation as its C."""

    scalars: Any = ExactScalars()
    lanes: Any = Lanes()

    def __init__(self, equations: AxisEquations, table: LawTable[Any]) -> None:
        self._begin(table, numbers_of(table, np.float32), equations)
