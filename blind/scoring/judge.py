"""One case judged: the truth against the answer."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from blind.cases.sealed import TrueEffect, Truth
from blind.effects.equivalent import Equivalent
from blind.rigs.bench import FILTERED
from blind.scoring.results import Answer, Names, RankedAnswer, Unreadable

NOBODY = RankedAnswer(frozenset(), 0.0, {}, {}, ())
WITHIN_95 = 1.96  # standard deviations, of a normal law
NEARLY = 0.1  # of a parameter's scale: so near, the figure's name says, a size is right


@dataclass(frozen=True)
class Judgement:
    """What was right; nothing, unless said otherwise.

    `rank`: place of the true cause among the ranked answers from 1, None where it is not among them;
    `wrong_names`: names found that neither the truth nor its look-alikes carry; `stated`: (top probability, whether the top answer is
    right) for an answer that claims a gap; `shrinkage` as in blind.scoring.shrinkage.
    """

    case: str
    truth: Truth
    shrinkage: float | None
    detected: bool
    failure: str | None = None
    place_right: bool = False
    side_right: bool = False
    rank: int | None = None
    found_right: bool = False
    set_hit: bool = False
    all_named: bool = False
    class_right: bool = False
    wrong_names: Names = frozenset()
    found: Names = frozenset()
    parameter_errors: tuple[float, ...] = ()
    within_interval: tuple[bool, ...] = ()
    left_out: bool = False
    stated: tuple[float, bool] | None = None
    time_s: float | None = None


def judge(case: str, truth: Truth, answer: Answer | Unreadable, shrinkage: float | None) -> Judgement:
    """The judgement of a case; an unreadable answer is wrong everywhere, a gap where there is none included."""
    if isinstance(answer, Unreadable):
        return Judgement(case, truth, shrinkage, detected=truth.kind == "nominal", failure=answer.reason)
    answer = _without_filter(answer, truth)
    true = frozenset(effect.name for effect in truth.effects)
    ranks = [place for place, entry in enumerate(answer.ranked, 1) if means(entry.names, truth)]
    top = answer.ranked[0] if answer.ranked else None
    return Judgement(
        case=case,
        truth=truth,
        shrinkage=shrinkage,
        detected=answer.verdict == "gap",
        place_right=_first_place(answer) in _right_places(truth),
        side_right=_side(_first_place(answer)) in {_side(place) for place in _right_places(truth)},
        rank=ranks[0] if ranks else None,
        found_right=means(answer.found, truth),
        set_hit=_set_hit(true, answer),
        all_named=true <= answer.found,
        class_right=_class_right(truth, answer),
        wrong_names=frozenset(name for name in answer.found if not any(_fits(name, e) for e in truth.effects)),
        found=answer.found,
        parameter_errors=_parameter_errors(truth, answer.ranked),
        within_interval=_within_interval(truth, top) if top and means(top.names, truth) else (),
        left_out=_is_left_out(truth, answer),
        stated=_stated_probability(truth, answer, top) if answer.verdict == "gap" else None,
        time_s=answer.time_s,
    )


def filter_names(answer: Answer, truth: Truth) -> Names:
    """Names of an answer that say that angles come late, or may as well, where a filter that is none of the effects makes them so: they are
    true too."""
    if not any(defect.startswith(FILTERED) for defect in truth.defects):
        return frozenset()
    late = frozenset(name for name in _said(answer) if _is_late(name)) | _perhaps_late(answer)
    return frozenset(name for name in late if not any(_fits(name, e) for e in truth.effects))


def _without_filter(answer: Answer, truth: Truth) -> Answer:
    """The answer without `filter_names`. Where nothing else is named, there is nothing else to be told."""
    beside = filter_names(answer, truth)
    if not beside:
        return answer
    ranked: dict[Names, RankedAnswer] = {}
    for entry in answer.ranked:
        names = entry.names - beside
        known = ranked.get(names)
        more = 0.0 if known is None else known.probability
        ranked[names] = replace(known or entry, names=names, probability=more + entry.probability)
    told = sum(entry.probability for names, entry in ranked.items() if names)
    nothing = bool(ranked) and max(told, answer.unknown_probability) < ranked.get(frozenset(), NOBODY).probability
    return replace(
        answer,
        verdict="no gap" if nothing else answer.verdict,
        ranked=tuple(sorted((e for e in ranked.values() if e.names), key=lambda entry: -entry.probability)),
        found=answer.found - beside,
    )


def _said(answer: Answer) -> Names:
    return frozenset().union(answer.found, *(entry.names for entry in answer.ranked))


def _perhaps_late(answer: Answer) -> Names:
    """What the answer itself cannot tell from a late reading."""
    alike = [
        (entry.names, other)
        for entry in answer.ranked
        for other in entry.ambiguous_with
        if len(entry.names) == len(other) == 1
    ]
    return frozenset().union(*(names for names, other in alike if all(map(_is_late, other))))


def _is_late(name: str) -> bool:
    place, _, what = name.partition(".")
    return place.endswith("_sensor") and what in ("delay", "lag")


def _fits(name: str, effect: TrueEffect) -> bool:
    """Whether a name says this effect: its own, a twin's, or for an effect outside the table one that a larger library may use."""
    if name == effect.name or name in effect.twins:
        return True
    place, _, what = name.partition(".")
    return not effect.known and place in effect.places and any(word in what for word in effect.keywords)


