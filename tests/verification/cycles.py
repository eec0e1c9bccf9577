"""Cycles of one control step on the emulated board, by what the law is given.

`.venv/bin/python -m tests.verification.cycles [FILE.json]` prints the table of docs/proofs.md, for plants/ce150.toml, and keeps it there.
"""

import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from codegen.law import generate_law
from records.table import ControllerTable
from rig.emulator.board import EmulatedBoard
from rig.flight.target_law import TargetLaw
from rig.programming.image import build_firmware
from tests.docs.reading.tables import keep
from tests.law_tables import STATE_WORDS
from twinlaw.workflows.chain.arithmetics import ARITHMETICS
from twinlaw.workflows.chain.designing import design_controller
from verification.stimuli import SPECIAL_BITS, Stimulus

STEPS = 100_000
# From rest, references and angles within their ranges and beyond; the others set states, or bits, that no flight has.
FLOWN = ("reference jumps", "saturation", "angles near zero", "on the way to zero")

Words = NDArray[np.uint32]


def nasty_floats(rng: np.random.Generator, shape: tuple[int, int]) -> Words:
    """Subnormals, tiny and ordinary normals, special numbers, any bits; both signs."""
    bits = rng.integers(0, 2**32, shape, dtype=np.uint32)
    tiny = (10.0 ** rng.uniform(-44.0, 0.0, shape)).astype(np.float32).view(np.uint32)
    ordinary = np.abs(rng.normal(0.0, 1.0, shape)).astype(np.float32).view(np.uint32)
    subnormal = bits >> rng.integers(9, 32, shape).astype(np.uint32)
    kinds = [subnormal, tiny, ordinary, rng.choice(SPECIAL_BITS, shape), bits]
    magnitude = np.choose(rng.choice(5, shape, p=(0.45, 0.3, 0.15, 0.05, 0.05)), kinds) & 0x7FFFFFFF
    return magnitude | rng.integers(0, 2, shape, dtype=np.uint32) << 31


def subnormals(rng: np.random.Generator, shape: tuple[int, ...]) -> Words:
    """Subnormals alone, of all sizes and both signs."""
    bits = rng.integers(1, 0x800000, shape, dtype=np.uint32) >> rng.integers(0, 23, shape).astype(np.uint32)
    return bits | rng.integers(0, 2, shape, dtype=np.uint32) << 31


def near_zero(steps: int, seed: int = 1) -> tuple[Stimulus, ...]:
    """Where float32 runs out of places: states of such numbers, flights among them, filters that decay to exactly 0."""
    rng = np.random.default_rng(seed)
    at_zero = np.zeros((lanes := max(1, steps // 1000), 2), dtype=np.uint32)
    shape = (steps, STATE_WORDS + 4)
    held = np.repeat(subnormals(rng, (5, lanes, 4)), 200, axis=0)
    resting = np.repeat(subnormals(rng, (1, lanes, 4)), 1000, axis=0)
    resting[:, :, :2] = 0
    starts = np.full((lanes, 2), 1e-37, dtype=np.float32).view(np.uint32)
    return (
        _one_step("tiny numbers", nasty_floats(rng, shape)),
        _one_step("subnormals", subnormals(rng, shape)),
        Stimulus("angles near zero", at_zero, held),
        Stimulus("on the way to zero", starts, resting),
    )


def _one_step(name: str, words: Words) -> Stimulus:
    return Stimulus(
        name, words[:, -2:].copy(), words[np.newaxis, :, STATE_WORDS:].copy(), words[:, :STATE_WORDS].copy()
    )


def stimuli(table: ControllerTable, arithmetic: str, steps: int) -> Sequence[Stimulus]:
    """Those of the equality checks, and where float32 is slow."""
    return (*ARITHMETICS[arithmetic].stimuli(table, steps), *(near_zero(steps // 5) if arithmetic == "float32" else ()))


def cycles(table: ControllerTable, arithmetic: str, steps: int = STEPS) -> Iterator[tuple[str, int, int]]:
    """Name of each stimulus, least and most cycles of a step under it."""
    elf = build_firmware(generate_law(table, arithmetic)).elf
    for stimulus in stimuli(table, arithmetic, steps):
        law = TargetLaw(EmulatedBoard(elf), arithmetic)
        law.run(law.start(stimulus.angles) if stimulus.states is None else stimulus.states, stimulus.inputs)
        yield stimulus.name, law.cycles_min, law.cycles_max


def rows(table: ControllerTable) -> list[tuple[str, str, int, int]]:
    """The rows of docs/proofs.md's table: arithmetic, what the law was given, least and most cycles."""
    return [(arithmetic, *row) for arithmetic in ARITHMETICS for row in cycles(table, arithmetic)]


if __name__ == "__main__":
    keep(rows(design_controller(Path("plants/ce150.toml")).table), sys.argv[1:])
