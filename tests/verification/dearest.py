"""A search for the input and state of the float32 law with the dearest step: how much of a static bound is reached."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from rig.emulator.board import EmulatedBoard
from tests.law_tables import STATE_WORDS
from verification.stimuli import Stimulus

CLIMBERS = 12  # the dearest of the random steps, each of which is changed as long as it gets no cheaper
Words = NDArray[np.uint32]


class Step:
    """One step of an image's law on words for its state, then its input."""

    def __init__(self, elf: bytes) -> None:
        self.board = EmulatedBoard(elf)
        self.at = self.board.scratch_address()

    def cycles(self, words: Words) -> int:
        """What it takes, flash without wait states."""
        self.board.write_memory(self.at, words.tobytes())
        given = self.at + 4 * STATE_WORDS
        return int(self.board.call("law_step", self.at, given, given + 16).cycles)


def dearest(stimuli: Sequence[Stimulus], elf: bytes, tries: int, seed: int = 1) -> int:
    """Most cycles of so many steps, which begin from those of the `stimuli` that have states of their own."""
    rng, step = np.random.default_rng(seed), Step(elf)
    starts = [
        np.concatenate([state, given])
        for stimulus in stimuli
        if stimulus.states is not None
        for state, given in zip(stimulus.states[:300], stimulus.inputs[0], strict=False)
    ]
    climbers = sorted(((step.cycles(words), words) for words in starts), key=lambda found: -found[0])[:CLIMBERS]
    for turn in range(tries):
        cycles, words = climbers[turn % CLIMBERS]
        changed = _changed(rng, words)
        if (found := step.cycles(changed)) >= cycles:
            climbers[turn % CLIMBERS] = found, changed
    return max(cycles for cycles, _ in climbers)


def _changed(rng: np.random.Generator, words: Words) -> Words:
    """One to three of the words: a bit turned, a power of two more or less, any bits, a few ulp, an ordinary number."""
    changed = words.copy()
    for place in rng.integers(0, len(words), rng.integers(1, 4)):
        word = int(words[place])
        ordinary = np.float32(rng.normal() * 10.0 ** rng.uniform(-3.0, 1.0)).view(np.uint32)
        kinds = (
            word ^ 1 << int(rng.integers(0, 32)),
            word + (int(rng.integers(-3, 4)) << 23),
            int(rng.integers(0, 2**32)),
            word + int(rng.integers(-64, 65)),
            int(ordinary),
        )
        changed[place] = kinds[rng.integers(0, len(kinds))] & 0xFFFFFFFF
    return changed
