"""A search for the input and state of the float32 law with the dearest step: how much of a static bound is reached.

`.venv/bin/python -m tests.verification.dearest [FILE.json]` prints what docs/proofs.md states of plants/ce150.toml, and keeps it there.
"""

import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from codegen.law import generate_law
from rig.emulator.board import EmulatedBoard
from rig.programming.image import build_firmware
from tests.docs.tables import keep
from tests.law_tables import STATE_WORDS
from tests.verification.cycles import stimuli
from twinlaw.workflows.chain.designing import design_controller
from verification.stimuli import Stimulus

TRIES = 3_000_000  # two minutes
CLIMBERS = 8  # the dearest of the starts, each of which is changed in turn
# Cycles that a change may lose, once in e times: dear steps lie apart, and a search that only climbs stays with one.
FIRST_LOSS, LAST_LOSS = 12.0, 0.3
INPUT_WORDS = 4
LEVELS = 3000  # starts of numbers of like magnitude, for which sums cancel
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
        return int(self.board.call("law_step", self.at, given, given + 4 * INPUT_WORDS).cycles)


def dearest(given: Sequence[Stimulus], elf: bytes, tries: int, seed: int = 1) -> int:
    """Most cycles of so many steps, by annealing from those of the stimuli that have states of their own and from like magnitudes."""
    rng, step = np.random.default_rng(seed), Step(elf)
    starts = [
        np.concatenate([state, words])
        for stimulus in given
        if stimulus.states is not None
        for state, words in zip(stimulus.states[:300], stimulus.inputs[0], strict=False)
    ]
    starts += [_level(rng) for _ in range(LEVELS)]
    climbers = sorted(starts, key=lambda words: -step.cycles(words))[:CLIMBERS]
    return max(_annealed(rng, step, words, tries // CLIMBERS) for words in climbers)


def _annealed(rng: np.random.Generator, step: Step, words: Words, tries: int) -> int:
    most = cycles = step.cycles(words)
    for loss in np.linspace(FIRST_LOSS, LAST_LOSS, tries):
        changed = _changed(rng, words)
        found = step.cycles(changed)
        if found >= cycles or rng.random() < np.exp((found - cycles) / loss):
            words, cycles = changed, found
        most = max(most, cycles)
    return most


def _level(rng: np.random.Generator) -> Words:
    """Numbers within a factor of 64 of one another, anywhere among the normal ones up to 8."""
    count = STATE_WORDS + INPUT_WORDS
    exponents = rng.integers(1, 130) + rng.integers(0, 6, count)
    return (rng.integers(0, 2, count) << 31 | exponents << 23 | rng.integers(0, 2**23, count)).astype(np.uint32)


def _changed(rng: np.random.Generator, words: Words) -> Words:
    """One to three of the words: a bit, the sign, the power of two, all bits, a few ulp; an ordinary number, or near another word."""
    changed = words.copy()
    for place in rng.integers(0, len(words), rng.integers(1, 4)):
        word, other = int(words[place]), int(words[rng.integers(0, len(words))])
        ordinary = np.float32(rng.normal() * 10.0 ** rng.uniform(-3.0, 1.0)).view(np.uint32)
        kinds = (
            word ^ 1 << int(rng.integers(0, 32)),
            word ^ 1 << 31,
            word + (int(rng.integers(-3, 4)) << 23),
            int(rng.integers(0, 2**32)),
            word + int(rng.integers(-64, 65)),
            int(ordinary),
            other + int(rng.integers(-2, 3)),
            other + (int(rng.integers(-26, 27)) << 23),
        )
        changed[place] = kinds[rng.integers(0, len(kinds))] & 0xFFFFFFFF
    return changed


if __name__ == "__main__":
    table = design_controller(Path("plants/ce150.toml")).table
    image = build_firmware(generate_law(table, "float32")).elf
    keep([("float32", dearest(stimuli(table, "float32", 4_000), image, TRIES))], sys.argv[1:])
