"""What one believes of a hypothesis before any log: the common effects come before the rare, a size of the wrong sign is no such effect.

What is believed of each effect stands with it (sim/effects, `Prior` and `Unlikely`).
"""

from collections.abc import Collection, Mapping

from diagnosis.fit.evidence import FittedHypothesis
from sim.effect import Effect, Role

AT_ITS_END = (
    -4.5
)  # of a size at the end of its range, which holds what such rigs have: a lag of a second is something else


def prior_odds(
    fitted: FittedHypothesis,
    effects: Mapping[str, Effect],
    frictionless: Collection[str] = (),
    steps: Mapping[str, float] = {},
) -> float:
    """Log of how much less probable a hypothesis is before the data than one of as many common effects.

    `effects` is the plant's library, `frictionless` are the axes that have no dry friction as stated, `steps` those of the sensors by
    place, in the unit of what they read.
    """
    own = [effects[name] for name in fitted.effects]
    losses = any(effect.loses_commands for effect in own)
    return (
        sum(_odds(effect, fitted, losses, effect.place in frictionless) for effect in own)
        + sum(effect.prior.frictionless for effect in own if effect.place in frictionless)
        + sum(_rounding(effect, fitted, steps.get(effect.place, 0.0)) for effect in own)
    )


def _odds(effect: Effect, fitted: FittedHypothesis, losses: bool, is_frictionless: bool) -> float:
    values, odds = fitted.fit.hypothesis.effects[effect.name], effect.prior.log_odds
    for parameter in effect.parameters:
        unlikely = parameter.unlikely
        if (
            unlikely is None
            or (unlikely.beside_losses and not losses)
            or (unlikely.frictionless and not is_frictionless)
        ):
            continue
        if unlikely.holds(values.get(parameter.symbol, parameter.first)):
            odds += unlikely.log_odds
    return odds + AT_ITS_END if _at_its_end(effect.name, fitted) else odds


def _rounding(effect: Effect, fitted: FittedHypothesis, step: float) -> float:
    """What sizes that may be a sensor's rounding lose."""
    values = fitted.fit.hypothesis.effects[effect.name]
    return sum(
        p.unlikely.log_odds
        for p in effect.parameters
        if p.unlikely and p.unlikely.rounds(values.get(p.symbol, p.first), step)
    )


def _at_its_end(name: str, fitted: FittedHypothesis) -> bool:
    """Whether a fitted size of an effect went as far from zero as it may, or a sine has as few waves or as many as it may."""
    values = fitted.fit.hypothesis.effects[name]
    own = [entry.parameter for entry in fitted.fit.free if entry.effect == name]
    return any(values[p.symbol] in {p.lower, p.upper} - {p.zero} for p in own if p.is_size or p.role is Role.WAVES)
