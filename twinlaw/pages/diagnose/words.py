"""The words of a diagnosis: names, numbers and probabilities as a person who knows only the rig reads them."""

import math
from collections.abc import Mapping, Sequence
from functools import cache

from diagnosis import decisions
from diagnosis.explain.sentences import plain_sentence
from records.diagnosis import Diagnosis, RankedHypothesis, names_of
from records.quality import MISFIT
from records.reasons import DOUBTS, Note
from records.text.functional_class import Dependence, parse_class
from records.text.uncertain import with_sd
from records.text.units import plain_unit, stem, unit_of
from sim.added_effects import every_effect
from sim.effect import Effect

# By the unit at the end of a name: how a person reads it, where not in that unit.
_SHOWN = {
    "_rad": ("deg", 180.0 / math.pi),
    "_rad_s": ("deg/s", 180.0 / math.pi),
    "_m": ("mm", 1e3),
    "_m_s": ("mm/s", 1e3),
}
# By the word before the brackets of a class: what of the rig changes.
_CLASSES = {
    "torque": "a torque or force",
    "thrust": "a thrust",
    "gain": "a factor",
    "output": "an error of the reading",
    "mode": "a vibration",
    "limit": "a limit",
    "inertia": "an inertia",
    "rate": "a rate of change",
}
SUM_OF = "sum of "  # before the speed of a way that an error grows with
_SIGNALS = {"1": "nothing (it is constant)", "t": "the time"}
LISTED = 3  # names in one cell
USUAL = 0.5  # chance from which a gap is no larger than usual
LEAST_CHANCE = 1e-6  # smaller ones are said to be below it: no model of noise is good for more


def plain_text(value: object) -> str:
    """What a record holds under a key, in one line."""
    if isinstance(value, Mapping):
        return "; ".join(f"{name}: {plain_text(entry)}" for name, entry in value.items())
    if isinstance(value, list | tuple):
        return ", ".join(plain_text(entry) for entry in value)
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def words(name: str) -> str:
    """ "azimuth.cable_spring" as "cable spring of the azimuth", several with "and"."""
    parts = [part.replace("_", " ").partition(".") for part in names_of(name)]
    parts = [(place, dot, _said().get(effect, effect)) for place, dot, effect in parts]
    return " and ".join(f"{effect} of the {place}" if effect else f"the {place}" for place, _, effect in parts)


@cache
def _said() -> Mapping[str, str]:
    """Kinds of effects whose words are more than the name without underscores."""
    return {effect.kind: effect.said for effect in every_effect() if effect.said}


def listed(names: Sequence[str]) -> str:
    """The first few of the names, and how many more."""
    more = f" and {len(names) - LISTED} more" if len(names) > LISTED else ""
    return "; ".join(names[:LISTED]) + more


def chance(p: float) -> str:
    """A probability that may be very small."""
    return f"{p:.2g}" if p >= LEAST_CHANCE else f"below {LEAST_CHANCE:g}"


def percent(share: float) -> str:
    """A share, certain ones as close to it as one may say."""
    if 0.9995 < share < 1.0:
        return "> 99.9 %"
    return f"{100 * share:.1f} %" if share >= 0.001 or share == 0.0 else "< 0.1 %"


def shown(name: str) -> tuple[str, str, float]:
    """Name without its unit, the unit a person reads, and the factor to it."""
    for suffix, (unit, scale) in _SHOWN.items():
        if name.endswith(suffix):
            return name.removesuffix(suffix), f"[{unit}]", scale
    unit = unit_of(name)
    return stem(name), f"[{unit}]" if unit else "", 1.0


def plain_notes(notes: Sequence[Note]) -> list[str]:
    """Each note once, in words that need no statistics, but those that stand before the verdict."""
    return list(dict.fromkeys(plain_sentence(note) for note in notes if note.kind not in DOUBTS))


def doubts_in_words(notes: Sequence[Note]) -> str:
    """What is to be read before the verdict: columns that may be others than they are called."""
    return "; ".join(plain_sentence(note) for note in notes if note.kind in DOUBTS)


def class_in_words(text: str) -> str:
    """ "torque(psi, sgn psi_dot) on elevation" with what `dependence_in_words` says behind it."""
    told = dependence_in_words(text)
    return f"{text}: {told}" if told else text


