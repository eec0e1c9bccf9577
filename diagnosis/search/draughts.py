"""Torques that come and go: noise of the plant, and told as a gust where nothing else is missing and they are more than a rig's usual.

White noise w of an axis' speed, in rad/s per sqrt(s), is the gust of the shortest memory T: what is slower feels no difference where

(1)  sigma = J w / sqrt(2 T)        J: the axis' inertia where the logs begin
"""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace

import numpy as np
import sympy

from diagnosis import decisions
from diagnosis.decisions import decided
from diagnosis.fit.coloured_noise import coloured_noise_of
from diagnosis.fit.evidence import FittedHypothesis, as_fitted, log_evidence
from diagnosis.fit.gauss_newton import fit
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import Hypothesis, has_memory, noise_on
from records.reasons import Decision
from sim.bind import named_values
from sim.effect import Effect, Role

STILL_ROUNDS = 6


@dataclass(frozen=True, eq=False)
class Draught:
    """The plant with a gust, and the plant that has none."""

    gusty: FittedHypothesis
    quiet: FittedHypothesis


def draught(case: Case, retuned: FittedHypothesis) -> tuple[Draught | None, tuple[Decision, ...]]:
    """The strongest gust of the plant's noise, `retuned` within its spread, where it is worth telling; and the rule that says so."""
    shares = gust_shares(case, retuned.fit.hypothesis)
    name, rules = _worth_telling(shares)
    return (None if name is None else _of_memory(case, retuned, name)), rules


def knocks(case: Case, retuned: FittedHypothesis) -> tuple[Draught | None, tuple[Decision, ...]]:
    """The same of its white noise."""
    shares = white_shares(case, retuned.fit.hypothesis)
    name, rules = _worth_telling(shares)
    return (None if name is None else _of_white(case, retuned, name, shares[name])), rules


def _worth_telling(shares: Mapping[str, float]) -> tuple[str | None, tuple[Decision, ...]]:
    """The largest share that is no usual noise, and the rule; nothing of none."""
    name = max(shares, key=lambda name: shares[name], default=None)
    if name is None:
        return None, ()
    told = shares[name] >= decisions.USUAL_GUST
    rule = decided("draught", name, shares[name], decisions.USUAL_GUST, "a gust" if told else "usual noise")
    return (name if told else None), (rule,)


def _of_memory(case: Case, retuned: FittedHypothesis, name: str) -> Draught | None:
    quiet = without_gusts(case, retuned, [name])
    return None if quiet is None else Draught(FittedHypothesis((name,), retuned.fit, retuned.evidence), quiet)


def _of_white(case: Case, retuned: FittedHypothesis, name: str, share: float) -> Draught | None:
    """The plant whose white noise is the usual at most, with and without the rest as a gust; None where neither follows the logs."""
    hypothesis, effect, usual = retuned.fit.hypothesis, case.library.effects[name], decisions.USUAL_GUST
    axis = next(axis for axis in range(len(hypothesis.process_noise)) if noise_on(case, axis) is effect)
    process_noise = hypothesis.process_noise.copy()
    process_noise[axis] += np.log10(usual / share)
    as_usual = replace(hypothesis, process_noise=process_noise)
    size = case.library.bound.model.places.axes[effect.place].torque_size * float(np.sqrt(share**2 - usual**2))
    rest = {effect.symbol(Role.STRENGTH): size, effect.symbol(Role.MEMORY): _shortest_s(effect)}
    quiet = fit(case, as_usual, rounds=STILL_ROUNDS)
    gusty = fit(case, as_usual.with_effects({**hypothesis.effects, name: rest}), rounds=STILL_ROUNDS)
    if quiet is None or gusty is None:
        return None
    return Draught(FittedHypothesis((name,), gusty, log_evidence(gusty, case.library.effects)), as_fitted(case, quiet))


def gust_shares(case: Case, hypothesis: Hypothesis) -> dict[str, float]:
    """The standard deviation of each torque that comes and goes, as a share of its axis' usual torque."""
    effects, axes = case.library.effects, case.library.bound.model.places.axes
    return {
        name: hypothesis.effects[name][effects[name].symbol(Role.STRENGTH)] / axes[effects[name].place].torque_size
        for name in hypothesis.effects
        if effects[name].is_noise
    }


def white_shares(case: Case, hypothesis: Hypothesis) -> dict[str, float]:
    """The same of each axis' white noise as a gust, by eq (1)."""
    model, p, found = case.library.bound.model, case.library.bound.p.copy(), dict[str, float]()
    p[case.free] += hypothesis.theta * case.sd
    start = dict(zip(model.states, case.flights[0].x0.tolist(), strict=False))  # without states that effects brought
    for index, axis in enumerate(model.axes):
        effect = noise_on(case, index)
        if effect is not None:
            inertia = sympy.sympify(axis.inertia).subs({**named_values(model, p), **start})
            inertia = inertia.subs(dict.fromkeys(inertia.free_symbols, 0))  # of inputs, say
            sigma = float(inertia) * 10.0 ** hypothesis.process_noise[index] / float(np.sqrt(2.0 * _shortest_s(effect)))
            found[effect.name] = sigma / model.places.axes[axis.name].torque_size
    return found


def _shortest_s(gust: Effect) -> float:
    return gust.parameter[gust.symbol(Role.MEMORY)].lower


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
