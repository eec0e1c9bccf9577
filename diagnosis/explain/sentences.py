"""The sentences of a diagnosis' notes: each kind of note is said here, and nowhere else."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from records.reasons import Note
from records.text.units import plain_unit, unit_of


def sentences(notes: Sequence[Note]) -> tuple[str, ...]:
    """What diagnosis.json says of each note."""
    return tuple(map(sentence, notes))


def sentence(note: Note) -> str:
    """One note as a sentence; raises KeyError for a kind that has none and that nobody said."""
    return _SENTENCES[note.kind](note) if note.said is None else note.said


def plain_sentence(note: Note) -> str:
    """The same in words that need no statistics, for a person."""
    return _PLAIN.get(note.kind, sentence)(note)


def _presliding_friction(note: Note) -> str:
    told = note.numbers
    how = told["story"][0].lower() + told["story"][1:-1]
    return f"{note.subject}, no gap: {how} ({_size(told, 2)})"


def _moved_parameter(note: Note) -> str:
    return f"parameter {note.subject} is {_from_stated(note.numbers)}"


def _moved_effect(note: Note) -> str:
    return f"{note.numbers['symbol']} of {note.subject} is {_from_stated(note.numbers)}"


def _from_stated(told: Mapping[str, Any]) -> str:
    return (
        f"{told['deviations']:+.1f} standard deviations from its stated value: "
        f"{told['value']:.4g} instead of {told['stated']:.4g}"
    )


def _twins(note: Note) -> str:
    return f"{note.subject} and {note.numbers['other']}: {note.numbers['reason']}"


def _imitated(note: Note) -> str:
    kinds = [f"{place} {', '.join(names)}" for place, names in note.numbers["effects"].items()]
    return f"a re-tune of the plant's own parameters imitates these, so these data cannot tell them: {'; '.join(kinds)}"


def _hidden(note: Note) -> str:
    hidden, effects = note.numbers["hidden"], note.numbers["effects"]
    return f"{hidden} of {effects} effects of the library would go unseen in these logs at the size that they may well have"


def _unseen(note: Note) -> str:
    return f"too little excitation to see at the {note.subject}: {unseen_effects(note)}"


def unseen_effects(note: Note, named: Callable[[str], str] = str) -> str:
    """What an "unseen" note says of its place: the effects that would not show at any size, then those below a size; as `named`."""
    sizes = {named(kind): size for kind, size in note.numbers.items()}
    never = ", ".join(kind for kind, size in sizes.items() if size is None)
    parts = [f"{never} of any size"] if never else []
    parts += [f"{kind} below {_size(size)}" for kind, size in sizes.items() if size is not None]
    return "; ".join(parts)


def _size(size: Mapping[str, Any], digits: int = 3) -> str:
    return f"{size['symbol']} = {size['value']:.{digits}g} {plain_unit(size['unit'])}".rstrip()


def _unfollowed(note: Note) -> str:
    return f"not looked for, as no filter knows where a rotor stands in its turn: {', '.join(note.numbers['effects'])}"


def _contradiction(note: Note) -> str:
    return _contradicting(note, f"{note.numbers['gain_nats']:.0f} nats likelier")


def _contradiction_in_odds(note: Note) -> str:
    return _contradicting(note, f"e^{note.numbers['gain_nats']:.0f} times likelier")


def _contradicting(note: Note, likelier: str) -> str:
    moved = ", ".join(f"{what} {by:+.1f}" for what, by in note.numbers["moved"].items())
    return (
        f"these logs contradict each other: {note.subject} would be {likelier} with numbers of its own ({moved}, in units "
        "of their spread), so one plant in one state did not make them all; diagnose them apart"
    )


def _knows_nothing(note: Note) -> str:
    told = ", ".join(f"{name} {value:.2g}" for name, value in note.numbers.items())
    return (
        "this plant does not fit these logs at all: whatever is added to it, its predictions are no better than holding "
        f"the last reading (error over that of holding: {told}); check that they belong together, columns, signs and units"
    )


def _predicts_worse(note: Note) -> str:
    times = float(np.exp(note.numbers["worse_nats"]))
    return f"with {note.subject} the hold-out is predicted {times:.2f} times as far off as without, so the model stays without it"


def _unsure(note: Note) -> str:
    return (
        f"{note.subject} is less likely ({note.numbers['probability']:.2f}) than all else together, and the hold-out is hardly predicted "
        f"better with it ({note.numbers['gain_nats']:.3f} nats a reading), so the model stays without it"
    )


def _may_be_missing(note: Note) -> str:
    return f"perhaps the plant file lacks {note.subject} ({note.numbers['probability']:.2f}); these logs do not show surely that it matters"


def _another_plant(note: Note) -> str:
    return (
        f"these may be logs of another plant: beside every effect a parameter stays {note.numbers['deviations']:.0f} standard "
        "deviations from what the plant file states"
    )


def _something_else_missing(note: Note) -> str:
    better, left = float(np.exp(note.numbers["gain_nats"])), float(np.exp(note.numbers["left_nats"]))
    makes = "other parameters make" if note.subject == "parameters" else f"{note.subject} makes"
    return (
        f"{makes} predictions of the hold-out {better:.2g} times as good, yet they stay {left:.2g} times as far off as "
        "the sensors and the noise would leave them: something else is missing"
    )


def _own_events(note: Note) -> str:
    symbol = note.numbers["symbol"]
    told = (
        f"{log} at {own['instant_s']:.4g} s with {symbol} = {own['size']:.3g} {plain_unit(own['unit'])}".rstrip()
        for log, own in note.numbers["logs"].items()
    )
    return f"{note.subject} happens at another instant in each log: {'; '.join(told)}"


def _in_some_logs(note: Note) -> str:
    shown, denied = (" and ".join(note.numbers[key]) for key in ("shown", "denied"))
    return f"{note.subject} acts in {shown} and not in {denied}, as of a rig that was changed between them"


def _stated_predicts_better(note: Note) -> str:
    further = 100.0 * note.numbers["worse"]
    return (
        f"re-tuned within its spread the plant predicts the hold-out {further:.2g} % worse than as stated, "
        "so its parameters stay as stated"
    )


def _restless(note: Note) -> str:
    sd, unit, time_s = (note.numbers[name] for name in ("sd", "unit", "time_s"))
    what = "force" if unit == "N" else "torque"
    return f"noise of {note.subject}: a {what} of {sd:.3g} {unit} (one sd) comes and goes within {time_s:.2g} s; none foretells it"


def _coloured_readings(note: Note) -> str:
    return (
        f"noise of {note.subject}: its readings are off by {note.numbers['sd']:.3g} {unit_of(note.subject) or '1'} (one sd) alike over "
        f"{note.numbers['time_s']:.2g} s, as behind a filter or an observer"
    )


_SENTENCES: Mapping[str, Callable[[Note], str]] = {
    "presliding_friction": _presliding_friction,
    "restless": _restless,
    "coloured_readings": _coloured_readings,
    "moved_parameter": _moved_parameter,
    "moved_effect": _moved_effect,
    "may_be_missing": _may_be_missing,
    "twins": _twins,
    "imitated": _imitated,
    "hidden": _hidden,
    "unseen": _unseen,
    "unfollowed": _unfollowed,
    "contradiction": _contradiction,
    "knows_nothing": _knows_nothing,
    "predicts_worse": _predicts_worse,
    "unsure": _unsure,
    "own_events": _own_events,
    "in_some_logs": _in_some_logs,
    "another_plant": _another_plant,
    "something_else_missing": _something_else_missing,
    "stated_predicts_better": _stated_predicts_better,
}
_PLAIN: Mapping[str, Callable[[Note], str]] = {"contradiction": _contradiction_in_odds}
