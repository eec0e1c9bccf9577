"""Two executions of the same law, stepped side by side on the same bits: twin, host, target, in any pair."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from records.loops import LOOPS, Loop
from records.verification import Equality, FirstMismatch
from verification.stimuli import Stimulus

Bits = NDArray[np.uint32]


class BatchStepper(Protocol):
    """An execution of the law on bits: twin, compiled C, emulated board, board on a port."""

    name: str
    arithmetic: str

    def start(self, angles: Bits) -> Bits:
        """States at rest [lanes, words] for angles [lanes, loops]."""

    def run(self, states: Bits, inputs: Bits) -> tuple[Bits, Bits]:
        """Inputs [steps, lanes, 2 loops] give the final states and the outputs [steps, lanes, loops]."""


@dataclass(frozen=True)
class EqualityResult:
    """The record of a comparison and, where it failed, the first mismatch."""

    equality: Equality
    first_mismatch: FirstMismatch | None


def compare(
    one: BatchStepper, other: BatchStepper, stimuli: Sequence[Stimulus], loops: tuple[Loop, ...] = LOOPS
) -> EqualityResult:
    """Run both laws of `loops` on all `stimuli` and count the steps whose outputs differ in any bit; NaN equals NaN, +0 differs from -0.

    States at rest and after the last step are compared too, so that a difference which has not yet reached an output counts.
    """
    if one.arithmetic != other.arithmetic:
        raise ValueError(f"{one.name} computes in {one.arithmetic}, {other.name} in {other.arithmetic}")
    mismatches = 0
    first: FirstMismatch | None = None
    for stimulus in stimuli:
        count, mismatch = _compare_one(one, other, stimulus, loops)
        mismatches += count
        first = first or mismatch
    steps = sum(stimulus.steps for stimulus in stimuli)
    return EqualityResult(Equality((one.name, other.name), one.arithmetic, steps, mismatches, first), first)


def _compare_one(
    one: BatchStepper, other: BatchStepper, stimulus: Stimulus, loops: tuple[Loop, ...]
) -> tuple[int, FirstMismatch | None]:
    starts = (one.start(stimulus.angles), other.start(stimulus.angles))
    ends, outputs = zip(
        *(
            stepper.run(start if stimulus.states is None else stimulus.states, stimulus.inputs)
            for stepper, start in zip((one, other), starts, strict=True)
        ),
        strict=True,
    )
    is_float = one.arithmetic == "float32"
    unequal = differing(outputs[0], outputs[1], is_float)
    mismatches = int(unequal.any(axis=-1).sum())
    if mismatches:
        return mismatches, first_output(stimulus, unequal, (outputs[0], outputs[1]), loops)
    for states in (starts, ends):
        unequal_states = differing(states[0], states[1], is_float)
        if unequal_states.any():
            lanes = int(unequal_states.any(axis=-1).sum())
            return lanes, _first_state(stimulus, unequal_states, states)
    return 0, None


def differing(one: Bits, other: Bits, is_float: bool) -> NDArray[np.bool_]:
    """Where the bits differ and, for floats, not both are NaN: its payload is the processor's business."""
    unequal: NDArray[np.bool_] = np.not_equal(one, other)
    if is_float:
        unequal = np.logical_and(unequal, ~np.logical_and(_is_nan(one), _is_nan(other)))
    return unequal


def _is_nan(bits: Bits) -> NDArray[np.bool_]:
    beyond_infinity: NDArray[np.bool_] = np.greater(bits & np.uint32(0x7FFFFFFF), np.uint32(0x7F800000))
    return beyond_infinity


def first_output(
    stimulus: Stimulus, unequal: NDArray[np.bool_], outputs: tuple[Bits, Bits], loops: tuple[Loop, ...] = LOOPS
) -> FirstMismatch:
    """The first of the `unequal` outputs [steps, lanes, loops] of two executions."""
    step, lane, word = (int(index) for index in np.argwhere(unequal)[0])
    words = [bits[step, lane, word] for bits in outputs]
    return _mismatch(stimulus, step, lane, loops[word].input, words)


def _first_state(stimulus: Stimulus, unequal: NDArray[np.bool_], states: Sequence[Bits]) -> FirstMismatch:
    lane, word = (int(index) for index in np.argwhere(unequal)[0])
    return _mismatch(stimulus, None, lane, f"state word {word}", [bits[lane, word] for bits in states])


def _mismatch(
    stimulus: Stimulus, step: int | None, lane: int, signal: str, words: Sequence[np.uint32]
) -> FirstMismatch:
    given = stimulus.inputs[-1 if step is None else step, lane]
    one, other = (f"{int(word):08X}" for word in words)
    return FirstMismatch(stimulus.name, step, lane, signal, tuple(f"{int(word):08X}" for word in given), (one, other))
