"""Friction near rest, which a plant's file leaves open: whether axes stick, or creep or give where they are pushed too little to slide."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from diagnosis import decisions
from diagnosis.decisions import decided, held_against
from diagnosis.fit.evidence import FittedHypothesis, as_fitted, log_evidence
from diagnosis.fit.gauss_newton import fit
from diagnosis.fit.linear_problem import Fit
from diagnosis.fit.process_noise import axis_noise, with_process_noise
from diagnosis.fit.profile_likelihood import likeliest, likelihoods
from diagnosis.fit.scoring import Number, likeliest_numbers
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import Hypothesis
from diagnosis.search.fitting import at_its_place, refined
from records.reasons import Decision
from sim.effect import Effect, Values

FOLD = 2.0  # from one size that is tried to the next


@dataclass(frozen=True, eq=False)
class Yielding:
    """A case where axes creep or give, the hypothesis beside which they showed that, as it is fitted there, and the rules that were asked;
    the case as it was and no hypothesis where none does."""

    case: Case
    beside: FittedHypothesis | None
    decisions: tuple[Decision, ...]


def yielding(case: Case, found: Sequence[FittedHypothesis]) -> Yielding:
    """The case where those axes creep or give that do so in its logs, beside one of the hypotheses `found`, best first.

    They must then be TAKEN_IN nats likelier than the best of those. It is asked beside them, as under a model that lacks something else an
    axis often seems to creep; and beside more than the best, as where the axes do creep the best is one that makes up for it.
    """
    best, likeliest_fit, rules = found[0].evidence + decisions.TAKEN_IN, None, list[Decision]()
    promised = [(_promised(case, fitted.fit), fitted) for fitted in found]
    promising = sorted(
        (fitted.evidence + gain, place)
        for place, (gain, fitted) in enumerate(promised)
        if gain > decisions.PROMISED_SHARE * (best - fitted.evidence)
    )
    yields = dict[str, Values]()
    for _, place in promising[: -decisions.NEXT - 1 : -1]:
        fitted = found[place]
        hypothesis = _yielded(case, fitted.fit)
        begun = None if hypothesis is None else at_its_place(case, hypothesis)
        # With the noise that then remains, as what it is held against has its own.
        refitted = None if begun is None else refined(case, begun)
        if refitted is None:
            continue
        ended, explained = refitted.fit, refitted.evidence
        rules.append(_rule(fitted, explained - found[0].evidence))
        if explained > best:
            best, likeliest_fit = explained, ended
            beside = fitted.fit.hypothesis.effects
            yields = {name: values for name, values in ended.hypothesis.effects.items() if name not in beside}
    if likeliest_fit is None:
        return Yielding(case, None, tuple(rules))
    exact = {name: dict.fromkeys(values, 0.0) for name, values in yields.items()}
    known = replace(case, stated={**case.stated, **yields}, stated_sd={**case.stated_sd, **exact})
    there = fit(known, likeliest_fit.hypothesis, rounds=0)
    return Yielding(known, None if there is None else as_fitted(known, there), tuple(rules))


def _rule(beside: FittedHypothesis, gain: float) -> Decision:
    of = " + ".join(beside.effects) or "plant"
    return decided(
        "axes_yield", of, gain, decisions.TAKEN_IN, "axes yield" if gain > decisions.TAKEN_IN else "axes stick"
    )


def changes_names(
    there: Yielding, best: FittedHypothesis, plain: FittedHypothesis
) -> tuple[bool, tuple[Decision, ...]]:
    """Whether what is found where axes yield may have other names than the `best` where they stick: all is sought anew then; and the rule.
    Beside these very names they must gain a share of what these gain over the plant alone."""
    if there.beside is None or set(there.beside.effects) != set(best.effects) or not best.effects:
        return there.beside is not None, ()
    gain, least = there.beside.evidence - best.evidence, decisions.NEGLIGIBLE_SHARE * (best.evidence - plain.evidence)
    outcome = "all is sought anew" if gain > least else "no name changes"
    return gain > least, (held_against("yields_anew", " + ".join(best.effects), gain, least, "nats", outcome),)


def needed(case: Case, best: FittedHypothesis) -> bool:
    """Whether a hypothesis found where axes yield is worth as much more as that must be, than the same under `case`, where they do not."""
    kept = {
        name: v for name, v in best.fit.hypothesis.effects.items() if name in best.effects or not case.added([name])
    }
    found = fit(case, with_process_noise(case, best.fit.hypothesis.with_effects(kept)), rounds=4)
    return found is None or best.evidence > log_evidence(found, case.library.effects) + decisions.TAKEN_IN


def _promised(case: Case, found: Fit) -> float:
    """What the likeliest way of each axis gains with the noise as it was, in nats: 0 where all stick."""
    hypothesis, gain = found.hypothesis, 0.0
    for axis in case.library.bound.model.places.axes:
        tried = [start for effect in _unstated(case, hypothesis, axis) for start in _tried(hypothesis, effect)]
        gain += max([0.0, *(value - found.log_likelihood for value in likelihoods(case, tried))])
    return gain


def _yielded(case: Case, found: Fit) -> Hypothesis | None:
    """What was fitted with those axes that yield beside it, one after the other; None where none does."""
    hypothesis, value = found.hypothesis, found.log_likelihood
    for axis in case.library.bound.model.places.axes:
        ways = list(_unstated(case, found.hypothesis, axis))
        if ways:
            fitted, reached = _likeliest(case, hypothesis, ways, value)
            if reached > value + decisions.TAKEN_IN:
                hypothesis, value = fitted, reached
    return hypothesis if value > found.log_likelihood else None


def _unstated(case: Case, hypothesis: Hypothesis, axis: str) -> Iterator[Effect]:
    """The ways in which an axis may yield: none where it never moves, has no dry friction, or is known to yield."""
    ways = [effect for effect in case.library.effects.values() if effect.place == axis and not effect.names_a_gap]
    moves = any(axis not in flight.locked for flight in case.flights)
    rubs = axis not in case.library.frictionless or _is_held(case, hypothesis, axis)
    if moves and rubs and not any(effect.name in case.stated for effect in ways):
        yield from ways


def _is_held(case: Case, hypothesis: Hypothesis, axis: str) -> bool:
    """Whether dry friction of an axis is supposed."""
    carried = (case.library.effects[name] for name in hypothesis.effects)
    return any(effect.place == axis and effect.holds_at_rest for effect in carried)


def _likeliest(case: Case, hypothesis: Hypothesis, ways: Sequence[Effect], value: float) -> tuple[Hypothesis, float]:
    """The likeliest way in which an axis yields, with the speed or the travel over which friction builds up and the white noise that then
    remain; the hypothesis itself where none is likelier than its `value`.

    Each is tried at its reference and at a quarter of it, with the noise as it was: where an axis sticks, both cost hundreds of nats, and
    no other noise makes up for them.
    """
    begun = [_begun(case, hypothesis, effect, value) for effect in ways]
    likelier = [start for start in begun if start is not None]
    if not likelier:
        return hypothesis, value
    start, _ = likeliest(case, likelier)
    effect = ways[begun.index(start)]
    size = Number(partial(_log_size, effect), partial(_with_log_size, effect))
    return likeliest_numbers(case, start, [size, *axis_noise(case, start)])


def _begun(case: Case, hypothesis: Hypothesis, effect: Effect, value: float) -> Hypothesis | None:
    """The likelier of two sizes of a way with its own noise; None where both are far less likely than `value` as the noise was."""
    start, reached = likeliest(case, _tried(hypothesis, effect))
    return with_process_noise(case, start) if reached > value - decisions.PLAIN_TO_SEE else None


def _tried(hypothesis: Hypothesis, effect: Effect) -> list[Hypothesis]:
    """A way at its reference and at a quarter of it."""
    return [_with(hypothesis, effect, size) for size in (effect.size.reference, effect.size.reference / FOLD**2)]


def _log_size(effect: Effect, hypothesis: Hypothesis) -> float:
    return float(np.log10(hypothesis.effects[effect.name][effect.size.symbol]))


def _with_log_size(effect: Effect, hypothesis: Hypothesis, x: float) -> Hypothesis:
    return _with(hypothesis, effect, float(np.clip(10.0**x, effect.size.reference / FOLD**3, effect.size.upper)))


def _with(hypothesis: Hypothesis, effect: Effect, size: float) -> Hypothesis:
    return hypothesis.with_effects({**hypothesis.effects, effect.name: {effect.size.symbol: size}})