def dependence_in_words(text: str) -> str:
    """ "a torque or force that depends on psi and the direction in which psi moves"; empty for a class of no kind."""
    known = parse_class(text)
    if known.kind not in _CLASSES:
        return ""
    return f"{_CLASSES[known.kind]} that depends on {' and '.join(_signal(entry) for entry in known.depends)}"


def _signal(depends: Dependence) -> str:
    name = of = depends.signal
    if depends.by_sign:
        return f"the direction in which {of.removesuffix('_dot')} moves" if of.endswith("_dot") else f"the sign of {of}"
    if name.startswith(SUM_OF):
        return f"how far {name.removeprefix(SUM_OF).removesuffix('_dot')} moved at each speed"
    if name.startswith("d") and name.endswith("/dt"):
        return f"how fast {name.removeprefix('d').removesuffix('/dt')} changes"
    if name.endswith("_dot"):
        return f"how fast {name.removesuffix('_dot')} changes"
    return _SIGNALS.get(name, name)


def sized(
    hypothesis: RankedHypothesis, effects: Mapping[str, Effect], equals: str = " = "
) -> list[tuple[str, str, str]]:
    """Each effect of a hypothesis once: its name, its class, and its parameters; `effects` are the plant's library by name."""
    names, classes = hypothesis.names, names_of(hypothesis.class_)
    classes += ("",) * (len(names) - len(classes))
    joint = len(names) > 1
    lines = []
    for name, class_ in zip(names, classes, strict=False):
        own = {
            symbol.removeprefix(f"{name}.") if joint else symbol: entry
            for symbol, entry in hypothesis.parameters.items()
            if not joint or symbol.startswith(f"{name}.")
        }
        sizes = [
            f"{symbol} not told by these data"  # it might as well be any between its bounds
            if entry.sd > _width(effects, name, symbol)
            else f"{symbol}{equals}{with_sd(entry.value, entry.sd)} {plain_unit(entry.unit)}".strip()
            for symbol, entry in own.items()
        ]
        lines.append((name, class_, ", ".join(sizes)))
    return lines


def _width(effects: Mapping[str, Effect], name: str, symbol: str) -> float:
    """How far apart the bounds of an effect's parameter are; without end where the library has none."""
    parameter = effects[name].parameter.get(symbol) if name in effects else None
    return math.inf if parameter is None else parameter.upper - parameter.lower


def misfits(diagnosis: Diagnosis) -> dict[str, float]:
    """By output, the error of predictions over a window of the logs held out, over what the output's sensor leaves."""
    shrinkage = diagnosis.shrinkage
    if shrinkage is None:
        return {}
    floors = shrinkage.rms_floor
    return {name: rms / floors[name] for name, rms in shrinkage.rms_after.items() if floors[name]}


def window(diagnosis: Diagnosis) -> str:
    """How long a prediction runs, in words: a second, but on a plant that moves slower."""
    window_s = 1.0 if diagnosis.shrinkage is None else diagnosis.shrinkage.window_s
    return "a second" if window_s == 1.0 else f"{window_s:g} s"


def missed_most(diagnosis: Diagnosis) -> str | None:
    """The output that is missed most on the logs held out, with its misfit; None where all misfits are green."""
    worst, misfit = max(misfits(diagnosis).items(), key=lambda entry: entry[1], default=("", 0.0))
    if misfit <= MISFIT.green:
        return None
    return f"{worst} by {misfit:.3g} times what its sensor leaves"


def alarm_in_words(diagnosis: Diagnosis, p: float) -> str:
    """What the chance of a false alarm says."""
    missed = missed_most(diagnosis)
    if diagnosis.verdict != "gap" and p > decisions.ALARM:
        usual = (
            "what remains is as small as on a rig that is as the plant file states, with its sensors"
            if missed is None
            else f"no more shows than chance gives, yet predictions over {window(diagnosis)} of the logs held out miss {missed}"
        )
        return usual if p >= USUAL else f"{usual}: {percent(p)} of rigs as the plant file states show as much"
    seldom = (
        f"a rig that is as the plant file states, with its sensors, shows so large a gap with probability {chance(p)}"
    )
    if diagnosis.verdict != "no gap":
        return seldom
    if missed is None:
        return f"something is there, too small to count, although {seldom}"
    return f"something is there that nothing known here brings closer: predictions over {window(diagnosis)} miss {missed}, and {seldom}"
