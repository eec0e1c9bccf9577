"""Effects on the way of an input at full size, all at once, to first order: what they change of commands, answered by the filter's gains.

What an effect that is there changes in the innovations is what these lack: its score is its squared norm, and of one twice as large half of
that. One whose score is less than PROMISED_SHARE of it, or whose best multiple gains no more than chance, is not worth a pass.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from diagnosis import decisions
from diagnosis.detect.input_steps import durations_s, push_of, turns
from diagnosis.detect.linearisation import Linearisation, gain_alone
from diagnosis.hypothesis.hypothesis import filter_input_under
from sim.composition.build import memoryless
from sim.effect import Effect, Role, Values

Array = NDArray[np.float64]
Way = tuple[Effect, Values]


@dataclass(frozen=True)
class Promise:
    """What an effect gains to first order, in nats, beside the plant's coefficients, the share of its signature that these imitate, and the
    norm of the rest; whether that is worth a pass."""

    gain: float
    absorbed: float
    power: float
    is_worth: bool


def promises(linearisation: Linearisation, tries: Sequence[Way]) -> list[Promise | None]:
    """What each of the tries promises; None of one that is on no input's way alone, or changes commands at instants of its own."""
    found: list[Promise | None] = [None] * len(tries)
    columns = [_column(linearisation, effect) for effect, _ in tries]
    for column in sorted({column for column in columns if column is not None}):
        asked = [place for place, of in enumerate(columns) if of == column]
        changes = [_changes(linearisation, column, *tries[place]) for place in asked]
        kept = [(place, change) for place, change in zip(asked, changes, strict=True) if change is not None]
        if kept:
            told = _promised(linearisation, column, [change for _, change in kept])
            for (place, _), promise in zip(kept, told, strict=True):
                found[place] = promise
    return found


def _column(linearisation: Linearisation, effect: Effect) -> int | None:
    """The input whose way an effect is on; None of other effects, and of steps, which hit or miss as a whole."""
    model = linearisation.case.library.bound.model
    entry = model.places.inputs.get(effect.place)
    if entry is None or effect.size.role is Role.STEP or (effect.on_input is None and effect.applied is None):
        return None
    return model.inputs.index(entry.variable)


def _changes(linearisation: Linearisation, column: int, effect: Effect, values: Values) -> list[Array] | None:
    """What an effect adds to the commands of an input, by flight (instants,); None where it does so at other instants."""
    before = linearisation.filter_inputs
    after = _arriving(linearisation, effect, values)
    if any(len(one) != len(other.t_s) for one, other in zip(after, before, strict=True)):
        return None
    return [one[:, column] - other.u[:, column] for one, other in zip(after, before, strict=True)]


def _arriving(linearisation: Linearisation, effect: Effect, values: Values) -> list[Array]:
    """What arrives of the commands with an effect, by flight (instants, inputs)."""
    case, hypothesis = linearisation.case, linearisation.fit.hypothesis
    if effect.applied is not None:
        stage = memoryless(case.library.bound.nominal, effect, values)
        return [stage.applied(filter_input.u) for filter_input in linearisation.filter_inputs]
    with_it = hypothesis.with_effects({**hypothesis.effects, effect.name: values})
    compiled = case.library.compiled(with_it.effects)
    return [filter_input_under(case, compiled, flight, with_it.over(flight)).u for flight in case.flights]


def _promised(linearisation: Linearisation, column: int, changes: Sequence[Sequence[Array]]) -> list[Promise]:
    """What changes (instants,) of an input by flight promise each."""
    push = push_of(linearisation, column)
    if not np.isfinite(push).all() or turns(linearisation, column):
        return [Promise(0.0, 0.0, 0.0, True)] * len(changes)
    values = []
    for flight, filter_input in enumerate(linearisation.filter_inputs):
        # What the model adds, innovations lack.
        value = -np.stack([change[flight] for change in changes], axis=1) * durations_s(filter_input)[:, None]
        values.append(value.__getitem__)
    each = linearisation.beside_each(values, push)
    squares, beside = sum(one for one, _ in each), sum(two for _, two in each)
    norm, score = linearisation.alone(np.asarray(squares), np.asarray(beside))
    worth = _is_worth(score, norm)
    for own, told in each:  # some logs may deny what one shows
        worth |= _is_worth(-told[:, -1], own)
    gain, absorbed = score - 0.5 * norm, 1.0 - norm / np.maximum(squares, 1e-12)
    power = np.sqrt(np.maximum(norm, 0.0))
    rows = zip(gain.tolist(), absorbed.tolist(), power.tolist(), worth.tolist(), strict=True)
    return [Promise(*row) for row in rows]


def _is_worth(score: Array, norm: Array) -> NDArray[np.bool_]:
    gains_enough = gain_alone(score, norm) >= decisions.chance_nats()
    return np.asarray((score >= decisions.PROMISED_SHARE * norm) & gains_enough)
