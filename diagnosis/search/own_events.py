"""What happens at an instant happens at another one in each log: such an effect with an instant and a size of its own in each."""

from collections.abc import Mapping

from diagnosis import decisions
from diagnosis.detect.instants import happens
from diagnosis.detect.linearisation import linearised
from diagnosis.detect.score_tests import score_effects
from diagnosis.fit.evidence import FittedHypothesis, as_fitted
from diagnosis.fit.gauss_newton import fit
from diagnosis.hypothesis.case import Case, FilteredLog
from diagnosis.hypothesis.hypothesis import ELSEWHERE, Hypothesis
from diagnosis.search.fitting import refined
from sim.effect import Effect, Values

OWN_ROUNDS = 6


def with_own_events(case: Case, fitted: FittedHypothesis) -> FittedHypothesis:
    """The hypothesis with each of its events by log, where that is likelier; itself where it has none, or there is one log only."""
    if len(case.flights) < 2:
        return fitted
    hypothesis, effects = fitted.fit.hypothesis, case.library.effects
    for name in fitted.effects:
        if happens(effects[name], hypothesis.effects[name]) and name not in hypothesis.own:
            own = _in_each(case, hypothesis, effects[name])
            hypothesis = hypothesis if own is None else hypothesis.with_own(name, own)
    if hypothesis is fitted.fit.hypothesis:
        return fitted
    begun = fit(case, hypothesis, rounds=OWN_ROUNDS)
    end = None if begun is None else refined(case, as_fitted(case, begun))
    return end if end is not None and end.evidence > fitted.evidence else fitted


def _in_each(case: Case, hypothesis: Hypothesis, effect: Effect) -> Mapping[int, Values] | None:
    """The effect's values by log, all else as it is; of no size where a log does not show it. None where no log does."""
    absent = {**effect.absent, effect.size.symbol: effect.size.zero or 0.0}
    without = hypothesis.with_effects({n: v for n, v in hypothesis.effects.items() if n != effect.name})
    found = {flight.number: _seen(case, without, effect, flight) for flight in case.flights}
    if not any(found.values()):
        return None
    return {ELSEWHERE: absent, **{log: values or absent for log, values in found.items()}}


def _seen(case: Case, without: Hypothesis, effect: Effect, flight: FilteredLog) -> Values | None:
    """When and how large one log shows an effect; None where it does not."""
    alone = case.with_flights([flight])
    at = fit(alone, without.over(flight), rounds=0)
    if at is None:
        return None
    tests = score_effects(alone, linearised(alone, at), [effect.name])
    return tests[0].values if tests and tests[0].gain > decisions.TAKEN_IN else None
