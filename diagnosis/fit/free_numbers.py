"""The numbers of effects that a fit may move, and the units in which it counts them."""

from collections.abc import Iterator
from dataclasses import dataclass

from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import ELSEWHERE, Hypothesis
from sim.effect import EffectParameter, Role, Values

OUT_OF_REACH = 1e3  # references
WITHOUT_SLOPE = (Role.JITTER, Role.BEGINNING, Role.HOLD, Role.SHIFT)  # found otherwise, or known


@dataclass(frozen=True)
class Free:
    """One free number of an effect: its effect, its parameter, and the unit in which the fit counts it.

    `stated` is its value in the plant file, known to one `scale`; None where the file does not state the effect. `log` is the number of
    the log whose own it is, None where it is that of all.
    """

    effect: str
    parameter: EffectParameter
    scale: float
    stated: float | None = None
    log: int | None = None

    def of(self, hypothesis: Hypothesis) -> float:
        """Its value in a hypothesis."""
        return hypothesis.value(self.effect, self.parameter.symbol, self.log)


def free_numbers(case: Case, hypothesis: Hypothesis, shapes: bool = True) -> tuple[Free, ...]:
    """The numbers of the supposed effects that a fit may move: those of which its slopes tell."""
    found = []
    for name, log, values in _instances(case, hypothesis):
        effect = case.library.effects[name]
        for parameter in effect.parameters:
            if effect.shown_in_readings or effect.is_noise or parameter.role in WITHOUT_SLOPE:
                continue
            if name in case.stated:
                stated, sd = (given[name][parameter.symbol] for given in (case.stated, case.stated_sd))
                found += [Free(name, parameter, sd, stated)] if sd > 0.0 else []
            elif from_zero(parameter):
                found.append(Free(name, parameter, size_scale(parameter), log=log))
            elif shapes:
                scale = 0.2 * max(abs(values[parameter.symbol]), shape_unit(parameter))
                found.append(Free(name, parameter, scale, log=log))
    return tuple(found)


def _instances(case: Case, hypothesis: Hypothesis) -> Iterator[tuple[str, int | None, Values]]:
    """Each effect with its values, and those that are another in each log once for each log in which they happen."""
    for name, values in hypothesis.effects.items():
        if name not in hypothesis.own:
            yield name, None, values
            continue
        size = case.library.effects[name].size
        for log, own in hypothesis.own[name].items():
            if log != ELSEWHERE and own[size.symbol] != size.zero:
                yield name, log, own


def from_zero(parameter: EffectParameter) -> bool:
    """Whether a number counts from where its effect vanishes: a size does, but for a limit that only vanishes out of all reach."""
    out_of_reach = parameter.reference != 0.0 and abs(parameter.zero or 0.0) > OUT_OF_REACH * abs(parameter.reference)
    return parameter.is_size and not out_of_reach


def size_scale(parameter: EffectParameter) -> float:
    """The unit of a size: how far its reference is from nothing."""
    zero = parameter.zero or 0.0
    return abs(parameter.reference - zero) or 0.05 * (parameter.upper - parameter.lower)


def shape_unit(parameter: EffectParameter) -> float:
    """The unit of a shape that may be 0."""
    return abs(parameter.reference) if parameter.reference else 0.1 * min(parameter.upper - parameter.lower, 10.0)
