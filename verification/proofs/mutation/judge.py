"""What a law does, as a test sees it: states, outputs, duties, angles and the self-test, on the stimuli of the equality checks."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from codegen.law_equations import state_words
from records.table import ControllerTable
from verification.equality import BatchStepper, differing
from verification.fixed_stimuli import EDGES, SPECIAL_WORDS, fixed_stimuli
from verification.host_law import HostLaw
from verification.stimuli import ARRIVALS, JUMPS, SPECIAL_BITS, Stimulus, at_the_bound, standard_stimuli

Bits = NDArray[Any]

_STIMULI = {"float32": standard_stimuli, "fixed": fixed_stimuli}
_SPECIAL = {"float32": SPECIAL_BITS, "fixed": SPECIAL_WORDS}
_ENDS = [[2**31 - 1, -(2**31)], [-(2**31), 2**31 - 1], [2**24 + 1, -(2**24) - 1]]
COUNTS = np.array(
    [*([n, n] for n in range(-8192, 8193)), *_ENDS], dtype=np.int32
)  # two turns either way, and far beyond

# Of either sign: where a duty's factor is odd, one of them is half a tick.
POWERS = np.array([sign * 2**power for power in range(31) for sign in (1, -1)], dtype=np.int32).view(np.uint32)


@dataclass(frozen=True)
class Behaviour:
    """Arrays of bits that two laws can be told apart by, in a fixed order: the law's numbers, and integers such as duties."""

    numbers: tuple[Bits, ...]
    is_float: bool
    integers: tuple[Bits, ...] = ()

    def differs(self, other: "Behaviour") -> bool:
        """Whether any bit differs, of the law's numbers NaN counting as equal to NaN: a small negative integer has the bits of one."""
        numbers = zip(self.numbers, other.numbers, strict=True)
        integers = zip(self.integers, other.integers, strict=True)
        return any(differing(a, b, self.is_float).any() for a, b in numbers) or any((a != b).any() for a, b in integers)


def stimuli_of(table: ControllerTable, arithmetic: str, steps: int) -> Sequence[Stimulus]:
    """The stimuli of the equality checks, `steps` steps of them, those from edges also lane by lane, one arrival and one lane of jumps
    alone, one with every word missing, in one lane and in two, and in float32 the bound of what is plausible.

    A lane alone runs on single numbers, for which the twin has decisions of their own.
    """
    stimuli = _STIMULI[arithmetic](table, steps)
    alone = [lane for stimulus in stimuli if stimulus.name == EDGES for lane in _lane_by_lane(stimulus)]
    alone += [next(_lane_by_lane(stimulus)) for stimulus in stimuli if stimulus.name in (ARRIVALS, JUMPS)]
    word = int(_SPECIAL[arithmetic][0])
    bound = [at_the_bound(table)] if arithmetic == "float32" else []
    return (*stimuli, *alone, *bound, *(_all_missing(table, word, lanes) for lanes in (1, 2)))


def _lane_by_lane(stimulus: Stimulus) -> Iterator[Stimulus]:
    states = stimulus.states
    for lane in range(len(stimulus.angles)):
        one = slice(lane, lane + 1)
        inputs = np.ascontiguousarray(stimulus.inputs[:, one])
        yield Stimulus(stimulus.name, stimulus.angles[one], inputs, None if states is None else states[one])


def _all_missing(table: ControllerTable, word: int, lanes: int) -> Stimulus:
    """Three steps from a state and inputs of nothing but this word."""
    loops = len(table.loops)
    shapes = ((lanes, loops), (3, lanes, 2 * loops), (lanes, state_words(table)))
    filled = [np.full(shape, word, dtype=np.uint32) for shape in shapes]
    return Stimulus("nothing known", *filled)


def stepped(law: BatchStepper, stimuli: Sequence[Stimulus]) -> Behaviour:
    """States at rest, last states and outputs on every stimulus."""
    arrays: list[Bits] = []
    for stimulus in stimuli:
        start = law.start(stimulus.angles)
        ends, outputs = law.run(start if stimulus.states is None else stimulus.states, stimulus.inputs)
        arrays += [start, ends, outputs]
    return Behaviour(tuple(arrays), law.arithmetic == "float32")


def whole_behaviour(law: HostLaw, stimuli: Sequence[Stimulus]) -> Behaviour:
    """The same with duties of the outputs and of special words, angles, and the self-test's verdict."""
    seen = stepped(law, stimuli)
    special, loops = _SPECIAL[law.arithmetic], seen.numbers[2].shape[-1]
    outputs = np.concatenate([array.reshape(-1, loops) for array in seen.numbers[2::3]])
    words = (outputs, *(_of_loops(np.stack([each, each[::-1]], axis=-1), loops) for each in (special, POWERS)))
    duties = [law.duties(np.ascontiguousarray(each)).view(np.uint32) for each in words]
    verdict = np.array([law.self_test()], dtype=np.uint32)
    angles = law.angles_from_counts(_of_loops(COUNTS, loops))
    return Behaviour((*seen.numbers, angles), seen.is_float, (*duties, verdict))


def _of_loops(pairs: Bits, loops: int) -> Bits:
    """A column for each loop, from `pairs` (n, 2) in turn."""
    return np.ascontiguousarray(pairs[:, np.arange(loops) % 2])
