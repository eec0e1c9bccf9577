"""Ways to ask the same question: logs of the same rig that say the same otherwise, and the same rig written otherwise."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from diagnosis.result import Material, Result
from records.diagnosis import Estimate
from records.log import RunLog
from records.text.units import dimension
from sim.bind import BoundPlant
from tests.diagnosis.otherwise import GRAMS, numbers_in_grams, read_turned, written

Logs = list[RunLog]
NOISE_STEPS = 1.0 / 3.0
WITHIN_95 = 1.96  # standard deviations


@dataclass(frozen=True)
class Asked:
    """A plant and logs of it, whose masses are in units of which a kilogram has so many."""

    bound: BoundPlant
    logs: Logs
    of_kilogram: float = 1.0


def rows(log: RunLog, chosen: slice) -> RunLog:
    """Some rows of a log, with the times that they had, as a log of its own."""
    step = chosen.step or 1
    return replace(
        log,
        t_s=log.t_s[chosen],
        u=log.u[chosen],
        y=log.y[chosen],
        extra={name: values[chosen] for name, values in log.extra.items()},
        seq=None,
        sample_period_s=step * log.sample_period_s,
    )


def in_two(asked: Asked) -> Asked:
    """The first log given as two."""
    first, *others = asked.logs
    half = len(first.t_s) // 2
    return replace(asked, logs=[rows(first, slice(0, half)), rows(first, slice(half, None)), *others])


def every(step: int) -> Callable[[Asked], Asked]:
    """All rows but every second or fourth left out."""
    return lambda asked: replace(asked, logs=[rows(log, slice(None, None, step)) for log in asked.logs])


def noisier(asked: Asked) -> Asked:
    """A third of a step of noise added to the readings, which are rounded anew."""
    rng, found = np.random.default_rng(4), []
    for log in asked.logs:
        step = np.array([asked.bound.plant.sensors[name] for name in log.columns.outputs])
        found.append(replace(log, y=step * np.round(log.y / step + NOISE_STEPS * rng.standard_normal(log.y.shape))))
    return replace(asked, logs=found)


def backwards(asked: Asked) -> Asked:
    """The logs in another order."""
    return replace(asked, logs=asked.logs[::-1])


def the_other_way(asked: Asked) -> Asked:
    """The first axis counted the other way round."""
    return Asked(written(asked.bound, "turned"), [read_turned(asked.bound, log) for log in asked.logs])


def with_masses_in_grams(asked: Asked) -> Asked:
    """Masses, forces and torques in a unit a thousand times smaller."""
    return replace(asked, bound=written(asked.bound, "in_grams", numbers_in_grams(asked.bound)), of_kilogram=GRAMS)


def with_less_asked(asked: Asked) -> Asked:
    """Of effects with nothing to say, those of the loop, nothing asked; of a plant that has one, all as before."""
    stated = any(name.startswith("loop.") for name in asked.bound.effects)
    return asked if stated else replace(asked, bound=written(asked.bound, "without_loop"))


LAWS: dict[str, Callable[[Asked], Asked]] = {
    "one log given as two": in_two,
    "every second row": every(2),
    "every fourth row": every(4),
    "another order": backwards,
    "noise of a third of a step": noisier,
    "an axis the other way round": the_other_way,
    "masses in grams": with_masses_in_grams,
    "the loop not asked": with_less_asked,
}


def of_logs(logs: Sequence[RunLog], holdout: Sequence[RunLog] = ()) -> Material:
    """What a diagnosis of all rows of these logs begins with."""
    names = [f"log {number}" for number in range(len(logs))]
    held = [f"held {number}" for number in range(len(holdout))]
    return Material(list(logs), list(holdout), held, [None] * (len(logs) + len(holdout)), names=names)


def differs(one: Result, other: Result, of_kilogram: float = 1.0) -> str:
    """How two answers to the same question differ; "" where they do not.

    The first names must be one, or hardly told apart by the first answer, equally probable to a tenth, and as large as far as is known:
    within 95 % of what the less sure answer says. Ways round, which turn with an axis, are not compared.
    """
    first, second = one.diagnosis, other.diagnosis
    if first.verdict != second.verdict:
        return f"verdict {first.verdict}, then {second.verdict}"
    if not first.effects or not second.effects:
        return "" if bool(first.effects) == bool(second.effects) else "names in one answer alone"
    before, after = first.effects[0], second.effects[0]
    if after.effect != before.effect:
        alike = after.effect in before.ambiguous_with
        return "" if alike else f"{before.effect}, then {after.effect}"
    if abs(before.probability - after.probability) > 0.1:
        return f"{before.effect} {before.probability:.2f}, then {after.probability:.2f}"
    apart = [name for name, size in before.parameters.items() if _apart(size, after.parameters[name], of_kilogram)]
    return " and ".join(f"{name} {before.parameters[name]}, then {after.parameters[name]}" for name in apart)


def _apart(one: Estimate, other: Estimate, of_kilogram: float) -> bool:
    unit = of_kilogram ** float(dimension(one.unit)[0])
    return abs(abs(one.value) * unit - abs(other.value)) > WITHIN_95 * max(one.sd * unit, other.sd)
