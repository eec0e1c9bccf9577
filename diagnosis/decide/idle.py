"""Effects that earn no name: beside the others of a hypothesis they predict too little, in every output, or not surely.

Some thousand rows make any small thing certain: what an effect gains in evidence alone it may gain of what the others' forms are a little
off, or of what happened once in the logs that were fitted. So of each effect the errors of the same without it are asked, output by output,
as what it does to one output says nothing of what another effect does to another.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from diagnosis import decisions
from diagnosis.decide.holdout import Holdout
from diagnosis.decide.weighing import Explanations, beyond_spread, read_off
from diagnosis.decisions import held_against
from diagnosis.fit.evidence import FittedHypothesis
from diagnosis.library.effect_library import EffectLibrary
from diagnosis.search.exchange import is_twin
from diagnosis.validate.fitted_logs import FittedLogs
from diagnosis.validate.score import Errors, by_output
from jobs.thread_map import thread_map
from records.reasons import Decision


@dataclass(frozen=True)
class Said:
    """What logs say of one effect in one output: `nats` by which the hypothesis predicts better than without it, with their standard
    error `sd`, and `whole`, by which it does so better than what is read off the logs, a sensor's steps, of which no form can be a little
    off, or the plant alone; of so many `readings`."""

    nats: float
    sd: float
    whole: float
    readings: int

    @property
    def sure(self) -> bool:
        """Whether it surely predicts better."""
        return self.nats > decisions.SURELY * self.sd


Pair = tuple[FittedHypothesis, FittedHypothesis]  # a hypothesis and the same with one effect less
Shares = Mapping[
    Pair, Sequence[Sequence[Said]]
]  # by output of the logs that were fitted, and of those held out where these have a say


def shares_of(
    explanations: Explanations, asked: Iterable[FittedHypothesis], logs: FittedLogs, holdout: Holdout | None
) -> Shares:
    """What the logs say of each effect of what was `asked` beside the others, where the same without it was asked too."""
    known = set(asked)
    pairs = [(entry, fewer) for entry in explanations.named if entry in known for fewer in one_less(entry, known)]
    plain = explanations.nominal.fit.hypothesis

    def said(entry: FittedHypothesis, fewer: FittedHypothesis) -> list[list[Said]]:
        read = read_off(explanations, entry)
        fitted = _said(
            logs.readings, *(logs.errors_beside(each.fit.hypothesis, plain) for each in (entry, fewer, read))
        )
        return [fitted] if holdout is None else [fitted, *_held_out(holdout, entry, fewer, read)]

    return dict(zip(pairs, thread_map(said, *zip(*pairs, strict=True)), strict=True)) if pairs else {}


def _held_out(
    holdout: Holdout, entry: FittedHypothesis, fewer: FittedHypothesis, read: FittedHypothesis
) -> list[list[Said]]:
    """What a hold-out says; nothing where it lacks a part of the hypothesis, that happened in other logs: what it did there is an error
    beside which no other part shows."""
    if set(entry.effects) - set(holdout.foreseen(entry.fit.hypothesis).effects):
        return []
    rival = read if read.effects else holdout.base
    return [_said(holdout.readings, *(holdout.errors_foreseen(each.fit.hypothesis) for each in (entry, fewer, rival)))]


def _said(readings: int, one: Errors, other: Errors, rival: Errors) -> list[Said]:
    return [
        Said(readings * further.gain, readings * further.sd, readings * whole.gain, readings)
        for further, whole in zip(by_output(one, other), by_output(replace(one, grid=rival.grid), rival), strict=True)
    ]


def without_idle(explanations: Explanations, shares: Shares) -> tuple[Explanations, tuple[Decision, ...]]:
    """What was tried, without hypotheses one of whose effects earns no name, and the rules.

    In one output at least an effect must do FORMS_OFF of what the hypothesis predicts better, and surely: in the logs that were not fitted,
    or in those that were where the others cannot tell. What parameters beyond their spread cost counts: where these leave it to take an
    effect's part, it is not idle.
    The same without an idle effect keeps the evidence that it has beside it: what that explains is there whatever its name. So it is for
    what is hardly told from that, whether or not it was tried there.
    """
    idle = [
        (entry, fewer, nats, least)
        for entry, fewer in sorted(shares, key=lambda pair: -len(pair[0].effects))
        for nats, least in [_hardest(shares[entry, fewer], beyond_spread(fewer) - beyond_spread(entry))]
        if nats < least
    ]
    rules = tuple(
        held_against(
            "each_matters",
            " + ".join(entry.effects),
            nats,
            least,
            "nats",
            f"{' + '.join(sorted(set(entry.effects) - set(fewer.effects)))} is left out",
        )
        for entry, fewer, nats, least in idle
    )
    beside = dict(explanations.beside)
    for entry, fewer, *_ in idle:  # triples first, so that what a pair has beside an idle effect reaches a single one
        beside[fewer] = max(beside.get(fewer, -np.inf), beside.get(entry, -np.inf), entry.evidence)
    gone = {entry for entry, *_ in idle}
    kept = tuple(entry for entry in explanations.named if entry not in gone)
    return replace(explanations, named=kept, beside=_beside_twins(explanations.library, kept, beside)), rules


def _beside_twins(
    library: EffectLibrary, kept: Sequence[FittedHypothesis], beside: Mapping[FittedHypothesis, float]
) -> dict[FittedHypothesis, float]:
    """Evidence beside idle effects: of what has some, and of its twins, beside which these gain as much, yet to no more than it has."""
    found = dict(beside)
    for entry in (entry for entry in kept if entry in beside):
        for twin in (other for other in kept if is_twin(library, other, entry)):
            gained = twin.evidence + beside[entry] - entry.evidence
            found[twin] = max(found.get(twin, -np.inf), min(gained, beside[entry]))
    return found


def _hardest(said: Sequence[Sequence[Said]], spared: float) -> tuple[float, float]:
    """Nats and how many they must be, of what an effect passes with least room in the output that speaks most for it; `spared` are those
    that parameters need not pay for it."""

    def of_output(parts: Sequence[Said]) -> tuple[float, float]:
        share = decisions.FORMS_OFF * max(sum(part.whole for part in parts), 0.0)
        judge = parts[0] if len(parts) == 1 or _cannot_tell(*parts) else parts[1]
        surely = judge.nats + spared, decisions.SURELY * judge.sd
        return min(surely, (sum(part.nats for part in parts) + spared, share), key=lambda pair: pair[0] - pair[1])

    return max((of_output(parts) for parts in zip(*said, strict=True)), key=lambda pair: pair[0] - pair[1])


def _cannot_tell(fitted: Said, held_out: Said) -> bool:
    """Whether logs that were not fitted are neither sure of an effect nor sure that it does less than in those that were."""
    promised = fitted.nats * held_out.readings / fitted.readings
    return not held_out.sure and held_out.nats + decisions.SURELY * held_out.sd >= promised


def one_less(entry: FittedHypothesis, asked: Iterable[FittedHypothesis]) -> list[FittedHypothesis]:
    """What was asked with all effects but one of it; nothing of a single effect."""
    return [
        other
        for other in asked
        if len(other.effects) == len(entry.effects) - 1 > 0 and set(other.effects) < set(entry.effects)
    ]
