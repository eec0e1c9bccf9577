"""The plant alone, fitted: what every other hypothesis is compared with."""

from dataclasses import replace

import numpy as np

from diagnosis import decisions
from diagnosis.fit.coloured_noise import beyond, coloured_noise_of, colours, with_colours
from diagnosis.fit.gauss_newton import LITTLE_NATS, fit
from diagnosis.fit.known_before import log_prior
from diagnosis.fit.linear_problem import Fit
from diagnosis.fit.process_noise import with_process_noise
from diagnosis.fit.profile_likelihood import likelihoods
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import Hypothesis, as_noisy, has_memory, nominal_hypothesis
from jobs.thread_map import thread_map
from records.errors import BadInput

NOMINAL_ROUNDS = 4
NOISE_STARTS = tuple(float(decisions.FIRST_PROCESS_NOISE) + by for by in (-1.0, 0.0, 1.0))  # log10 rad/s per sqrt(s)
WAYS_ON = (1.0, 4.0)  # times the way of a round that are tried behind it
SETTLING_ROUNDS = 8  # parameters and noises give way to each other by little a round


def best_plain_fit(case: Case) -> Fit:
    """The likeliest of plain fits that begin at several levels of noise: where axes stick, slopes lead to the next hill only, and the first
    rows alone do not tell which is the highest."""
    return max(thread_map(lambda first: plain_fit(case, first), NOISE_STARTS), key=lambda found: found.log_posterior)


def plain_fit(case: Case, first: float = float(decisions.FIRST_PROCESS_NOISE)) -> Fit:
    """The plant re-tuned within its spread, with the white noise that then remains; its search begins at log10 `first`."""
    return settled(case, nominal_hypothesis(case, first))


def plain_from(case: Case, known: Hypothesis) -> Fit:
    """The same from the parameters that another reading of the logs left; white noise, of which noise with a memory may have left none,
    begins where it does before any log is seen."""
    process_noise = np.maximum(known.process_noise, float(decisions.FIRST_PROCESS_NOISE))
    return settled(case, replace(known.with_effects(case.stated), process_noise=process_noise, reading_noise={}))


def settled(case: Case, start: Hypothesis) -> Fit:
    """The same from where a search may begin nearer to its end. Raises BadInput where the plant cannot follow its logs."""
    found = fit(case, start, rounds=NOMINAL_ROUNDS)
    for _ in range(SETTLING_ROUNDS):
        if found is None:
            raise BadInput(
                "plant",
                "diagnosis",
                "states that leave all bounds",
                "a plant that can follow these logs",
                "check units, leave out a state that is thousands of times faster than the rows, and give a root of what nothing "
                "measures a slope at 0: h / (h^2 + 1e-6)^(1/4)",
            )
        again = fit(case, with_process_noise(case, found.hypothesis), rounds=NOMINAL_ROUNDS)
        if again is not None and again.log_posterior < found.log_posterior + LITTLE_NATS:
            break
        found = again
    assert found is not None
    return found


def plain_beside(case: Case, named: Fit, plain: Fit) -> Fit | None:
    """The plant alone, fitted from the numbers that it has beside effects, with the kinds of noise that `plain`, fitted before, has; None
    where it is beside none, or cannot follow its logs from there."""
    hypothesis = named.hypothesis
    names = case.added(hypothesis.effects)
    if not names:
        return None
    kept = {name: values for name, values in hypothesis.effects.items() if name not in names}
    try:
        return with_memory_of(case, settled(case, hypothesis.with_effects(kept)), plain.hypothesis)
    except BadInput:
        return None


def with_memory(case: Case, found: Fit) -> Fit:
    """The fit with noise with a memory where the logs tell of it; what was not taken is asked anew beside what was, as errors of readings
    hide a torque that comes and goes, and the other way round."""
    asked = every = colours(case)
    for _ in range(SETTLING_ROUNDS):
        coloured = with_colours(case, found, asked)
        if coloured is found.hypothesis:
            break
        found = _under(case, found, coloured)
        asked = [colour for colour in every if colour.of(found.hypothesis) is None]
    return found


def with_memory_from(case: Case, found: Fit, known: Hypothesis) -> Fit:
    """The fit with noise with a memory, sought from that of another hypothesis."""
    return with_memory(case, with_memory_of(case, found, known) if has_memory(case, known) else found)


def with_memory_of(case: Case, found: Fit, known: Hypothesis) -> Fit:
    """The fit with the noise that another hypothesis has, with the numbers that it then has beside this one."""
    return _under(case, found, as_noisy(case, found.hypothesis, known))


def _under(case: Case, found: Fit, coloured: Hypothesis) -> Fit:
    """The fit under noise with a memory, until both agree."""
    for _ in range(SETTLING_ROUNDS):
        again = fit(case, coloured_noise_of(case, coloured), rounds=NOMINAL_ROUNDS)
        if again is None:
            break
        before, gained, found = found.hypothesis, again.log_posterior - found.log_posterior, again
        if gained < LITTLE_NATS:
            break
        coloured = _further(case, before, found)
    return found


def _further(case: Case, before: Hypothesis, there: Fit) -> Hypothesis:
    """What lies on along the way that a round went, where likelier: what parameters and noise do alike they do by little a round."""
    hypothesis = there.hypothesis
    if (before.effects.keys(), before.reading_noise.keys()) != (
        hypothesis.effects.keys(),
        hypothesis.reading_noise.keys(),
    ):
        return hypothesis
    tried = [hypothesis, *(beyond(case, before, hypothesis, by) for by in WAYS_ON)]
    values = [
        value + log_prior(case, one, there.free) for one, value in zip(tried, likelihoods(case, tried), strict=True)
    ]
    return tried[int(np.argmax(values))]


def fitted_from(case: Case, other: Fit) -> Fit | None:
    """The plant's fit to the logs of `case` from where it ended on another reading of them; None where it cannot run along them."""
    return fit(case, with_process_noise(case, other.hypothesis), rounds=NOMINAL_ROUNDS)


def gain_over(case: Case, usual: Fit, other: Fit) -> float:
    """By how many nats another reading of the logs, as fitted, is likelier than that of `case`, whose search counts from where the other
    ended too: else a hill that slopes did not find would look like another reading."""
    gain = other.log_posterior - usual.log_posterior
    if gain <= 0.0:
        return gain
    again = fitted_from(case, other)
    return gain if again is None else min(gain, other.log_posterior - again.log_posterior)
