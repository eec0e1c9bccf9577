"""Numbers by which the likelihood is too rough for slopes: values beside one another, of which the likeliest is taken: of steps of an input
to first order, as these are many, where a pass bears out the best of them."""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from diagnosis import decisions
from diagnosis.fit.profile_likelihood import likeliest, likelihoods
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import Hypothesis
from diagnosis.search.near_steps import NearSteps, near_steps
from sim.effect import Effect, EffectParameter, Role, Values

Array = NDArray[np.float64]
Tell = Callable[[Sequence[Hypothesis]], list[float]]  # the log likelihood of each, but for what all have alike
VALUES_AT_ONCE = 13  # values at a time
# Shares of a step in which a likelier one is looked for, at first and once the rest fits: some hundred steps of a range tell one to a
# hundred-thousandth.
POLISHING, STEP_FINELY = (0.2, 0.03, 0.005), (1e-3, 2e-4, 4e-5)
# Shares of what lies between the first values of a shape, to both sides, in which a likelier one is looked for with steps that follow it.
SHAPED_FINELY = (1.0, 1.0 / 6.0)
LIKE_TOLD = 0.25  # of what first order tells that a pass may tell otherwise: passes are linear to a tenth, but where an axis sticks
PLAINLY = 0.005  # of a step, as a share, in which its multiples are looked for where steps that lie beside theirs lie
# Times a step, to which it follows what else changes about it: beyond, it is another.
LEAST_FOLLOWED, MOST_FOLLOWED = 0.5, 2.0


def is_rough(case: Case, name: str) -> bool:
    """Whether the likelihood by an effect's size is too rough for slopes."""
    return case.library.effects[name].size.rough


def polished(case: Case, start: Hypothesis, effect: str, reaches: Sequence[float]) -> Hypothesis:
    """The start with the likeliest size near it, where slopes do not lead to it; steps as they lie, or at their multiples where that is no
    less likely than what such a shape costs."""
    tell, found = _teller(case, near_steps(case, start, effect)), start
    for reach in reaches:
        factors = np.linspace(1.0 - reach, 1.0 + reach, VALUES_AT_ONCE)
        found = _best(tell, found, _sizes(case, found, effect, factors))
    shapes = [p for p in case.library.effects[effect].parameters if p.rough and not p.is_size]
    found = _reshaped(case, tell, found, effect, shapes)
    plain = _at_multiples(case, tell, start, found, effect, reaches)
    tried = [start, found] if plain is None else [start, found, plain]
    before, value, *plainly = likelihoods(case, tried)
    if plain is not None and plainly[0] > max(value, before) - decisions.SHAPE_COST:
        return plain
    return found if value >= before else start


def _teller(case: Case, near: NearSteps | None) -> Tell:
    """How likely hypotheses are: by a pass for each, or near one by what that tells of others."""

    def by_passes(hypotheses: Sequence[Hypothesis]) -> list[float]:
        return likelihoods(case, hypotheses)

    def by_first_order(hypotheses: Sequence[Hypothesis]) -> list[float]:
        assert near is not None
        told = near.likelihoods(hypotheses)
        best = int(np.argmax(told))
        there = by_passes([hypotheses[best]])[0] - near.log_likelihood
        borne_out = abs(there - told[best]) <= decisions.TAKEN_IN + LIKE_TOLD * abs(told[best])
        return told if borne_out else by_passes(hypotheses)

    return by_passes if near is None else by_first_order


def _best(tell: Tell, start: Hypothesis, tried: Sequence[Hypothesis]) -> Hypothesis:
    """The likeliest of what is tried, the first of those alike; the start where none can be filtered."""
    values = tell(tried)
    best = int(np.argmax(values))
    return tried[best] if values[best] > -np.inf else start


def _at_multiples(
    case: Case, tell: Tell, start: Hypothesis, found: Hypothesis, name: str, reaches: Sequence[float]
) -> Hypothesis | None:
    """What was found with steps at their multiples; None where they are there, or an effect has none that may lie elsewhere.

    Of few steps a little other ones that lie a little beside lie nearly the same: their multiples are sought where those lie.
    """
    effect = case.library.effects[name]
    shift, size = effect.having(Role.SHIFT), effect.size.symbol
    if shift is None or found.effects[name][shift.symbol] == 0.0:
        return None
    plain = found.with_value(name, shift.symbol, 0.0)
    tried = [start.effects[name][size], *_where_they_lie(case, effect, found.effects[name])]
    plain = _likeliest_value(tell, plain, name, size, tried)
    others = [p for p in effect.parameters if p.rough and not p.is_size and p is not shift]
    for wide in (reaches if reaches[0] > PLAINLY else (PLAINLY, *reaches), reaches[1:]):
        for reach in wide:
            values = plain.effects[name][size] * np.linspace(1.0 - reach, 1.0 + reach, VALUES_AT_ONCE)
            plain = _likeliest_value(tell, plain, name, size, values.tolist())
        plain = _reshaped(case, tell, plain, name, others)
    return plain


