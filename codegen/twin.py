"""The law in NumPy float32, operation by operation: what the generated C must give, bit for bit.

NumPy neither fuses nor reorders: every + - * below is one IEEE 754 rounding, as in C built with -ffp-contract=off.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from codegen.law_constants import law_constants
from codegen.law_equations import (
    STATE_WORDS,
    LawInput,
    LawOutput,
    LawState,
    law_reset,
    law_step,
    state_from_words,
    words_from_state,
)
from codegen.numbers import float32_bits
from records.table import ControllerTable

Bits = NDArray[np.uint32]

PWM_TICKS = 3200
FULL_SCALE_V = 10.0


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
        self.law: Any = law_constants(table, np.float32)
        self.resolution_psi_rad = np.float32(table.elevation.resolution_rad)
        self.resolution_phi_rad = np.float32(table.azimuth.resolution_rad)
        self._state: LawState[np.float32] = self._at_rest(0.0, 0.0)

    def reset(self, psi_rad: float, phi_rad: float) -> None:
        """Start afresh at these angles."""
        self._state = self._at_rest(psi_rad, phi_rad)

    def step(self, psi_ref_rad: float, phi_ref_rad: float, psi_rad: float, phi_rad: float) -> tuple[float, float]:
        """One sample; returns (u_M_V, u_T_V) within their limits."""
        given = LawInput(*(np.float32(value) for value in (psi_ref_rad, phi_ref_rad, psi_rad, phi_rad)))
        with np.errstate(all="ignore"):
            self._state, output = self.law_step(self.scalars, self._state, given)
        return float(output.u_M_V), float(output.u_T_V)

    def start(self, angles: Bits) -> Bits:
        """States at rest, bits [lanes, STATE_WORDS], for angles psi, phi as bits [lanes, 2]."""
        psi_rad, phi_rad = _numbers(angles).T
        return self._bits_of_state(self.law_reset(self.lanes, psi_rad, phi_rad), len(angles))

    def run(self, states: Bits, inputs: Bits) -> tuple[Bits, Bits]:
        """All lanes through all steps: inputs [steps, lanes, 4] as bits give final states and outputs [steps, lanes, 2].

        Columns of the inputs are psi_ref_rad, phi_ref_rad, psi_rad, phi_rad, those of the outputs u_M_V, u_T_V.
        """
        steps, lanes = inputs.shape[:2]
        outputs = np.empty((steps, lanes, 2), dtype=np.float32)
        # One lane goes faster as single numbers than as arrays of one.
        decisions: Any = self.scalars if lanes == 1 else self.lanes
        columns = (lambda rows: rows[0]) if lanes == 1 else np.transpose
        state = self.state_from_words(columns(_numbers(states)))
        with np.errstate(all="ignore"):
            for given, output in zip(_numbers(inputs), outputs, strict=True):
                state, voltages = self.law_step(decisions, state, LawInput(*columns(given)))
                output[:, 0], output[:, 1] = voltages.u_M_V, voltages.u_T_V
        return self._bits_of_state(state, lanes), outputs.view(np.uint32)

    def angle_from_counts_psi(self, counts: int) -> np.float32:
        """Elevation [rad] of an encoder count."""
        return np.float32(np.float32(counts) * self.resolution_psi_rad)

    def angle_from_counts_phi(self, counts: int) -> np.float32:
        """Azimuth [rad] of an encoder count."""
        return np.float32(np.float32(counts) * self.resolution_phi_rad)

    def duty_main(self, u_V: float) -> int:
        """Signed PWM ticks of the main rotor's voltage."""
        return _duty(np.float32(u_V), self.law.elevation.u_safe_V)

    def duty_tail(self, u_V: float) -> int:
        """Signed PWM ticks of the tail rotor's voltage."""
        return _duty(np.float32(u_V), self.law.azimuth.u_safe_V)

    def voltage_word(self, u_V: float) -> int:
        """The bits of a voltage."""
        return float32_bits(u_V)

    @property
    def missing_word(self) -> int:
        """The bits of the quiet NaN."""
        return 0x7FC00000

    def _at_rest(self, psi_rad: float, phi_rad: float) -> LawState[np.float32]:
        return self.law_reset(self.scalars, np.float32(psi_rad), np.float32(phi_rad))

    def _bits_of_state(self, state: LawState[Any], lanes: int) -> Bits:
        words = np.empty((lanes, self.state_words), dtype=np.float32)
        for index, word in enumerate(words_from_state(state)):
            words[:, index] = word
        return words.view(np.uint32)

    # What the law is: another law's twin replaces these.

    scalars: Any = Float32Scalars()
    lanes: Any = Float32Lanes()
    state_words = STATE_WORDS

    def law_reset(self, decisions: Any, psi_rad: Any, phi_rad: Any) -> LawState[Any]:
        """The state at rest."""
        return law_reset(self.law, decisions, psi_rad, phi_rad)

    def law_step(
        self, decisions: Any, state: LawState[Any], given: LawInput[Any]
    ) -> tuple[LawState[Any], LawOutput[Any]]:
        """One sample."""
        return law_step(self.law, decisions, state, given)

    def state_from_words(self, words: Any) -> LawState[Any]:
        """A state from its numbers."""
        return state_from_words(words)


def _duty(u_V: np.float32, safe_V: np.float32) -> int:
    """Ticks, full scale PWM_TICKS at FULL_SCALE_V, to the nearest, halves away from zero; total for every float."""
    full_scale_V = np.float32(FULL_SCALE_V)
    applied_V = Float32Scalars().saturate(u_V, -full_scale_V, full_scale_V, safe_V)
    half_ticks = int(applied_V * np.float32(2.0 * PWM_TICKS / FULL_SCALE_V))
    return (half_ticks + 1) // 2 if half_ticks >= 0 else -((1 - half_ticks) // 2)


def _numbers(bits: Bits) -> NDArray[np.float32]:
    return np.ascontiguousarray(bits).view(np.float32)
