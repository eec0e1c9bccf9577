"""What is to be known beside a diagnosis: which parameters moved, what looks alike and why, what these data could not have shown."""

from collections.abc import Iterator, Sequence

from diagnosis import decisions
from diagnosis.decide.weighing import Weighed, alike
from diagnosis.detect.starts import ScoreTest
from diagnosis.explain.visibility import cannot_tell, hidden, judged
from diagnosis.fit.evidence import FittedHypothesis
from diagnosis.fit.free_numbers import size_scale
from diagnosis.fit.moved import moved_effects, moved_parameters
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import ELSEWHERE, coefficients
from records.reasons import Note
from sim.effect import Role, place_and_kind


def notes_of(
    case: Case,
    score_tests: Sequence[ScoreTest],
    chosen: FittedHypothesis,
    weighed: Weighed | None,
    names: Sequence[str] = (),
) -> tuple[Note, ...]:
    """All notes of what was `chosen`; sentences.py says them. `names` are those of the logs."""
    return (
        *_presliding(case, chosen),
        *_restless(case, chosen),
        *_moved(case, chosen),
        *_own_events(case, chosen, names),
        *_in_some_logs(case, chosen, names),
        *_twins(case, weighed),
        *_imitated(score_tests, chosen),
        *_unseen(case, score_tests, chosen),
        *_unfollowed(case),
    )


def _presliding(case: Case, chosen: FittedHypothesis) -> Iterator[Note]:
    """What is supposed of friction near rest: found in these logs, or stated in the plant file as known exactly."""
    for name, values in chosen.fit.hypothesis.effects.items():
        effect = case.library.effects[name]
        if not effect.names_a_gap and case.stated_sd[name] == dict.fromkeys(values, 0.0):
            size = effect.size
            told = {"story": effect.story, "symbol": size.symbol, "value": values[size.symbol], "unit": size.unit}
            yield Note("presliding_friction", effect.place, told)


def _restless(case: Case, chosen: FittedHypothesis) -> Iterator[Note]:
    """Noise with a memory, which every hypothesis has: no effect, but what no model foretells."""
    hypothesis, effects = chosen.fit.hypothesis, case.library.effects
    for name, values in hypothesis.effects.items():
        effect = effects[name]
        if effect.is_noise and name not in chosen.effects:
            size, time = effect.symbol(Role.STRENGTH), effect.symbol(Role.MEMORY)
            told = {"sd": values[size], "unit": effect.parameter[size].unit, "time_s": values[time]}
            yield Note("restless", effect.place, told)
    for output, noise in hypothesis.reading_noise.items():
        yield Note("coloured_readings", output, {"sd": noise.sd, "time_s": noise.time_s})


def _moved(case: Case, chosen: FittedHypothesis) -> Iterator[Note]:
    names = [str(symbol) for symbol in case.library.bound.model.parameter_symbols]
    theta = chosen.fit.hypothesis.theta
    p = coefficients(case, case.library.plain, chosen.fit.hypothesis.with_effects({}))  # what cannot be negative is not
    for index in moved_parameters(theta, decisions.BEYOND_CHANCE):
        place = int(case.free[index])
        stated = float(case.library.bound.p[place])
        told = {"deviations": float(theta[index]), "value": float(p[place]), "stated": stated}
        yield Note("moved_parameter", names[place], told)
    for entry in moved_effects(chosen.fit, decisions.BEYOND_CHANCE):
        symbol, stated = entry.parameter.symbol, entry.stated or 0.0
        sd = case.stated_sd[entry.effect][symbol]
        value = chosen.fit.hypothesis.effects[entry.effect][symbol]
        of_effect: dict[str, str | float] = {
            "symbol": symbol,
            "deviations": (value - stated) / sd,
            "value": value,
            "stated": stated,
        }
        yield Note("moved_effect", entry.effect, of_effect)


