"""A search for the input and state of the float32 law with the dearest step: how much of a static bound is reached.

`.venv/bin/python -m tests.verification.dearest [FILE.json]` prints what docs/proofs.md states of plants/ce150.toml, and keeps it there,
with the step's words: the next search goes on from them.
"""

import json
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from codegen.law import generate_law
from rig.emulator.board import EmulatedBoard
from rig.programming.image import build_firmware
from tests.docs.reading.tables import keep
from tests.law_tables import STATE_WORDS
from tests.verification.cycles import stimuli, subnormals
from twinlaw.workflows.chain.designing import design_controller
from verification.stimuli import Stimulus

TRIES = 3_000_000  # five minutes
CLIMBERS = 6  # the dearest of the starts, each of which is changed in turn
# Behind them the dearest are crossed: what the axes remember costs by itself, so the parts of two dear steps make a dearer one.
CROSSED, ROUND, KEPT = 0.5, 30_000, 10
# Cycles that a change may lose, once in e times: dear steps lie apart, and a search that only climbs stays with one.
FIRST_LOSS, LAST_LOSS = 12.0, 0.3
INPUT_WORDS = 4
LEVELS = (
    3000  # starts of numbers of like magnitude, for which sums cancel, and as many of subnormal, tiny and ordinary ones
)
FOUND = Path(__file__).parents[2] / "docs" / "results" / "dearest.json"
Words = NDArray[np.uint32]


def known() -> Words:
    """The dearest step that a search has found so far."""
    ((_, _, words),) = json.loads(FOUND.read_text(encoding="utf-8"))
    return np.array([int(word, 16) for word in words.split()], dtype=np.uint32)


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


def dearest(given: Sequence[Stimulus], elf: bytes, tries: int, seed: int = 1) -> tuple[int, Words]:
    """The dearest of so many steps, its cycles and its words: by annealing from the known one, those of the stimuli that have states of
    their own, and numbers of two kinds, and by crossing what comes of it.
    """
    rng, step = np.random.default_rng(seed), Step(elf)
    starts = [
        np.concatenate([state, words])
        for stimulus in given
        if stimulus.states is not None
        for state, words in zip(stimulus.states[:300], stimulus.inputs[0], strict=False)
    ]
    starts += [known(), *(make(rng) for make in (_level, _mixed) for _ in range(LEVELS))]
    climbers = sorted(starts, key=lambda words: -step.cycles(words))[:CLIMBERS]
    alone = int((1.0 - CROSSED) * tries) // CLIMBERS
    found = sorted((_annealed(rng, step, words, alone, FIRST_LOSS) for words in climbers), key=_cost, reverse=True)
    for _ in range(int(CROSSED * tries) // ROUND):
        child = _crossed(rng, *(found[place][1] for place in rng.integers(0, len(found), 2)))
        entry = _annealed(rng, step, child, ROUND, float(rng.uniform(3.0, FIRST_LOSS)))
        if not any(np.array_equal(entry[1], words) for _, words in found):
            found = sorted([*found, entry], key=_cost, reverse=True)[:KEPT]
    return found[0]


def _cost(entry: tuple[int, Words]) -> int:
    return entry[0]


def _annealed(rng: np.random.Generator, step: Step, words: Words, tries: int, first_loss: float) -> tuple[int, Words]:
    """The dearest step on the way, and its words."""
    cycles = step.cycles(words)
    most, best = cycles, words
    for loss in np.linspace(first_loss, LAST_LOSS, tries):
        changed = _changed(rng, words)
        found = step.cycles(changed)
        if found >= cycles or rng.random() < np.exp((found - cycles) / loss):
            words, cycles = changed, found
        if found > most:
            most, best = found, changed
    return most, best


def _crossed(rng: np.random.Generator, one: Words, other: Words) -> Words:
    """One step with what an axis remembers of the other, or with its input and last accepted numbers."""
    axis = (STATE_WORDS - INPUT_WORDS) // 2
    ends = (0, axis, 2 * axis, len(one))
    part = int(rng.integers(0, 3))
    child = one.copy()
    child[ends[part] : ends[part + 1]] = other[ends[part] : ends[part + 1]]
    return child


def _mixed(rng: np.random.Generator) -> Words:
    """Subnormal, ordinary and tiny numbers, in any shares."""
    count = STATE_WORDS + INPUT_WORDS
    ordinary = rng.normal(0.0, 1.0, count).astype(np.float32).view(np.uint32)
    tiny = (
        (10.0 ** rng.uniform(-39.0, -30.0, count) * rng.choice([-1.0, 1.0], count)).astype(np.float32).view(np.uint32)
    )
    shares = rng.dirichlet([2.0, 1.0, 1.0])
    return np.choose(rng.choice(3, count, p=shares), [subnormals(rng, (count,)), ordinary, tiny]).astype(np.uint32)


def _level(rng: np.random.Generator) -> Words:
    """Numbers within a factor of 64 of one another, anywhere among the normal ones up to 8."""
    count = STATE_WORDS + INPUT_WORDS
    exponents = rng.integers(1, 130) + rng.integers(0, 6, count)
    return (rng.integers(0, 2, count) << 31 | exponents << 23 | rng.integers(0, 2**23, count)).astype(np.uint32)


def _changed(rng: np.random.Generator, words: Words) -> Words:
    """One to three of the words: a bit, the sign, the power of two, all bits, a few ulp, fewer places; a subnormal or an ordinary number,
    or near another word or its negative."""
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
            (other ^ 1 << 31) + int(rng.integers(-2, 3)),
            word & 1 << 31 | (word & 0x7FFFFFFF) >> int(rng.integers(1, 3)),
            int(rng.integers(0, 2)) << 31 | int(rng.integers(1, 0x800000)) >> int(rng.integers(0, 23)),
        )
        changed[place] = kinds[rng.integers(0, len(kinds))] & 0xFFFFFFFF
    return changed


if __name__ == "__main__":
    table = design_controller(Path("plants/ce150.toml")).table
    image = build_firmware(generate_law(table, "float32")).elf
    cycles, words = dearest(stimuli(table, "float32", 4_000), image, TRIES)
    keep([("float32", cycles, " ".join(f"{word:08x}" for word in words))], sys.argv[1:])
