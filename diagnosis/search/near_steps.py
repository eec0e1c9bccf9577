"""Steps of an input beside those that are supposed, by their likelihood to first order: what roundings change of commands, answered by the
filter's gains. One pass tells of all, where each would take its own, and coarse steps are told from hundreds of others.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from diagnosis.detect.input_steps import Kind, durations_s, errors_of, push_of
from diagnosis.detect.linearisation import Linearisation, answering
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import Hypothesis, filter_input_under
from sim.effect import Effect, Role, Values

Array = NDArray[np.float64]
NO_STEP = 1e-9  # of what an input usually takes: a step that is none


@dataclass(frozen=True, eq=False)
class NearSteps:
    """Around a hypothesis whose effect is steps of an input: the filter's answers, what a unit of the input adds to the plant's states, the
    commands before their steps by flight (instants,), and what these steps take from them."""

    effect: Effect
    least: float
    linearisation: Linearisation
    push: Array
    sent: tuple[Array, ...]
    taken: tuple[Array, ...]

    @property
    def log_likelihood(self) -> float:
        """That of the hypothesis."""
        return self.linearisation.fit.log_likelihood

    def likelihoods(self, hypotheses: Sequence[Hypothesis]) -> list[float]:
        """By how many nats each is likelier than the one that is supposed, whose steps alone differ."""
        own = [hypothesis.effects[self.effect.name] for hypothesis in hypotheses]
        steps, kinds = _steps_of(self.effect, own, self.least)
        values = []
        for sent, taken, filter_input in zip(self.sent, self.taken, self.linearisation.filter_inputs, strict=True):
            further = (steps * errors_of(sent, steps, kinds) - taken[:, None]) * durations_s(filter_input)[:, None]
            values.append(further.__getitem__)
        each = self.linearisation.beside_each(values, self.push)
        gains = sum(-beside[:, -1] - 0.5 * squares for squares, beside in each)
        return [float(gain) for gain in np.asarray(gains)]


def near_steps(case: Case, hypothesis: Hypothesis, name: str) -> NearSteps | None:
    """What tells of other steps than a hypothesis has; None where an effect is no steps of an input, another stands on the way of that, or
    the hypothesis cannot be filtered."""
    effect, model = case.library.effects[name], case.library.bound.model
    entry = model.places.inputs.get(effect.place)
    if entry is None or effect.having(Role.STEP) is None or effect.having(Role.SHIFT) is None:
        return None
    if any(case.library.effects[other].on_input is not None for other in hypothesis.effects if other != name):
        return None
    linearisation = answering(case, hypothesis)
    if linearisation is None:
        return None
    column, least = model.inputs.index(entry.variable), NO_STEP * entry.size
    push = push_of(linearisation, column)
    before = hypothesis.with_effects({other: own for other, own in hypothesis.effects.items() if other != name})
    compiled = case.library.compiled(before.effects)
    sent = [filter_input_under(case, compiled, flight, before.over(flight)).u[:, column] for flight in case.flights]
    instants = [len(filter_input.t_s) for filter_input in linearisation.filter_inputs]
    if not (np.isfinite(push).all() and push.any() and [len(one) for one in sent] == instants):
        return None
    steps, kinds = _steps_of(effect, [hypothesis.effects[name]], least)
    taken = tuple((steps * errors_of(one, steps, kinds))[:, 0] for one in sent)
    return NearSteps(effect, least, linearisation, push, tuple(sent), taken)


def _steps_of(effect: Effect, values: Sequence[Values], least: float) -> tuple[Array, list[Kind]]:
    """The steps (k,), each with what it is like."""
    hold, shift = effect.symbol(Role.HOLD), effect.symbol(Role.SHIFT)
    steps = np.array([max(own[effect.size.symbol], least) for own in values])
    return steps, [Kind(own[hold], own[shift]) for own in values]
