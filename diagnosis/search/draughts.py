"""Torques that come and go: noise of the plant, and told as a gust where nothing else is missing and they are more than a rig's usual."""

from collections.abc import Collection
from dataclasses import dataclass, replace

from diagnosis import decisions
from diagnosis.decisions import decided
from diagnosis.fit.coloured_noise import coloured_noise_of
from diagnosis.fit.evidence import FittedHypothesis, as_fitted
from diagnosis.fit.gauss_newton import fit
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import Hypothesis, has_memory, noise_on
from records.reasons import Decision
from sim.effect import Role

STILL_ROUNDS = 6


@dataclass(frozen=True, eq=False)
class Draught:
    """The plant with a gust, and the plant that has none."""

    gusty: FittedHypothesis
    quiet: FittedHypothesis


def draught(case: Case, retuned: FittedHypothesis) -> tuple[Draught | None, tuple[Decision, ...]]:
    """The strongest gust of the plant's noise, `retuned` within its spread, where it is worth telling; and the rule that says so."""
    shares = gust_shares(case, retuned.fit.hypothesis)
    if not shares:
        return None, ()
    name = max(shares, key=lambda name: shares[name])
    told = shares[name] >= decisions.USUAL_GUST
    rule = decided("draught", name, shares[name], decisions.USUAL_GUST, "a gust" if told else "usual noise")
    quiet = without_gusts(case, retuned, [name]) if told else None
    if quiet is None:
        return None, (rule,)
    return Draught(FittedHypothesis((name,), retuned.fit, retuned.evidence), quiet), (rule,)


def gust_shares(case: Case, hypothesis: Hypothesis) -> dict[str, float]:
    """The standard deviation of each torque that comes and goes, as a share of its axis' usual torque."""
    effects, axes = case.library.effects, case.library.bound.model.places.axes
    return {
        name: hypothesis.effects[name][effects[name].symbol(Role.STRENGTH)] / axes[effects[name].place].torque_size
        for name in hypothesis.effects
        if effects[name].is_noise
    }


def without_memory(case: Case, fitted: FittedHypothesis) -> FittedHypothesis | None:
    """The same fitted without any noise with a memory, of axes or of readings; None where it has none, or cannot follow its logs then."""
    hypothesis = fitted.fit.hypothesis
    if not has_memory(case, hypothesis):
        return None
    gusts = list(gust_shares(case, hypothesis))
    read = replace(fitted, fit=replace(fitted.fit, hypothesis=replace(hypothesis, reading_noise={})))
    return without_gusts(case, read, gusts)


def without_gusts(case: Case, fitted: FittedHypothesis, names: Collection[str]) -> FittedHypothesis | None:
    """The same fitted without some of its torques that come and go; None where the plant cannot follow its logs then.

    White noise, of which such a torque may have left none, begins on its axis where it does before any log is seen.
    """
    hypothesis, process_noise = fitted.fit.hypothesis, fitted.fit.hypothesis.process_noise.copy()
    for axis in range(len(process_noise)):
        gust = noise_on(case, axis)
        if gust is not None and gust.name in names:
            process_noise[axis] = max(process_noise[axis], decisions.FIRST_PROCESS_NOISE)
    kept = {name: v for name, v in hypothesis.effects.items() if name not in names}
    still = replace(hypothesis.with_effects(kept), process_noise=process_noise)
    found = fit(case, coloured_noise_of(case, still), rounds=STILL_ROUNDS)
    return None if found is None else as_fitted(case, found)
