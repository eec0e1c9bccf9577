"""Whether a torque that comes and goes is the whole gap: noise of the plant alone, told where it is more than a rig's usual."""

from dataclasses import dataclass

from diagnosis import decisions
from diagnosis.decisions import decided
from diagnosis.fit.coloured_noise import coloured_noise_of
from diagnosis.fit.evidence import FittedHypothesis, as_fitted
from diagnosis.fit.gauss_newton import fit
from diagnosis.hypothesis.case import Case
from records.reasons import Decision
from sim.effect import Role

QUIET_ROUNDS = 4


@dataclass(frozen=True, eq=False)
class Draught:
    """The plant with a gust, and the plant that has none."""

    gusty: FittedHypothesis
    quiet: FittedHypothesis


def draught(case: Case, retuned: FittedHypothesis) -> tuple[Draught | None, tuple[Decision, ...]]:
    """The strongest gust of the plant's noise, `retuned` within its spread, where it is worth telling; and the rule that says so."""
    library, hypothesis = case.library, retuned.fit.hypothesis
    shares = {
        name: hypothesis.effects[name][library.effects[name].symbol(Role.STRENGTH)]
        / library.bound.model.places.axes[library.effects[name].place].torque_size
        for name in hypothesis.effects
        if library.effects[name].is_noise
    }
    if not shares:
        return None, ()
    name = max(shares, key=lambda name: shares[name])
    told = shares[name] >= decisions.DRAUGHT
    rule = decided("draught", name, shares[name], decisions.DRAUGHT, "a gust" if told else "usual noise")
    if not told:
        return None, (rule,)
    still = hypothesis.with_effects({other: v for other, v in hypothesis.effects.items() if other != name})
    found = fit(case, coloured_noise_of(case, still), rounds=QUIET_ROUNDS)
    if found is None:
        return None, (rule,)
    return Draught(FittedHypothesis((name,), retuned.fit, retuned.evidence), as_fitted(case, found)), (rule,)