def _where_they_lie(case: Case, effect: Effect, values: Values) -> list[float]:
    """Steps whose multiples lie, at those next to the mean command, where steps that lie beside theirs do: q (k - s) = q' k."""
    step, shift = values[effect.size.symbol], values[effect.symbol(Role.SHIFT)]
    mean = _mean_command(case, effect.place) / step if step > 0.0 else 0.0
    levels = [np.floor(mean) + by for by in (-1.0, 0.0, 1.0, 2.0)]
    found = [float(step * (1.0 - shift / level)) for level in levels if abs(level) > abs(shift)]
    return [other for other in found if other <= effect.size.upper]


def _reshaped(case: Case, tell: Tell, start: Hypothesis, name: str, shapes: Sequence[EffectParameter]) -> Hypothesis:
    """The start with the likeliest of an effect's rough shapes, each over its whole range, then beside that with steps that follow."""
    for shape in shapes:
        values = np.linspace(shape.lower, shape.upper, VALUES_AT_ONCE)
        start = _likeliest_value(tell, start, name, shape.symbol, [start.effects[name][shape.symbol], *values.tolist()])
        for apart in (values[1] - values[0]) * np.array(SHAPED_FINELY):
            beside = start.effects[name][shape.symbol] + apart * np.linspace(-1.0, 1.0, VALUES_AT_ONCE)
            near = np.clip(beside, shape.lower, shape.upper).tolist()
            tried = [other for value in near for other in _following(case, start, name, shape.symbol, value)]
            start = _best(tell, start, [start, *tried])
    return start


def _following(case: Case, start: Hypothesis, name: str, symbol: str, value: float) -> list[Hypothesis]:
    """The start with another value of a shape of steps: the steps as they were, and such that the command which leaves the level next to
    the mean one upwards stays, or downwards: (L +- (1/2 + h) - s) q."""
    effect, values = case.library.effects[name], start.effects[name]
    size, changed = effect.size.symbol, {**start.effects[name], symbol: value}
    found = [changed]
    if effect.having(Role.HOLD) is not None and values[size] > 0.0:
        level = level_of(case, effect, values)
        for side in (1.0, -1.0):
            before, behind = (_edge(effect, told, level, side) for told in (values, changed))
            if LEAST_FOLLOWED * abs(behind) < before * np.sign(behind) < MOST_FOLLOWED * abs(behind):
                step = float(values[size] * before / behind)
                found += [{**changed, size: step}] if step <= effect.size.upper else []
    return [start.with_effects({**start.effects, name: told}) for told in found]


def level_of(case: Case, effect: Effect, values: Values) -> float:
    """The level next to the mean command of an input with steps; the step is not 0."""
    return float(
        np.round(_mean_command(case, effect.place) / values[effect.size.symbol] + values[effect.symbol(Role.SHIFT)])
    )


def _edge(effect: Effect, values: Values, level: float, side: float) -> float:
    """The command that leaves a level upwards, or downwards, in steps."""
    return level + side * (0.5 + values[effect.symbol(Role.HOLD)]) - values[effect.symbol(Role.SHIFT)]


def likeliest_size(case: Case, start: Hypothesis, effect: str, factors: Array) -> Hypothesis:
    """The start with that of the factors on an effect's size that the logs find likeliest."""
    best, value = likeliest(case, _sizes(case, start, effect, factors))
    return best if value > -np.inf else start


def _sizes(case: Case, start: Hypothesis, effect: str, factors: Array) -> list[Hypothesis]:
    """The start with each of the factors on an effect's size."""
    size = start.effects[effect][case.library.effects[effect].size.symbol]
    return [_sized(case, start, effect, size * factor) for factor in factors.tolist()]


def _sized(case: Case, start: Hypothesis, name: str, size: float) -> Hypothesis:
    """The start with another size of an effect; steps that may lie anywhere stay where they were about the mean command, or another size
    would move them all there."""
    effect, values = case.library.effects[name], start.effects[name]
    shift, changed = effect.having(Role.SHIFT), {**values, effect.size.symbol: size}
    before = values[effect.size.symbol]
    if shift is not None and before > 0.0 and size > 0.0:
        moved = values[shift.symbol] + _mean_command(case, effect.place) * (1.0 / before - 1.0 / size)
        changed[shift.symbol] = float(moved - np.round(moved))
    return start.with_effects({**start.effects, name: changed})


def _mean_command(case: Case, place: str) -> float:
    model = case.library.bound.model
    column = model.inputs.index(model.places.inputs[place].variable)
    return float(np.mean(np.concatenate([flight.filter_input.u[:, column] for flight in case.flights])))


def _likeliest_value(tell: Tell, start: Hypothesis, effect: str, symbol: str, values: Sequence[float]) -> Hypothesis:
    """The start with that of the values of one number of an effect that the logs find likeliest."""
    own = start.effects[effect]
    return _best(
        tell, start, [start.with_effects({**start.effects, effect: {**own, symbol: value}}) for value in values]
    )
