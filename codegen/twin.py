"""The law in NumPy float32, operation by operation: what the generated C must give, bit for bit.

NumPy neither fuses nor reorders: every + - * below is one IEEE 754 rounding, as in C built with -ffp-contract=off.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from codegen.law_constants import law_constants
from codegen.law_equations import scheduled_law
from codegen.law_frame import (
    AxisEquations,
    LawInput,
    LawState,
    law_reset,
    law_step,
    state_of_words,
    state_size,
    words_from_state,
)
from codegen.numbers import float32_bits
from records.law_table import FlownTable
from records.table import ControllerTable

Bits = NDArray[np.uint32]

PWM_TICKS = 3200


def same_bits(value: Any, other: Any) -> Any:
    """Condition that both are the same number, of the wider format of both, a zero of the other sign being another."""
    number = np.result_type(value, other)
    word = f"u{number.itemsize}"
    return np.asarray(value, number).view(word) == np.asarray(other, number).view(word)


def next_towards(last: Any, target: Any) -> Any:
    """The number next to `last` towards `target`; a zero that is reached from below is +0, as ranks have but one zero."""
    return np.nextafter(last, target) + np.float32(0.0)


class Float32Scalars:
    """Decisions of the law on single float32 numbers."""

    def finite_or(self, value: np.float32, last: np.float32) -> np.float32:
        if math.isfinite(value):
            return value
        return last if math.isfinite(last) else np.float32(0.0)

    def clamp(self, value: np.float32, low: np.float32, high: np.float32) -> np.float32:
        return low if value < low else high if high < value else value

    def saturate(self, value: np.float32, low: np.float32, high: np.float32, safe: np.float32) -> np.float32:
        return safe if math.isnan(value) else self.clamp(value, low, high)

    def settle(self, value: np.float32, least: np.float32) -> np.float32:
        return type(value)(0) if abs(value) < least else value

    def advanced(self, last: np.float32, step: np.float32, target: np.float32) -> np.float32:
        moved = last + step
        return next_towards(last, target) if same_bits(moved, last) and last != target else moved

    def is_plausible(self, value: np.float32, bound: np.float32) -> bool:
        return bool(abs(value) <= bound)

    def choose(self, condition: bool, value: np.float32, otherwise: np.float32) -> np.float32:
        return value if condition else otherwise


class Float32Lanes:
    """The same decisions on arrays of float32, one lane each."""

    def finite_or(self, value: Any, last: Any) -> Any:
        return np.where(np.isfinite(value), value, np.where(np.isfinite(last), last, np.float32(0.0)))

    def clamp(self, value: Any, low: Any, high: Any) -> Any:
        return np.where(value < low, low, np.where(high < value, high, value))

    def saturate(self, value: Any, low: Any, high: Any, safe: Any) -> Any:
        return np.where(np.isnan(value), safe, self.clamp(value, low, high))

    def settle(self, value: Any, least: Any) -> Any:
        return np.where(np.abs(value) < least, np.float32(0.0), value)

    def advanced(self, last: Any, step: Any, target: Any) -> Any:
        moved = last + step
        return np.where(same_bits(moved, last) & (last != target), next_towards(last, target), moved)

    def is_plausible(self, value: Any, bound: Any) -> Any:
        return np.abs(value) <= bound

    def choose(self, condition: Any, value: Any, otherwise: Any) -> Any:
        return np.where(condition, value, otherwise)


class Float32Twin:
    """The float32 law of `table`: a controller of the closed loop, and many independent lanes at once."""

    name = "twin"
    arithmetic = "float32"

    def __init__(self, table: ControllerTable) -> None:
        self._begin(table, law_constants(table, np.float32), scheduled_law(table.order))

    def _begin(self, table: FlownTable, law: Any, equations: AxisEquations) -> None:
        self.law: Any = law
        self._equations = equations
        self._resolutions_rad = [np.float32(axis.resolution_rad) for axis in table.axes]
        self._full_scales_V = [loop.full_scale_V for loop in table.loops]
        self._loops = len(table.loops)
        self.state_words = state_size(equations.AxisState, self._loops)
        self.reset(*[0.0] * self._loops)

    def reset(self, *angles_rad: float) -> None:
        """Start afresh at these angles."""
        angles = tuple(np.float32(angle) for angle in angles_rad)
        self._state: LawState[np.float32] = law_reset(self._equations, self.law, self.scalars, angles)

    def step(self, *given_rad: float) -> tuple[float, ...]:
        """One sample of references, then angles; returns the voltages within their limits."""
        given = LawInput.of([np.float32(value) for value in given_rad])
        with np.errstate(all="ignore"):
            self._state, voltages_V = law_step(self._equations, self.law, self.scalars, self._state, given)
        return tuple(float(u_V) for u_V in voltages_V)

    def start(self, angles: Bits) -> Bits:
        """States at rest, bits [lanes, state_words], for angles as bits [lanes, loops]."""
        state = law_reset(self._equations, self.law, self.lanes, tuple(_numbers(angles).T))
        return self._bits_of_state(state, len(angles))

    def run(self, states: Bits, inputs: Bits) -> tuple[Bits, Bits]:
        """All lanes through all steps: inputs [steps, lanes, 2 loops] as bits give final states and outputs [steps, lanes, loops].

        Columns of the inputs are the references, then the angles, of all loops, those of the outputs the voltages.
        """
        steps, lanes = inputs.shape[:2]
        outputs = np.empty((steps, lanes, self._loops), dtype=np.float32)
        # One lane goes faster as single numbers than as arrays of one.
        decisions: Any = self.scalars if lanes == 1 else self.lanes
        columns: Any = (lambda rows: rows[0]) if lanes == 1 else np.transpose
        state = state_of_words(columns(_numbers(states)), self._equations.AxisState, self._loops)
        with np.errstate(all="ignore"):
            for given, output in zip(_numbers(inputs), outputs, strict=True):
                state, voltages_V = law_step(self._equations, self.law, decisions, state, LawInput.of(columns(given)))
                output[:] = np.transpose(voltages_V)
        return self._bits_of_state(state, lanes), outputs.view(np.uint32)

    def angle_from_counts(self, loop: int, counts: int) -> np.float32:
        """Angle [rad] of an encoder count of the loop at this place."""
        return np.float32(np.float32(counts) * self._resolutions_rad[loop])

    def duty(self, loop: int, u_V: float) -> int:
        """Signed PWM ticks of a voltage of the loop at this place."""
        return _duty(np.float32(u_V), self.law.axes[loop].u_safe_V, self._full_scales_V[loop])

    def voltage_word(self, u_V: float) -> int:
        """The bits of a voltage."""
        return float32_bits(u_V)

    @property
    def missing_word(self) -> int:
        """The bits of the quiet NaN."""
        return 0x7FC00000

    def _bits_of_state(self, state: LawState[Any], lanes: int) -> Bits:
        words = np.empty((lanes, self.state_words), dtype=np.float32)
        for index, word in enumerate(words_from_state(state)):
            words[:, index] = word
        return words.view(np.uint32)

    scalars: Any = Float32Scalars()
    lanes: Any = Float32Lanes()


def _duty(u_V: np.float32, safe_V: np.float32, scale_V: float) -> int:
    """Ticks, PWM_TICKS at a full scale of `scale_V`, to the nearest, halves away from zero; total for every float."""
    full_scale_V = np.float32(scale_V)
    applied_V = Float32Scalars().saturate(u_V, -full_scale_V, full_scale_V, safe_V)
    half_ticks = int(applied_V * np.float32(2.0 * PWM_TICKS / scale_V))
    return (half_ticks + 1) // 2 if half_ticks >= 0 else -((1 - half_ticks) // 2)


def _numbers(bits: Bits) -> NDArray[np.float32]:
    return np.ascontiguousarray(bits).view(np.float32)
