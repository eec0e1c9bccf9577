"""A controller's equations run in double precision (its float law) and in float32 (the exact twin of its C)."""

import math
from dataclasses import fields
from typing import Any

import numpy as np

from codegen.law_frame import (
    LAST_ACCEPTED_FIELDS,
    AxisEquations,
    LawInput,
    LawOutput,
    LawState,
    law_reset,
    law_step,
    state_of_words,
)
from codegen.twin import Float32Lanes, Float32Scalars, Float32Twin
from controllers.frame import numbers_of
from records.law_table import LawTable


class Scalars(Float32Scalars):
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
        self._state = law_reset(equations, self._law, Doubles(), 0.0, 0.0)

    def reset(self, psi_rad: float, phi_rad: float) -> None:
        """Start at rest at the measured angles."""
        self._state = law_reset(self._equations, self._law, Doubles(), psi_rad, phi_rad)

    def step(self, psi_ref_rad: float, phi_ref_rad: float, psi_rad: float, phi_rad: float) -> tuple[float, float]:
        """One sample: u_M_V, u_T_V."""
        given = LawInput(psi_ref_rad, phi_ref_rad, psi_rad, phi_rad)
        self._state, output = law_step(self._equations, self._law, Doubles(), self._state, given)
        return output.u_M_V, output.u_T_V


class EquationTwin(Float32Twin):
    """The float32 law of a table, operation by operation as its C."""

    scalars: Any = Scalars()
    lanes: Any = Lanes()

    def __init__(self, equations: AxisEquations, table: LawTable[Any]) -> None:
        self._equations = equations
        self.law = numbers_of(table, np.float32)
        self.resolution_psi_rad = np.float32(table.elevation.resolution_rad)
        self.resolution_phi_rad = np.float32(table.azimuth.resolution_rad)
        self.state_words = state_words(equations)
        self._state = self._at_rest(0.0, 0.0)

    def law_reset(self, decisions: Any, psi_rad: Any, phi_rad: Any) -> LawState[Any]:
        """The state at rest."""
        return law_reset(self._equations, self.law, decisions, psi_rad, phi_rad)

    def law_step(
        self, decisions: Any, state: LawState[Any], given: LawInput[Any]
    ) -> tuple[LawState[Any], LawOutput[Any]]:
        """One sample."""
        return law_step(self._equations, self.law, decisions, state, given)

    def state_from_words(self, words: Any) -> LawState[Any]:
        """A state from its numbers."""
        return state_of_words(words, self._equations.AxisState)


def state_words(equations: AxisEquations) -> int:
    """Numbers that a controller remembers, both axes and the last accepted inputs."""
    return 2 * len(fields(equations.AxisState)) + len(LAST_ACCEPTED_FIELDS)  # type: ignore[arg-type]
