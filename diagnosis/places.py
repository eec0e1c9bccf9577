"""Where the gap lies: every hypothesis' probability goes to the places of its effects, by what each of them adds."""

from collections import defaultdict
from collections.abc import Mapping, Sequence

from diagnosis.search import Search
from diagnosis.trial import Tried
from diagnosis.weigh import Weighed
from records.diagnosis import PlaceShare

LEAST = 0.005


def place_shares(
    search: Search, weighed: Weighed, unknown_place: str | None, retuned_places: Sequence[str] = ()
) -> tuple[PlaceShare, ...]:
    """Shares by place, largest first, with a sum of 1."""
    found: defaultdict[str, float] = defaultdict(float)
    for tried, probability in zip(weighed.tried, weighed.probabilities, strict=True):
        for place, share in _parts(search, tried).items():
            found[place] += probability * share
    if unknown_place is not None:
        found[unknown_place] += weighed.unknown
    for place in retuned_places:
        found[place] += weighed.retune / len(retuned_places)
    total = sum(found.values())
    kept = {place: share / total for place, share in found.items() if share > LEAST * total} if total > 0.0 else {}
    whole = sum(kept.values())
    rows = [PlaceShare(place, share / whole) for place, share in kept.items()]
    return tuple(sorted(rows, key=lambda row: (-row.share, row.place)))


def _parts(search: Search, tried: Tried) -> Mapping[str, float]:
    """Shares of a hypothesis' places: what the evidence loses without each effect, where that was tried."""
    losses = []
    for name in tried.effects:
        without = search.of(set(tried.effects) - {name}) if len(tried.effects) > 1 else search.nominal
        losses.append(1.0 if without is None else max(tried.evidence - without.evidence, 1.0))
    total = sum(losses)
    parts: defaultdict[str, float] = defaultdict(float)
    for name, loss in zip(tried.effects, losses, strict=True):
        parts[name.split(".")[0]] += loss / total
    return parts
