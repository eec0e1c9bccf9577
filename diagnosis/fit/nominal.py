"""The plant alone, fitted: what every other hypothesis is compared with."""

import numpy as np

from diagnosis import decisions
from diagnosis.fit.coloured_noise import coloured_noise_of, with_colours
from diagnosis.fit.gauss_newton import Fit, fit
from diagnosis.fit.process_noise import FIRST_STEP, process_noise_of
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import nominal_hypothesis
from records.errors import BadInput

NOMINAL_ROUNDS = 4
SETTLED_NOISE = 0.05
MEMORY_ROUNDS, SETTLED_GAIN = (
    6,
    1.0,
)  # nats: white noise and noise with a memory give way to each other by little a round


def nominal_fit(case: Case) -> Fit:
    """The plant re-tuned within its spread, with all noise that then remains, white and with a memory."""
    return with_memory(case, plain_fit(case))


def plain_fit(case: Case) -> Fit:
    """The plant re-tuned within its spread, with the white noise that then remains."""
    hypothesis = nominal_hypothesis(case, decisions.FIRST_PROCESS_NOISE)
    found = fit(case, hypothesis, rounds=NOMINAL_ROUNDS)
    for turn in range(NOMINAL_ROUNDS):
        if found is None:
            raise BadInput(
                "plant",
                "diagnosis",
                "states that leave all bounds",
                "a plant that can follow these logs",
                "check units",
            )
        refined_noise = process_noise_of(case, found, FIRST_STEP if turn < 2 else 0.1)
        settled = bool(
            np.max(np.abs(refined_noise.process_noise - found.hypothesis.process_noise), initial=0.0) < SETTLED_NOISE
        )
        found = fit(case, refined_noise, rounds=NOMINAL_ROUNDS)
        if settled and found is not None:
            break
    assert found is not None
    return found


def with_memory(case: Case, found: Fit) -> Fit:
    """The fit with noise with a memory where the logs tell of it."""
    coloured = with_colours(case, found)
    if coloured is found.hypothesis:
        return found
    for _ in range(MEMORY_ROUNDS):
        again = fit(case, coloured_noise_of(case, coloured), rounds=NOMINAL_ROUNDS)
        if again is None:
            break
        gained, found, coloured = again.log_posterior - found.log_posterior, again, again.hypothesis
        if gained < SETTLED_GAIN:
            break
    return found
