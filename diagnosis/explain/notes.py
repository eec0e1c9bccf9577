"""Sentences that go with a diagnosis: which parameters moved, what looks alike and why, what these data could not have shown."""

from collections.abc import Iterator, Sequence

from diagnosis import decisions
from diagnosis.decide.weighing import Weighed, alike
from diagnosis.detect.score_tests import ScoreTest
from diagnosis.detect.visibility import cannot_tell, hidden, judged
from diagnosis.fit.evidence import FittedHypothesis
from diagnosis.fit.gauss_newton import size_scale
from diagnosis.fit.moved import moved_effects, moved_parameters
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import coefficients
from diagnosis.library.effect_library import is_gust

HIDDEN = "effects of the library would go unseen in these logs"
UNSEEN = "too little excitation to see"
UNFOLLOWED = "not looked for, as no filter knows where a rotor stands in its turn"
IMITATION = "a re-tune of the plant's own parameters imitates these, so these data cannot tell them"


def notes_of(
    case: Case, score_tests: Sequence[ScoreTest], chosen: FittedHypothesis, weighed: Weighed | None
) -> tuple[str, ...]:
    """All sentences."""
    return (
        *_presliding(case, chosen),
        *_moved(case, chosen),
        *_twins(case, weighed),
        *_imitated(score_tests, chosen),
        *_unseen(case, score_tests, chosen),
        *_unfollowed(case),
    )


def _presliding(case: Case, chosen: FittedHypothesis) -> Iterator[str]:
    """What is supposed of friction near rest: found in these logs, or stated in the plant file as known exactly."""
    for name, values in chosen.fit.hypothesis.effects.items():
        effect = case.library.effects[name]
        if not effect.names_a_gap and case.stated_sd[name] == dict.fromkeys(values, 0.0):
            size = effect.size
            how = effect.story[0].lower() + effect.story[1:-1]
            yield f"{effect.place}, no gap: {how} ({size.symbol} {values[size.symbol]:.2g} {size.unit})"


def _moved(case: Case, chosen: FittedHypothesis) -> Iterator[str]:
    names = [str(symbol) for symbol in case.library.bound.model.parameter_symbols]
    theta = chosen.fit.hypothesis.theta
    p = coefficients(case, case.library.plain, chosen.fit.hypothesis.with_effects({}))  # what cannot be negative is not
    for index in moved_parameters(case, theta, decisions.MOVED_FAR):
        place = int(case.free[index])
        yield (
            f"parameter {names[place]} is {theta[index]:+.1f} standard deviations from its stated value: "
            f"{p[place]:.4g} instead of {case.library.bound.p[place]:.4g}"
        )
    for entry in moved_effects(chosen.fit, decisions.MOVED_FAR):
        symbol, stated = entry.parameter.symbol, entry.stated or 0.0
        sd = case.stated_sd[entry.effect][symbol]
        value = chosen.fit.hypothesis.effects[entry.effect][symbol]
        yield (
            f"{symbol} of {entry.effect} is {(value - stated) / sd:+.1f} standard deviations from its stated value: "
            f"{value:.4g} instead of {stated:.4g}"
        )


def _twins(case: Case, weighed: Weighed | None) -> Iterator[str]:
    if weighed is None or not weighed.fitted:
        return
    first = weighed.fitted[0]
    for other in alike(weighed, first):
        for name in other.effects:
            for own in first.effects:
                effects = case.library.effects
                reason = effects[own].twins.get(name) or effects[name].twins.get(own)
                if reason:
                    yield f"{own} and {name}: {reason}"


def _imitated(score_tests: Sequence[ScoreTest], chosen: FittedHypothesis) -> Iterator[str]:
    hidden = sorted(
        entry.effect
        for entry in score_tests
        if entry.absorbed > decisions.IMITATED and entry.effect not in chosen.effects
    )
    if hidden:
        kinds = [f"{place} {', '.join(name.split('.')[1] for name in names)}" for place, names in _by_place(hidden)]
        yield f"{IMITATION}: {'; '.join(kinds)}"


def _unseen(case: Case, score_tests: Sequence[ScoreTest], chosen: FittedHypothesis) -> Iterator[str]:
    """How large effects could be without being seen: a sentence for each place, the largest in units of its reference size first."""
    unseen = hidden(case, score_tests)
    imitated = {entry.effect for entry in score_tests if entry.absorbed > decisions.IMITATED}
    if cannot_tell(case, score_tests):
        whole = len(judged(case, score_tests))
        yield f"{len(unseen)} of {whole} {HIDDEN} at the size that they may well have"
    said = {
        name: ratio
        for name, ratio in unseen.items()
        if name not in imitated and name not in chosen.fit.hypothesis.effects
    }
    for place, names in _by_place(sorted(said, key=lambda name: (-said[name], name))):
        sizes = {name.split(".")[1]: _up_to(case, name, said[name]) for name in names}
        never = ", ".join(kind for kind, size in sizes.items() if size is None)
        parts = [f"{never} of any size"] if never else []
        parts += [f"{kind} below {size}" for kind, size in sizes.items() if size is not None]
        yield f"{UNSEEN} at the {place}: {'; '.join(parts)}"


def _unfollowed(case: Case) -> Iterator[str]:
    names = [name for name, effect in case.library.effects.items() if not (effect.repeats or is_gust(name))]
    if names:
        yield f"{UNFOLLOWED}: {', '.join(names)}"


def _up_to(case: Case, name: str, ratio: float) -> str | None:
    """The size below which an effect hides, `ratio` times its reference; None where that is beyond all that it can have."""
    size = case.library.effects[name].size
    away = ratio * size_scale(size)
    if away >= size.upper - size.lower:
        return None
    unit = "" if size.unit == "-" else f" {size.unit}"
    return f"{size.symbol} = {(size.zero or 0.0) + away:.3g}{unit}"


def _by_place(names: Sequence[str]) -> list[tuple[str, list[str]]]:
    """Names by their place, in the order in which each place first comes."""
    places: dict[str, list[str]] = {}
    for name in names:
        places.setdefault(name.split(".")[0], []).append(name)
    return list(places.items())