def _own_events(case: Case, chosen: FittedHypothesis, names: Sequence[str]) -> Iterator[Note]:
    """When and how large each log shows what happens at an instant of its own."""
    for name, own in chosen.fit.hypothesis.own.items():
        effect = case.library.effects[name]
        instant, size = effect.symbol(Role.INSTANT), effect.size
        logs = {
            _log(names, log): {"instant_s": values[instant], "size": values[size.symbol], "unit": size.unit}
            for log, values in own.items()
            if log != ELSEWHERE and values[size.symbol] != size.zero
        }
        yield Note("own_events", name, {"symbol": size.symbol, "logs": logs})


def _in_some_logs(case: Case, chosen: FittedHypothesis, names: Sequence[str]) -> Iterator[Note]:
    """Which logs show an effect and which deny it, where they differ."""
    for name, lack in chosen.fit.hypothesis.lacks.items():
        numbers = [flight.number for flight in case.flights]
        shown, denied = ([_log(names, n) for n in numbers if (n in lack.logs) is here] for here in (False, True))
        yield Note("in_some_logs", name, {"shown": shown, "denied": denied})


def _log(names: Sequence[str], number: int) -> str:
    return names[number] if number < len(names) else f"log {number + 1}"


def _twins(case: Case, weighed: Weighed | None) -> Iterator[Note]:
    if weighed is None or not weighed.fitted:
        return
    first = weighed.fitted[0]
    for other in alike(weighed, first):
        for name in other.effects:
            for own in first.effects:
                effects = case.library.effects
                reason = effects[own].twins.get(name) or effects[name].twins.get(own)
                if reason:
                    yield Note("twins", own, {"other": name, "reason": reason})


def _imitated(score_tests: Sequence[ScoreTest], chosen: FittedHypothesis) -> Iterator[Note]:
    imitated = [entry.effect for entry in score_tests if entry.absorbed > 1.0 - decisions.NEGLIGIBLE_SHARE**2]
    others = sorted(name for name in imitated if name not in chosen.effects)
    if others:
        kinds = {place: [place_and_kind(name)[1] for name in names] for place, names in _by_place(others).items()}
        yield Note("imitated", "plant", {"effects": kinds})


def _unseen(case: Case, score_tests: Sequence[ScoreTest], chosen: FittedHypothesis) -> Iterator[Note]:
    """How large effects could be without being seen: a note for each place, the largest in units of its reference size first."""
    unseen = hidden(case, score_tests)
    imitated = {entry.effect for entry in score_tests if entry.absorbed > 1.0 - decisions.NEGLIGIBLE_SHARE**2}
    if cannot_tell(case, score_tests):
        yield Note("hidden", "library", {"hidden": len(unseen), "effects": len(judged(case, score_tests))})
    said = {
        name: ratio
        for name, ratio in unseen.items()
        if name not in imitated and name not in chosen.fit.hypothesis.effects
    }
    for place, names in _by_place(sorted(said, key=lambda name: (-said[name], name))).items():
        yield Note("unseen", place, {place_and_kind(name)[1]: _up_to(case, name, said[name]) for name in names})


def _unfollowed(case: Case) -> Iterator[Note]:
    names = [name for name, effect in case.library.effects.items() if not (effect.repeats or effect.is_noise)]
    if names:
        yield Note("unfollowed", "library", {"effects": names})


def _up_to(case: Case, name: str, ratio: float) -> dict[str, str | float] | None:
    """The size below which an effect hides, `ratio` times its reference; None where that is beyond all that it can have."""
    size = case.library.effects[name].size
    away = ratio * size_scale(size)
    if away >= size.upper - size.lower:
        return None
    return {"symbol": size.symbol, "value": (size.zero or 0.0) + away, "unit": size.unit}


def _by_place(names: Sequence[str]) -> dict[str, list[str]]:
    """Names by their place, in the order in which each place first comes."""
    places: dict[str, list[str]] = {}
    for name in names:
        places.setdefault(place_and_kind(name)[0], []).append(name)
    return places
