"""The fixed-point law in Python integers: what the generated C must give, bit for bit."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from codegen.fixed.arithmetic import LaneWords, Scalars
from codegen.fixed.constants import fixed_constants, word_number
from codegen.fixed.duty import duty, duty_format
from codegen.fixed.equations import fixed_axis_state, law_reset, law_step, state_from_words
from codegen.fixed.formats import MISSING, count_format, law_formats, value_of, word_of
from codegen.law_frame import LawInput, LawState, state_size, words_from_state
from records.table import ControllerTable

Bits = NDArray[np.uint32]


class FixedTwin:
    """The fixed-point law of `table`: a controller of the closed loop, and many independent lanes at once."""

    name = "twin"
    arithmetic = "fixed"

    def __init__(self, table: ControllerTable) -> None:
        self.law = fixed_constants(table, word_number)
        self.formats = law_formats(table)
        self._table = table
        self.state_words = state_size(fixed_axis_state(table.order), len(table.loops))
        self.reset(*[0.0] * len(table.loops))

    def reset(self, *angles_rad: float) -> None:
        """Start afresh at these angles."""
        self._state: LawState[int] = law_reset(self.law, Scalars(), [self._angle(value) for value in angles_rad])

    def step(self, *given_rad: float) -> tuple[float, ...]:
        """One sample of references, then angles; returns the voltages within their limits."""
        given = LawInput.of([self._angle(value) for value in given_rad])
        self._state, voltages = law_step(self.law, Scalars(), self._state, given)
        return tuple(value_of(word, self.formats.voltage_places) for word in voltages)

    def start(self, angles: Bits) -> Bits:
        """States at rest, words [lanes, state_words], for angles as words [lanes, loops]."""
        return self._state_bits(law_reset(self.law, LaneWords(), tuple(_signed(angles).T)), len(angles))

    def run(self, states: Bits, inputs: Bits) -> tuple[Bits, Bits]:
        """All lanes through all steps: inputs [steps, lanes, 2 loops] as words give final states and outputs [steps, lanes, loops]."""
        steps, lanes = inputs.shape[:2]
        outputs = np.empty((steps, lanes, len(self.law.axes)), dtype=np.int64)
        # One lane goes faster as single numbers than as arrays of one.
        words: Any = Scalars() if lanes == 1 else LaneWords()
        columns: Any = (lambda rows: rows[0].tolist()) if lanes == 1 else np.transpose
        state = state_from_words(self.law, columns(_signed(states)))
        for given, output in zip(_signed(inputs), outputs, strict=True):
            state, voltages = law_step(self.law, words, state, LawInput.of(columns(given)))
            for index, word in enumerate(voltages):
                output[:, index] = word
        return self._state_bits(state, lanes), outputs.astype(np.uint32)

    def angle_from_counts(self, loop: int, counts: int) -> float:
        """Angle [rad] of an encoder count of the loop at this place."""
        form = count_format(self.formats, self._table.axes[loop])
        product = Scalars().clamp(counts, -form.limit, form.limit) * form.step
        return value_of((product + (1 << form.shift - 1)) >> form.shift, self.formats.angle_places)

    def duty(self, loop: int, u_V: float) -> int:
        """Signed PWM ticks of a voltage of the loop at this place."""
        form = duty_format(self._table.loops[loop].full_scale_V, self.formats.voltage_places)
        return duty(self.voltage_word(u_V), self.law.axes[loop].u_safe_V, form)

    def voltage_word(self, u_V: float) -> int:
        """The 32 bits of a voltage, as an unsigned integer."""
        return word_of(u_V, self.formats.voltage_places) % 2**32

    @property
    def missing_word(self) -> int:
        """The 32 bits of MISSING."""
        return MISSING % 2**32

    def _angle(self, angle_rad: float) -> int:
        return word_of(angle_rad, self.formats.angle_places)

    def _state_bits(self, state: LawState[Any], lanes: int) -> Bits:
        words = np.empty((lanes, self.state_words), dtype=np.int64)
        for index, word in enumerate(words_from_state(state)):
            words[:, index] = word
        return words.astype(np.uint32)


def _signed(bits: Bits) -> NDArray[np.int64]:
    return np.ascontiguousarray(bits).view(np.int32).astype(np.int64)
