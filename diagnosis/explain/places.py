"""Where the gap lies: every hypothesis' probability goes to the places of its effects, by what each of them adds."""

from collections import defaultdict
from collections.abc import Mapping
from types import MappingProxyType

from diagnosis import decisions
from diagnosis.decide.weighing import Weighed
from diagnosis.fit.evidence import FittedHypothesis
from diagnosis.search.beam import Search
from diagnosis.search.sure_sizes import certainties
from records.diagnosis import PlaceShare
from sim.effect import place_and_kind


def place_shares(
    search: Search, weighed: Weighed, unknown_place: str | None, retuned: Mapping[str, float] = MappingProxyType({})
) -> tuple[PlaceShare, ...]:
    """Shares by place, largest first, with a sum of 1; `retuned` are those of parameters beyond their spread."""
    found: defaultdict[str, float] = defaultdict(float)
    for fitted, probability in zip(weighed.fitted, weighed.probabilities, strict=True):
        for place, share in _parts(search, fitted).items():
            found[place] += probability * share
    for place, share in _parts(search, weighed.fitted[0]).items() if weighed.fitted else ():
        found[place] += weighed.partly * share
    if unknown_place is not None:
        found[unknown_place] += weighed.unknown
    for place, share in retuned.items():
        found[place] += weighed.retune * share
    total = sum(found.values())
    kept = (
        {place: share / total for place, share in found.items() if share > decisions.NEGLIGIBLE_SHARE * total}
        if total > 0.0
        else {}
    )
    whole = sum(kept.values())
    rows = [PlaceShare(place, share / whole) for place, share in kept.items()]
    return tuple(sorted(rows, key=lambda row: (-row.share, row.place)))


def _parts(search: Search, fitted: FittedHypothesis) -> Mapping[str, float]:
    """Shares of a hypothesis' places: what the evidence loses without each of its effects."""
    losses = {name: max(_loss(search, fitted, name), 1.0) for name in fitted.effects}
    total = sum(losses.values())
    parts: defaultdict[str, float] = defaultdict(float)
    for name, loss in losses.items():
        parts[place_and_kind(name)[0]] += loss / total
    return parts


def _loss(search: Search, fitted: FittedHypothesis, name: str) -> float:
    """What the evidence loses without an effect: half the square of how surely its size is not zero where that was not tried, at most what
    all of them gain together."""
    rest = set(fitted.effects) - {name}
    without = search.of(rest) if rest else search.nominal
    if without is not None:
        return fitted.evidence - without.evidence
    return min(0.5 * certainties(fitted.fit).get(name, 0.0) ** 2, fitted.evidence - search.nominal.evidence)
