"""Two executions of the same law, stepped side by side on the same bits: twin, host, target, in any pair."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from records.verification import Equality
from verification.stimuli import Stimulus

Bits = NDArray[np.uint32]


class BatchStepper(Protocol):
    """An execution of the law on bits: twin, compiled C, emulated board, board on a port."""

    name: str
    arithmetic: str

    def start(self, angles: Bits) -> Bits:
        """States at rest [lanes, words] for angles psi, phi [lanes, 2]."""

    def run(self, states: Bits, inputs: Bits) -> tuple[Bits, Bits]:
        """Inputs [steps, lanes, 4] give the final states and the outputs [steps, lanes, 2]."""


@dataclass(frozen=True)
class FirstMismatch:
    """Where two executions part: stimulus, step and lane, the input and both outputs u_M, u_T as bits.

    `step` is None when all outputs agreed but a state at the end, or at rest, did not; then the bits are those of that word.
    """

    stimulus: str
    step: int | None
    lane: int
    input_bits: tuple[int, ...]
    bits: tuple[tuple[int, ...], tuple[int, ...]]

    def __str__(self) -> str:
        place = "in the state" if self.step is None else f"at step {self.step}"
        given, first, second = (" ".join(f"{word:08X}" for word in words) for words in (self.input_bits, *self.bits))
        return f"{self.stimulus}, lane {self.lane}, {place}: input {given} gives {first} against {second}"


@dataclass(frozen=True)
class EqualityResult:
    """The record of a comparison and, where it failed, the first mismatch."""

    equality: Equality
    first_mismatch: FirstMismatch | None


def compare(one: BatchStepper, other: BatchStepper, stimuli: Sequence[Stimulus]) -> EqualityResult:
    """Run both on all `stimuli` and count the steps whose outputs differ in any bit; NaN equals NaN, +0 differs from -0.

    States at rest and after the last step are compared too, so that a difference which has not yet reached an output counts.
    """
    if one.arithmetic != other.arithmetic:
        raise ValueError(f"{one.name} computes in {one.arithmetic}, {other.name} in {other.arithmetic}")
    mismatches = 0
    first: FirstMismatch | None = None
    for stimulus in stimuli:
        count, mismatch = _compare_one(one, other, stimulus)
        mismatches += count
        first = first or mismatch
    steps = sum(stimulus.steps for stimulus in stimuli)
    return EqualityResult(Equality((one.name, other.name), one.arithmetic, steps, mismatches), first)


def _compare_one(one: BatchStepper, other: BatchStepper, stimulus: Stimulus) -> tuple[int, FirstMismatch | None]:
    starts = (one.start(stimulus.angles), other.start(stimulus.angles))
    ends, outputs = zip(
        *(
            stepper.run(start if stimulus.states is None else stimulus.states, stimulus.inputs)
            for stepper, start in zip((one, other), starts, strict=True)
        ),
        strict=True,
    )
    is_float = one.arithmetic == "float32"
    unequal: NDArray[np.bool_] = np.any(differing(outputs[0], outputs[1], is_float), axis=-1)
    mismatches = int(unequal.sum())
    if mismatches:
        return mismatches, _first_output(stimulus, unequal, outputs)
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


def _first_output(stimulus: Stimulus, unequal: NDArray[np.bool_], outputs: Sequence[Bits]) -> FirstMismatch:
    step, lane = (int(index) for index in np.argwhere(unequal)[0])
    given = _words(stimulus.inputs[step, lane])
    return FirstMismatch(
        stimulus.name, step, lane, given, (_words(outputs[0][step, lane]), _words(outputs[1][step, lane]))
    )


def _first_state(stimulus: Stimulus, unequal: NDArray[np.bool_], states: Sequence[Bits]) -> FirstMismatch:
    lane, word = (int(index) for index in np.argwhere(unequal)[0])
    one, other = (int(bits[lane, word]) for bits in states)
    return FirstMismatch(stimulus.name, None, lane, _words(stimulus.inputs[-1, lane]), ((one,), (other,)))


def _words(bits: Bits) -> tuple[int, ...]:
    return tuple(int(word) for word in bits)
