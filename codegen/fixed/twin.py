"""The fixed-point law in Python integers: what the generated C must give, bit for bit."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from codegen.fixed.arithmetic import LaneWords, Scalars
from codegen.fixed.constants import fixed_constants, word_number
from codegen.fixed.equations import law_reset, law_step, state_from_words
from codegen.fixed.formats import MISSING, count_format, law_formats, value_of, word_of
from codegen.law_equations import STATE_WORDS, LawInput, LawState, words_from_state
from codegen.twin import FULL_SCALE_V, PWM_TICKS
from records.table import AxisLaw, ControllerTable

Bits = NDArray[np.uint32]


class FixedTwin:
    """The fixed-point law of `table`: a controller of the closed loop, and many independent lanes at once."""

    name = "twin"
    arithmetic = "fixed"

    def __init__(self, table: ControllerTable) -> None:
        self.law = fixed_constants(table, word_number)
        self.formats = law_formats(table)
        self._elevation, self._azimuth = table.elevation, table.azimuth
        self._state: LawState[int] = law_reset(self.law, Scalars(), 0, 0)

    def reset(self, psi_rad: float, phi_rad: float) -> None:
        """Start afresh at these angles."""
        self._state = law_reset(self.law, Scalars(), self._angle(psi_rad), self._angle(phi_rad))

    def step(self, psi_ref_rad: float, phi_ref_rad: float, psi_rad: float, phi_rad: float) -> tuple[float, float]:
        """One sample; returns (u_M_V, u_T_V) within their limits."""
        given = LawInput(*(self._angle(value) for value in (psi_ref_rad, phi_ref_rad, psi_rad, phi_rad)))
        self._state, output = law_step(self.law, Scalars(), self._state, given)
        places = self.formats.voltage_places
        return value_of(output.u_M_V, places), value_of(output.u_T_V, places)

    def start(self, angles: Bits) -> Bits:
        """States at rest, words [lanes, STATE_WORDS], for angles psi, phi as words [lanes, 2]."""
        psi_rad, phi_rad = _signed(angles).T
        return _state_bits(law_reset(self.law, LaneWords(), psi_rad, phi_rad), len(angles))

    def run(self, states: Bits, inputs: Bits) -> tuple[Bits, Bits]:
        """All lanes through all steps: inputs [steps, lanes, 4] as words give final states and outputs [steps, lanes, 2]."""
        steps, lanes = inputs.shape[:2]
        outputs = np.empty((steps, lanes, 2), dtype=np.int64)
        # One lane goes faster as single numbers than as arrays of one.
        words: Any = Scalars() if lanes == 1 else LaneWords()
        columns: Any = (lambda rows: rows[0].tolist()) if lanes == 1 else np.transpose
        state = state_from_words(columns(_signed(states)))
        for given, output in zip(_signed(inputs), outputs, strict=True):
            state, voltages = law_step(self.law, words, state, LawInput(*columns(given)))
            output[:, 0], output[:, 1] = voltages.u_M_V, voltages.u_T_V
        return _state_bits(state, lanes), outputs.astype(np.uint32)

    def angle_from_counts_psi(self, counts: int) -> float:
        """Elevation [rad] of an encoder count."""
        return self._angle_from_counts(self._elevation, counts)

    def angle_from_counts_phi(self, counts: int) -> float:
        """Azimuth [rad] of an encoder count."""
        return self._angle_from_counts(self._azimuth, counts)

    def duty_main(self, u_V: float) -> int:
        """Signed PWM ticks of the main rotor's voltage."""
        return duty(self.voltage_word(u_V), self.law.elevation.u_safe_V, self.formats.voltage_places)

    def duty_tail(self, u_V: float) -> int:
        """Signed PWM ticks of the tail rotor's voltage."""
        return duty(self.voltage_word(u_V), self.law.azimuth.u_safe_V, self.formats.voltage_places)

    def voltage_word(self, u_V: float) -> int:
        """The 32 bits of a voltage, as an unsigned integer."""
        return word_of(u_V, self.formats.voltage_places) % 2**32

    @property
    def missing_word(self) -> int:
        """The 32 bits of MISSING."""
        return MISSING % 2**32

    def _angle(self, angle_rad: float) -> int:
        return word_of(angle_rad, self.formats.angle_places)

    def _angle_from_counts(self, axis: AxisLaw, counts: int) -> float:
        form = count_format(self.formats, axis)
        product = Scalars().clamp(counts, -form.limit, form.limit) * form.step
        return value_of((product + (1 << form.shift - 1)) >> form.shift, self.formats.angle_places)


def duty_ratio(voltage_places: int) -> tuple[int, int]:
    """PWM ticks per voltage word of `voltage_places` as factor / 2^shift, in lowest terms; ValueError unless a volt is whole ticks."""
    ratio, shift = PWM_TICKS / FULL_SCALE_V, voltage_places
    if ratio != int(ratio):
        raise ValueError(f"{PWM_TICKS} ticks at {FULL_SCALE_V} V are not whole ticks per volt")
    factor = int(ratio)
    while factor % 2 == 0 and shift > 1:
        factor, shift = factor // 2, shift - 1
    return factor, shift


def duty(word: int, safe_V: int, voltage_places: int) -> int:
    """Ticks, full scale PWM_TICKS at FULL_SCALE_V, to the nearest, halves away from zero; MISSING gives the safe value's."""
    u_V = word - 2**32 if word >= 2**31 else word
    full_scale = word_number(FULL_SCALE_V, voltage_places)
    applied = Scalars().clamp(safe_V if u_V == MISSING else u_V, -full_scale, full_scale)
    factor, shift = duty_ratio(voltage_places)
    ticks = (abs(applied) * factor + (1 << shift - 1)) >> shift
    return ticks if applied >= 0 else -ticks


def _signed(bits: Bits) -> NDArray[np.int64]:
    return np.ascontiguousarray(bits).view(np.int32).astype(np.int64)


def _state_bits(state: LawState[Any], lanes: int) -> Bits:
    words = np.empty((lanes, STATE_WORDS), dtype=np.int64)
    for index, word in enumerate(words_from_state(state)):
        words[:, index] = word
    return words.astype(np.uint32)
