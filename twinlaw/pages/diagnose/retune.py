"""What a re-tune did: which of the plant's own numbers moved, and how far from what the plant file states."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from diagnosis.result import Result
from records.diagnosis import Diagnosis
from records.plant import Plant
from sim.effect import place_and_kind
from twinlaw.pages.diagnose.words import shown

MOST_MOVED = 3
UNMOVED_SD = 0.1  # standard deviations below which a number has not moved
LOWERED = 0.5  # of the stated plant's error that a re-tune must leave at most to be told


@dataclass(frozen=True)
class Moved:
    """A number of the plant file, and how many of its standard deviations it moved away from what is stated."""

    name: str
    away_sd: float

    @property
    def text(self) -> str:
        """ "K_M +2.1 sd"."""
        return f"{self.name} {self.away_sd:+.1f} sd"


def moved_most(result: Result) -> tuple[Moved, ...]:
    """The numbers of the improved plant that moved furthest, at most MOST_MOVED, the furthest first."""
    found = [*_parameters(result), *_stated_effects(result)]
    far = [entry for entry in found if abs(entry.away_sd) >= UNMOVED_SD]
    return tuple(sorted(far, key=lambda entry: -abs(entry.away_sd))[:MOST_MOVED])


def _parameters(result: Result) -> Iterator[Moved]:
    bound = result.case.library.bound
    names = [str(symbol) for symbol in bound.model.parameter_symbols]
    order = [spec.name for spec in bound.model.parameters]
    stated, now = _values(bound.plant, order), _values(result.plant, order)
    for name, (value, sd), (moved, _) in zip(names, stated, now, strict=True):
        if sd > 0.0:
            yield Moved(name, (moved - value) / sd)


def _values(plant: Plant, order: Sequence[str]) -> list[tuple[float, float]]:
    """Value and standard deviation of every coefficient."""
    entries = [plant.parameters[name] for name in order]
    return [pair for entry in entries for pair in zip(entry.values, entry.sds, strict=True)]


def _stated_effects(result: Result) -> Iterator[Moved]:
    """Numbers of effects that the plant file states itself."""
    for effect, values in result.case.stated.items():
        place, kind = place_and_kind(effect)
        now = result.plant.effects.get(place, {}).get(kind, {})
        for symbol, stated in values.items():
            sd = result.case.stated_sd[effect][symbol]
            if sd > 0.0 and symbol in now:
                yield Moved(f"{symbol} of {effect}", (now[symbol]["value"] - stated) / sd)


def moved_in_words(moved: Sequence[Moved]) -> str:
    """The moved numbers in one line."""
    return ", ".join(entry.text for entry in moved)


def parameters_alone(diagnosis: Diagnosis) -> float:
    """The probability that other parameters explain the gap and nothing is missing."""
    named = diagnosis.partly + sum(h.probability for h in diagnosis.effects)
    return max(0.0, 1.0 - diagnosis.unknown.probability - named)


def lowered(diagnosis: Diagnosis) -> dict[str, tuple[float, float]]:
    """By output whose hold-out error a re-tune alone lowers much: the error as stated, and re-tuned."""
    shrinkage = diagnosis.shrinkage
    if shrinkage is None:
        return {}
    pairs = {name: (rms, shrinkage.rms_before[name]) for name, rms in shrinkage.rms_nominal.items()}
    return {name: (stated, now) for name, (stated, now) in pairs.items() if now < LOWERED * stated}


def retuned_sentence(diagnosis: Diagnosis, moved: Sequence[Moved]) -> str:
    """How much re-tuning alone lowers the hold-out error, and which numbers moved; empty where neither is worth a sentence."""
    parts = []
    for output, (stated, now) in lowered(diagnosis).items():
        name, unit, scale = shown(output)
        parts.append(f"{name} from {scale * stated:.3g} to {scale * now:.3g} {unit.strip('[]')}".strip())
    told = f"Re-tuning alone lowers the error of {', of '.join(parts)}. " if parts else ""
    beside = " beside what was found" if diagnosis.found else ""
    if moved:
        told += f"What moved most{beside}, in standard deviations (sd) of what the plant file states: {moved_in_words(moved)}."
    return told.strip()
