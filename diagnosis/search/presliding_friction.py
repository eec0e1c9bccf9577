"""Friction near rest, which a plant's file leaves open: whether axes stick, or creep or give where they are pushed too little to slide."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

from diagnosis.detect.score_tests import FRICTIONS
from diagnosis.fit.evidence import Tried, evidence
from diagnosis.fit.gauss_newton import Fit, fit, likelihood_of
from diagnosis.fit.process_noise import with_unrest
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import Supposed
from sim.effect import Effect, Values

FITTED = 2  # of those that promise most
FOLD = 2.0  # from one size that is tried to the next
LEAST = 20.0  # nats by which an axis must explain more when it creeps or gives,
WORTH = 80.0  # and all together: rigs that creep gained 110 to 765, sealed flights whose friction is a bed of stiff bristles 63 at most


def yielding(case: Case, found: Sequence[Tried], further: float = 0.0) -> Case:
    """The case where those axes creep or give that do so in its logs, beside one of the hypotheses `found`, best first; else the same.

    They must then be WORTH and `further` nats likelier than the best of those. It is asked beside them, as under a model that lacks
    something else an axis often seems to creep; and beside more than the best, as where the axes do creep the best is one that makes up
    for it.
    """
    asked = [(tried, *_yielded(case, tried.fit)) for tried in found]
    promising = sorted(
        ((tried.evidence + gained, tried, supposed) for tried, supposed, gained in asked if gained > 0.0),
        key=lambda entry: -entry[0],
    )
    best, yields = found[0].evidence + WORTH + further, dict[str, Values]()
    for _, tried, supposed in promising[:FITTED]:
        fitted = fit(case, supposed, rounds=4)
        if fitted is not None and evidence(fitted) > best:
            best = evidence(fitted)
            beside = tried.fit.supposed.effects
            yields = {name: values for name, values in fitted.supposed.effects.items() if name not in beside}
    if not yields:
        return case
    exact = {name: dict.fromkeys(values, 0.0) for name, values in yields.items()}
    return replace(case, stated={**case.stated, **yields}, stated_sd={**case.stated_sd, **exact})


def needed(case: Case, best: Tried) -> bool:
    """Whether a hypothesis found where axes yield is worth as much more as that must be, than the same under `case`, where they do not."""
    kept = {name: v for name, v in best.fit.supposed.effects.items() if name in case.stated or name in best.effects}
    fitted = fit(case, with_unrest(case, best.fit.supposed.with_effects(kept)), rounds=4)
    return fitted is None or best.evidence > evidence(fitted) + WORTH


def _yielded(case: Case, found: Fit) -> tuple[Supposed, float]:
    """What was fitted with those axes that yield beside it, one after the other, and what that gains."""
    supposed, value = found.supposed, found.log_likelihood
    for axis in case.kit.bound.model.places.axes:
        ways = [_likeliest(case, supposed, effect, value) for effect in _unstated(case, found.supposed, axis)]
        if ways:
            tried, reached = max(ways, key=lambda way: way[1])
            if reached > value + LEAST:
                supposed, value = tried, reached
    return supposed, value - found.log_likelihood


def _unstated(case: Case, supposed: Supposed, axis: str) -> Iterator[Effect]:
    """The ways in which an axis may yield: none where it never moves, has no dry friction, or is known to yield."""
    ways = [effect for effect in case.kit.effects.values() if effect.place == axis and not effect.names_a_gap]
    moves = any(axis not in flight.locked for flight in case.flights)
    rubs = axis not in case.kit.frictionless or any(f"{axis}.{kind}" in supposed.effects for kind in FRICTIONS)
    if moves and rubs and not any(effect.name in case.stated for effect in ways):
        yield from ways


def _likeliest(case: Case, supposed: Supposed, effect: Effect, value: float) -> tuple[Supposed, float]:
    """The likeliest speed or way in which friction builds up, by folds up, else down, in air as calm as it then is.

    None of it where neither its reference nor a quarter of that is likelier than `value` in the air as it was: where an axis sticks, both
    cost hundreds of nats, and no other air makes up for them.
    """
    reference = effect.size.reference
    first = [(likelihood_of(case, _with(supposed, effect, size)), size) for size in (reference, reference / FOLD**2)]
    if max(first)[0] <= value:
        return supposed, value
    size = max(first)[1]
    best = _settled(case, _with(supposed, effect, size))
    for fold in (FOLD, 1.0 / FOLD):
        step = size * fold
        while reference / FOLD**3 < step < effect.size.upper:
            further = _settled(case, _with(supposed, effect, step))
            if further[1] <= best[1]:
                break
            best, step = further, step * fold
        if step != size * fold:
            break
    return best


def _with(supposed: Supposed, effect: Effect, size: float) -> Supposed:
    return supposed.with_effects({**supposed.effects, effect.name: {effect.size.symbol: size}})


def _settled(case: Case, supposed: Supposed) -> tuple[Supposed, float]:
    """The same in the air that its innovations then show, with its log likelihood."""
    tried = with_unrest(case, supposed)
    return tried, likelihood_of(case, tried)
