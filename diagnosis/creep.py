"""Friction near rest, which a plant's file leaves open: whether its axes stick, or creep where they are pushed too little to slide."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

from diagnosis.case import Case
from diagnosis.fit import Fit, likelihood
from diagnosis.hypothesis import Supposed, passes
from diagnosis.trial import Tried
from diagnosis.unrest import with_unrest
from sim.effects.effect import Effect

FOLD = 2.0  # from one speed that is tried to the next
LEAST = 20.0  # nats by which an axis must explain more when it creeps,
WORTH = 80.0  # and all together: rigs that creep gained 110 to 765, sealed flights whose friction is a bed of bristles 63 at most


def creeping(case: Case, found: Sequence[Tried]) -> Case:
    """The case where those axes creep that do so in its logs, beside one of the hypotheses `found`, best first; else the same object.

    It is asked beside them, as under a model that lacks something else an axis often seems to creep; and beside more than the best, as
    where the axes do creep the best is one that makes up for it.
    """
    best, chosen = found[0].evidence + WORTH, case.stated
    for tried in found:
        supposed, gained = _crept(case, tried.fit)
        if gained and tried.evidence + gained > best:
            best = tried.evidence + gained
            chosen = {
                **case.stated,
                **{name: v for name, v in supposed.effects.items() if name not in tried.fit.supposed.effects},
            }
    if chosen is case.stated:
        return case
    exact = {name: dict.fromkeys(values, 0.0) for name, values in chosen.items()}
    return replace(case, stated=chosen, stated_sd={**exact, **case.stated_sd})


def _crept(case: Case, found: Fit) -> tuple[Supposed, float]:
    """What was fitted with those axes that creep beside it, one after the other, and what that gains."""
    supposed, value = found.supposed, found.log_likelihood
    for effect in _unstated(case):
        tried, reached = _likeliest(case, supposed, effect)
        if reached > value + LEAST:
            supposed, value = tried, reached
    return supposed, value - found.log_likelihood


def _unstated(case: Case) -> Iterator[Effect]:
    for name, effect in case.kit.effects.items():
        moves = any(effect.place not in flight.locked for flight in case.flights)
        if effect.kind == "creep" and effect.place not in case.kit.frictionless and name not in case.stated and moves:
            yield effect


def _likeliest(case: Case, supposed: Supposed, effect: Effect) -> tuple[Supposed, float]:
    """The likeliest speed over which the friction builds up, from its reference by folds up, else down, in air as calm as it then is."""

    def at(speed: float) -> tuple[Supposed, float]:
        effects = {**supposed.effects, effect.name: {effect.size.symbol: speed}}
        tried = with_unrest(case, supposed.with_effects(effects))
        runs = passes(case, tried)
        return tried, float("-inf") if runs is None else likelihood(runs)

    speed = effect.size.reference
    best = at(speed)
    for fold in (FOLD, 1.0 / FOLD):
        step = speed * fold
        while effect.size.reference / 8.0 < step < effect.size.upper:
            further = at(step)
            if further[1] <= best[1]:
                break
            speed, best, step = step, further, step * fold
        if speed != effect.size.reference:
            break
    return best
