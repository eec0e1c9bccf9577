"""The generated C, compiled for this computer and called through cffi: a controller, and many lanes at once."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from codegen.fixed.formats import value_of, word_of
from codegen.law import generate_law
from records.loops import LOOPS, Loop
from records.table import ControllerTable
from toolchain.host import STRICT_FLOAT_FLAGS, CText, build_shared, load_shared
from verification.drivers import driver

Bits = NDArray[np.uint32]

# Numbers of the law cross the border as their 32 bits, whatever their arithmetic.
_DECLARATIONS = """
    uint32_t law_batch_state_words(void);
    void law_batch_start(uint32_t lanes, const void *angles_rad, void *states);
    void law_batch_run(uint32_t steps, uint32_t lanes, void *states, const void *inputs, void *outputs);
    void law_batch_angles(uint32_t count, const void *counts, void *angles_rad);
    void law_batch_duties(uint32_t count, const void *voltages, void *ticks);
    uint32_t law_self_test(void);
    extern const uint8_t LAW_TABLE_DIGEST[32];
"""


@dataclass(frozen=True)
class Places:
    """Places of angles and voltages of a fixed-point law."""

    angle: int
    voltage: int


class HostLaw:
    """A compiled law: `reset` and `step` for the closed loop, `start` and `run` on bits of many lanes for comparisons."""

    name = "host"
    declarations = _DECLARATIONS

    def __init__(
        self,
        texts: Mapping[str, str],
        arithmetic: str = "float32",
        flags: Sequence[str] = STRICT_FLOAT_FLAGS,
        loops: tuple[Loop, ...] = LOOPS,
    ) -> None:
        """Compile the generated `texts` (file name -> C) of a law of `loops` with `flags`; raises BadInput when the compiler refuses."""
        sources = [CText(name, text) for name, text in texts.items()]
        library = build_shared(f"law-{arithmetic}", [*sources, driver("law_batch.c", loops)], flags=flags)
        self.arithmetic = arithmetic
        self._places = _places(texts["law.h"]) if arithmetic == "fixed" else None
        self._ffi, self._lib = load_shared(self.declarations, library)
        self.state_words = int(self._lib.law_batch_state_words())
        self._loops, word = len(loops), "int32_t" if arithmetic == "fixed" else "float"
        self._given = self._ffi.new(f"{word}[{2 * self._loops}]")
        self._answered = self._ffi.new(f"{word}[{self._loops}]")
        self.reset(*[0.0] * self._loops)

    def reset(self, *angles_rad: float) -> None:
        """Start afresh at these angles."""
        self._state = self.start(self._angles(*angles_rad))
        self._remembered = self._pointer(self._state)

    def step(self, *given_rad: float) -> tuple[float, ...]:
        """One sample of references, then angles; returns the voltages within their limits."""
        self._given[0 : len(given_rad)] = given_rad if self._places is None else self._words(given_rad)
        self._lib.law_batch_run(1, 1, self._remembered, self._given, self._answered)
        if self._places is None:
            return tuple(self._answered)
        return tuple(value_of(word, self._places.voltage) for word in self._answered)

    def start(self, angles: Bits) -> Bits:
        """States at rest, bits [lanes, words], for angles as bits [lanes, loops]."""
        states = np.zeros((len(angles), self.state_words), dtype=np.uint32)
        self._lib.law_batch_start(len(angles), self._pointer(angles), self._pointer(states))
        return states

    def run(self, states: Bits, inputs: Bits) -> tuple[Bits, Bits]:
        """All lanes through all steps: inputs [steps, lanes, 2 loops] as bits give final states and outputs [steps, lanes, loops]."""
        steps, lanes = inputs.shape[:2]
        after = states.copy()
        outputs = np.empty((steps, lanes, self._loops), dtype=np.uint32)
        self._lib.law_batch_run(steps, lanes, self._pointer(after), self._pointer(inputs), self._pointer(outputs))
        return after, outputs

    def angles_from_counts(self, counts: NDArray[np.int32]) -> Bits:
        """Angles as bits [n, loops] of encoder counts [n, loops]."""
        angles = np.empty(counts.shape, dtype=np.uint32)
        self._lib.law_batch_angles(len(counts), self._pointer(counts), self._pointer(angles))
        return angles

    def duties(self, voltages: Bits) -> NDArray[np.int32]:
        """Signed PWM ticks [n, loops] of voltages as bits [n, loops]."""
        ticks = np.empty(voltages.shape, dtype=np.int32)
        self._lib.law_batch_duties(len(voltages), self._pointer(voltages), self._pointer(ticks))
        return ticks

    def self_test(self) -> int:
        """Mismatches that the emitted self-test finds."""
        return int(self._lib.law_self_test())

    def table_digest(self) -> str:
        """The digest compiled into the law."""
        return bytes(self._lib.LAW_TABLE_DIGEST).hex()

    def _angles(self, *angles_rad: float) -> Bits:
        if self._places is None:
            return np.array([angles_rad], dtype=np.float32).view(np.uint32)
        return np.array([self._words(angles_rad)], dtype=np.int32).view(np.uint32)

    def _words(self, angles_rad: Sequence[float]) -> list[int]:
        assert self._places is not None
        return [word_of(angle, self._places.angle) for angle in angles_rad]

    def _pointer(self, array: NDArray[Any]) -> Any:
        # The C would read a strided view, or numbers of another width, as if they were dense 32-bit words.
        if not array.flags["C_CONTIGUOUS"] or array.itemsize != 4:
            raise ValueError(f"arrays for the C must be contiguous and of 32-bit words, not {array.dtype}")
        return self._ffi.from_buffer(array)


def host_law(table: ControllerTable, arithmetic: str = "float32") -> HostLaw:
    """The law of `table`, generated and compiled with strict float flags."""
    return HostLaw(generate_law(table, arithmetic), arithmetic, loops=table.loops)


def _places(header: str) -> Places:
    """The formats of the numbers that cross the border of a fixed-point law."""
    angle, voltage = (
        int(found.group(1))
        for name in ("ANGLE", "VOLTAGE")
        if (found := re.search(rf"#define LAW_{name}_PLACES (\d+)", header))
    )
    return Places(angle, voltage)
