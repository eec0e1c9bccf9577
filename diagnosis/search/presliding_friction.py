"""Friction near rest, which a plant's file leaves open: whether axes stick, or creep or give where they are pushed too little to slide."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

from diagnosis import decisions
from diagnosis.decisions import held_against
from diagnosis.fit.evidence import FittedHypothesis, evidence
from diagnosis.fit.gauss_newton import Fit, fit, likelihood_of
from diagnosis.fit.process_noise import with_process_noise
from diagnosis.fit.profile_likelihood import Point, by_folds, likelihoods
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import Hypothesis
from records.reasons import Decision
from sim.effect import Effect, Values

FOLD = 2.0  # from one size that is tried to the next


def yielding(case: Case, found: Sequence[FittedHypothesis], further: float = 0.0) -> tuple[Case, tuple[Decision, ...]]:
    """The case where those axes creep or give that do so in its logs, beside one of the hypotheses `found`, best
    first; else the same; with the rules that
    were asked.

    They must then be YIELDING_GAIN and `further` nats likelier than the best of those. It is asked beside them, as under a model that lacks
    something else an axis often seems to creep; and beside more than the best, as where the axes do creep the best is one that makes up
    for it.
    """
    asked = [(fitted, *_yielded(case, fitted.fit)) for fitted in found]
    promising = sorted(
        ((fitted.evidence + gained, fitted, hypothesis) for fitted, hypothesis, gained in asked if gained > 0.0),
        key=lambda entry: -entry[0],
    )
    needed_nats = decisions.YIELDING_GAIN + further
    best, yields, rules = found[0].evidence + needed_nats, dict[str, Values](), list[Decision]()
    for _, fitted, hypothesis in promising[: decisions.YIELDING_FITTED]:
        ended = fit(case, hypothesis, rounds=4)
        if ended is None:
            continue
        explained = evidence(ended, case.library.effects)
        rules.append(_rule(fitted, explained - found[0].evidence, needed_nats))
        if explained > best:
            best = explained
            beside = fitted.fit.hypothesis.effects
            yields = {name: values for name, values in ended.hypothesis.effects.items() if name not in beside}
    if not yields:
        return case, tuple(rules)
    exact = {name: dict.fromkeys(values, 0.0) for name, values in yields.items()}
    return replace(case, stated={**case.stated, **yields}, stated_sd={**case.stated_sd, **exact}), tuple(rules)


def _rule(beside: FittedHypothesis, gain: float, limit: float) -> Decision:
    of = " + ".join(beside.effects) or "plant"
    return held_against("axes_yield", of, gain, limit, "nats", "axes yield" if gain > limit else "axes stick")


def needed(case: Case, best: FittedHypothesis) -> bool:
    """Whether a hypothesis found where axes yield is worth as much more as that must be, than the same under `case`, where they do not."""
    kept = {
        name: v for name, v in best.fit.hypothesis.effects.items() if name in best.effects or not case.added([name])
    }
    found = fit(case, with_process_noise(case, best.fit.hypothesis.with_effects(kept)), rounds=4)
    return found is None or best.evidence > evidence(found, case.library.effects) + decisions.YIELDING_GAIN


def _yielded(case: Case, found: Fit) -> tuple[Hypothesis, float]:
    """What was fitted with those axes that yield beside it, one after the other, and what that gains."""
    hypothesis, value = found.hypothesis, found.log_likelihood
    for axis in case.library.bound.model.places.axes:
        ways = [_likeliest(case, hypothesis, effect, value) for effect in _unstated(case, found.hypothesis, axis)]
        if ways:
            fitted, reached = max(ways, key=lambda way: way[1])
            if reached > value + decisions.LEAST_YIELDING_GAIN:
                hypothesis, value = fitted, reached
    return hypothesis, value - found.log_likelihood


def _unstated(case: Case, hypothesis: Hypothesis, axis: str) -> Iterator[Effect]:
    """The ways in which an axis may yield: none where it never moves, has no dry friction, or is known to yield."""
    ways = [effect for effect in case.library.effects.values() if effect.place == axis and not effect.names_a_gap]
    moves = any(axis not in flight.locked for flight in case.flights)
    rubs = axis not in case.library.frictionless or _is_held(case, hypothesis, axis)
    if moves and rubs and not any(effect.name in case.stated for effect in ways):
        yield from ways


def _is_held(case: Case, hypothesis: Hypothesis, axis: str) -> bool:
    """Whether dry friction of an axis is supposed."""
    supposed = (case.library.effects[name] for name in hypothesis.effects)
    return any(effect.place == axis and effect.holds_at_rest for effect in supposed)


def _likeliest(case: Case, hypothesis: Hypothesis, effect: Effect, value: float) -> tuple[Hypothesis, float]:
    """The likeliest speed or way in which friction builds up, by folds up, else down, with the process noise that then remains.

    None of it where neither its reference nor a quarter of that is likelier than `value` with the process noise as
    it was: where an axis sticks, both
    cost hundreds of nats, and no other process noise makes up for them.
    """
    reference = effect.size.reference
    sizes = (reference, reference / FOLD**2)
    first = likelihoods(case, [_with(hypothesis, effect, size) for size in sizes])
    if max(first) <= value:
        return hypothesis, value

    def at(size: float) -> Point:
        settled = with_process_noise(case, _with(hypothesis, effect, size))
        return Point(size, settled, likelihood_of(case, settled))

    start = at(sizes[first.index(max(first))])
    found = by_folds(at, start, FOLD, reference / FOLD**3, effect.size.upper)
    return found.hypothesis, found.value


def _with(hypothesis: Hypothesis, effect: Effect, size: float) -> Hypothesis:
    return hypothesis.with_effects({**hypothesis.effects, effect.name: {effect.size.symbol: size}})