def means(names: Names, truth: Truth) -> bool:
    """Whether a set of names says exactly the true effects."""
    return (
        len(names) == len(truth.effects) > 0
        and all(any(_fits(name, effect) for name in names) for effect in truth.effects)
        and all(any(_fits(name, effect) for effect in truth.effects) for name in names)
    )


def touches(names: Names, truth: Truth) -> bool:
    """Whether some name of a set says a true effect."""
    return any(_fits(name, effect) for name in names for effect in truth.effects)


def _first_place(answer: Answer) -> str:
    return answer.places[0] if answer.places else answer.unknown_place


def _right_places(truth: Truth) -> set[str]:
    """Every place where one of the effects acts."""
    return {place for effect in truth.effects for place in effect.places}


def _side(place: str) -> str:
    """A rotor and its input as one: without rotor speeds the equations do not tell them apart."""
    return place.replace("_rotor", "").replace("_input", "")


def _set_hit(true: Names, answer: Answer) -> bool:
    """Whether what was found is the truth once each found name may stand for its stated look-alikes."""
    if not answer.found or len(answer.found) != len(true):
        return False
    group = set(answer.found)
    for entry in answer.ranked:
        if entry.names <= answer.found:
            group |= {name for names in entry.ambiguous_with for name in names}
            if true in entry.ambiguous_with and entry.names == answer.found:
                return True
    return true <= group


def _class_right(truth: Truth, answer: Answer) -> bool:
    """Whether the unknown's class names every signal on which the first effect depends (time apart)."""
    if not truth.effects:
        return False
    signals = _signals(truth.effects[0].depends)
    return bool(signals) and signals == _signals(answer.unknown_class)


def _signals(text: str) -> set[str]:
    inside = text.partition("(")[2].partition(")")[0]
    return {
        part.replace("sgn ", "").replace("_rad_s", "").replace("_rad", "").strip() for part in inside.split(",")
    } - {""}


def _parameter_errors(truth: Truth, ranked: Sequence[RankedAnswer]) -> tuple[float, ...]:
    """Relative errors of a single effect's main parameters, from the entry that names it, whatever its rank."""
    named = [entry for entry in ranked if means(entry.names, truth)]
    if len(truth.effects) != 1 or not named:
        return ()
    return tuple(_off(named[0], key, true) / true.scale for key, true in _main(truth, named[0]) if true.scale > 0.0)


def _within_interval(truth: Truth, top: RankedAnswer) -> tuple[bool, ...]:
    """Whether each main parameter of effects that are all named lies within the interval of 95 % that is stated of it."""
    known = [(key, true) for key, true in _main(truth, top) if key in top.deviations]
    return tuple(_off(top, key, true) < WITHIN_95 * top.deviations[key] for key, true in known)


def _is_left_out(truth: Truth, answer: Answer) -> bool:
    """Whether the right effects were found, each main parameter to NEARLY, and yet not named."""

    def right(entry: RankedAnswer) -> bool:
        main = list(_main(truth, entry))
        return bool(main) and all(_off(entry, key, true) <= NEARLY * true.scale for key, true in main)

    found = any(means(entry.names, truth) and right(entry) for entry in answer.ranked)
    return found and not means(answer.found, truth)


def _main(truth: Truth, entry: RankedAnswer) -> Iterator[tuple[str, Equivalent]]:
    """The true main parameters that an answer by the right names has, each with its key there."""
    for effect in truth.effects:
        for symbol, true in effect.parameters.items():
            key = symbol if len(truth.effects) == 1 else f"{effect.name}.{symbol}"
            if true.main and key in entry.parameters:
                yield key, true


def _off(entry: RankedAnswer, key: str, true: Equivalent) -> float:
    """How far an estimate is from the truth, whose sign may not be told."""
    estimate = entry.parameters[key]
    return abs(abs(estimate) - abs(true.value) if true.either_sign else estimate - true.value)


def _stated_probability(truth: Truth, answer: Answer, top: RankedAnswer | None) -> tuple[float, bool]:
    """Top probability and whether that answer is right; "unknown" is right for an effect that the table does not hold."""
    if top is None or answer.unknown_probability > top.probability:
        return answer.unknown_probability, truth.kind == "outside"
    return top.probability, means(top.names, truth)
