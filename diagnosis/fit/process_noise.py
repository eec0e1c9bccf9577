"""White noise of a hypothesis, by maximum likelihood: what drives each axis, and how long dry friction is in doubt at rest."""

from dataclasses import replace
from functools import partial

import numpy as np

from diagnosis import decisions
from diagnosis.fit.scoring import Number, likeliest_numbers
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import Hypothesis, scaled
from diagnosis.hypothesis.initial_state import FIRST_REST_DOUBT

# What is known of white noise beforehand: real and simulated rigs have 1e-3 to 0.5. Without, noise with a memory leaves none of it.
KNOWN_BEFORE = (float(decisions.FIRST_PROCESS_NOISE), 1.0)
LEAST_NOISE, MOST_NOISE = -5.0, 1.5  # log10 rad/s per sqrt(s)
# The most is where it starts: longer doubt would take the part of friction that gives before it slides.
LEAST_DOUBT = -7.0  # log10 s


def with_process_noise(case: Case, hypothesis: Hypothesis) -> Hypothesis:
    """The same with the white noise that the innovations show."""
    return likeliest_numbers(case, hypothesis, axis_noise(case, hypothesis))[0]


def axis_noise(case: Case, hypothesis: Hypothesis) -> list[Number]:
    """One number for all noise of each axis, so that what comes and goes grows with what is white, and that of rest where any axis has dry
    friction."""
    axes = range(len(hypothesis.process_noise))
    found = [Number(partial(_noise, axis), partial(_with_all, case, axis), KNOWN_BEFORE) for axis in axes]
    return found + _of_states(case, hypothesis) + _rest(case, hypothesis)


def white_noise(case: Case, hypothesis: Hypothesis) -> list[Number]:
    """The same for white noise alone, where what comes and goes has numbers of its own."""
    axes = range(len(hypothesis.process_noise))
    found = [Number(partial(_noise, axis), partial(_with_white, axis), KNOWN_BEFORE) for axis in axes]
    return found + _of_states(case, hypothesis) + _rest(case, hypothesis)


def _of_states(case: Case, hypothesis: Hypothesis) -> list[Number]:
    """One number for the noise of each measured state, as far below and above the size of its readings as those of axes may be beside a
    speed of 1 rad/s."""
    sizes = case.measured_sizes
    return [
        Number(
            partial(_state_noise, state),
            partial(_with_state_noise, state, size),
            (KNOWN_BEFORE[0] + size, KNOWN_BEFORE[1]),
        )
        for state in hypothesis.state_noise
        if state in sizes
        for size in [float(np.log10(sizes[state]))]
    ]


def _state_noise(state: str, hypothesis: Hypothesis) -> float:
    return hypothesis.state_noise[state]


def _with_state_noise(state: str, size: float, hypothesis: Hypothesis, x: float) -> Hypothesis:
    level = float(np.clip(x, size + LEAST_NOISE, size + MOST_NOISE))
    return replace(hypothesis, state_noise={**hypothesis.state_noise, state: level})


def _rest(case: Case, hypothesis: Hypothesis) -> list[Number]:
    return [Number(_doubt, _with_doubt)] if _rubs(case, hypothesis) else []


def _rubs(case: Case, hypothesis: Hypothesis) -> bool:
    """Whether any axis has dry friction, stated or supposed."""
    library = case.library
    is_added = any(library.effects[name].holds_at_rest for name in hypothesis.effects)
    return is_added or len(library.frictionless) < len(library.bound.model.axes)


def _noise(axis: int, hypothesis: Hypothesis) -> float:
    return float(hypothesis.process_noise[axis])


def _with_white(axis: int, hypothesis: Hypothesis, x: float) -> Hypothesis:
    process_noise = hypothesis.process_noise.copy()
    process_noise[axis] = np.clip(x, LEAST_NOISE, MOST_NOISE)
    return replace(hypothesis, process_noise=process_noise)


def _with_all(case: Case, axis: int, hypothesis: Hypothesis, x: float) -> Hypothesis:
    return scaled(case, hypothesis, axis, float(np.clip(x, LEAST_NOISE, MOST_NOISE)))


def _doubt(hypothesis: Hypothesis) -> float:
    return hypothesis.rest_doubt


def _with_doubt(hypothesis: Hypothesis, x: float) -> Hypothesis:
    return replace(hypothesis, rest_doubt=float(np.clip(x, LEAST_DOUBT, FIRST_REST_DOUBT)))
