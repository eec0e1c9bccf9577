"""Effects that no slope tells of, on the way of the signals and limits: tried at each of their starts at full size."""

from collections.abc import Sequence
from itertools import chain

import numpy as np

from diagnosis import decisions
from diagnosis.detect.by_log import part_of_finite
from diagnosis.detect.input_steps import Kind, likely_steps
from diagnosis.detect.input_tries import promises
from diagnosis.detect.linearisation import Linearisation
from diagnosis.detect.starts import ScoreTest, each_best, shape_starts
from diagnosis.fit.likelihood import likelihood, stacked
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import passes
from diagnosis.library.coarse_grid import coarse_step
from jobs.thread_map import thread_map
from sim.effect import Effect, Role, Values

# Where the search of a limit begins: the level below which the command stays for these shares of the time, as a peak may be a kick of a
# moment, and beyond its peak by these factors, where only a rounded corner is reached.
LEVEL_SHARES, PEAK_SHARES = (0.5, 0.75, 0.9, 0.97, 0.99, 0.995, 0.998, 0.9995), (1.05, 1.2)


def tried(case: Case, linearisation: Linearisation, names: Sequence[str]) -> list[ScoreTest]:
    """Score tests of the effects of these names, of each from the best of its starts. Steps keep several, as each has a hill of its own."""
    effects = [case.library.effects[name] for name in names]
    begun = thread_map(lambda effect: _ways(case, linearisation, effect), effects)
    ways = [(effect, way) for effect, own in zip(effects, begun, strict=True) for way in own]
    found, left = _first_told(linearisation, ways)
    found += chain.from_iterable(thread_map(lambda way: along(case, linearisation, *way), left))
    steps = {effect.name for effect in effects if effect.size.role is Role.STEP}
    return [entry for entry in found if entry.effect not in steps] + each_best(
        entry for entry in found if entry.effect in steps
    )


def _first_told(
    linearisation: Linearisation, ways: Sequence[tuple[Effect, list[Values]]]
) -> tuple[list[ScoreTest], list[tuple[Effect, list[Values]]]]:
    """Tries on the ways of inputs that are not worth a pass, as first order tells them, and what is left to try."""
    each = [(effect, values) for effect, way in ways for values in way]
    told, found, left = iter(promises(linearisation, each)), list[ScoreTest](), list[tuple[Effect, list[Values]]]()
    for effect, way in ways:
        kept = list[Values]()
        for values in way:
            promise = next(told)
            if promise is None or promise.is_worth:
                kept.append(values)
            elif promise.power > 0.0:
                z = float(np.sqrt(2.0 * max(promise.gain, 0.0)))
                found.append(ScoreTest(effect.name, values, z, promise.gain, promise.absorbed, promise.power))
        left += [(effect, kept)] if kept else []
    return found, left


def along(case: Case, linearisation: Linearisation, effect: Effect, way: Sequence[Values]) -> list[ScoreTest]:
    """The tries from the mildest on, down to one that loses: to first order the log likelihood is concave in a size, and beyond that all
    lose more. Play and limits have no first order: what is as small as noise, or cuts noise alone, loses where what holds back a
    manoeuvre gains."""
    found = list[ScoreTest]()
    for values in way:
        entry = _tried(case, linearisation, effect, values)
        if entry is None:
            continue
        found.append(entry)
        if effect.smooth and entry.gain < -decisions.chance_nats():
            break
    return found


def _ways(case: Case, linearisation: Linearisation, effect: Effect) -> list[list[Values]]:
    """Values to try of an effect without first order, for each of its shapes those of its size, mildest first; one by one where its
    likelihood is rough. Sizes of a level, and steps with what they are like, are seen in the log."""
    if effect.size.role is Role.STEP:
        return [[values] for values in _steps(case, linearisation, effect)]
    levels = _levels(case, effect) if effect.size.role is Role.LEVEL else list(effect.size.starts)
    levels = sorted(levels or [effect.size.reference], key=lambda value: abs(value - (effect.size.zero or 0.0)))
    ways: list[list[Values]] = [
        [{**effect.absent, **shapes, effect.size.symbol: value} for value in levels] for shapes in shape_starts(effect)
    ]
    return [[values] for way in ways for values in way] if effect.holds_at_rest else ways


def _levels(case: Case, effect: Effect) -> list[float]:
    """What an input's command stays below for shares of the time, and a little more than its largest."""
    model = case.library.bound.model
    column = model.inputs.index(model.places.inputs[effect.place].variable)
    sent = np.abs(np.concatenate([flight.filter_input.u[:, column] for flight in case.flights]))
    levels = [*np.quantile(sent, LEVEL_SHARES), *np.multiply(PEAK_SHARES, np.max(sent))]
    return [float(level) for level in dict.fromkeys(levels) if level > 0.0]


def _steps(case: Case, linearisation: Linearisation, effect: Effect) -> list[Values]:
    """The steps of a sensor, read off its readings, or those of an input, seen in the motion."""
    library = case.library
    sensor = library.bound.model.places.sensors.get(effect.place)
    if sensor is None:
        return _input_steps(linearisation, effect)
    place = library.outputs.index(sensor.output)
    read = np.concatenate([flight.filter_input.read[:, place] for flight in case.flights])
    step = coarse_step(read, library.bound.plant.sensors[sensor.output])
    return [] if step is None else [{effect.size.symbol: step}]


def _input_steps(linearisation: Linearisation, effect: Effect) -> list[Values]:
    """The likeliest steps of an input, each with how it is held and where it lies."""
    hold, shift = effect.symbol(Role.HOLD), effect.symbol(Role.SHIFT)
    kinds = [Kind(shapes[hold], shapes[shift]) for shapes in shape_starts(effect)]
    return [
        {effect.size.symbol: step, hold: kind.hold, shift: kind.shift}
        for step, kind in likely_steps(linearisation, effect.place, kinds)
    ]


def _tried(case: Case, linearisation: Linearisation, effect: Effect, values: Values) -> ScoreTest | None:
    """An effect at full size: its gain of the log likelihood, with what the fitted numbers would then add to first order."""
    hypothesis = linearisation.fit.hypothesis
    runs = passes(case, hypothesis.with_effects({**hypothesis.effects, effect.name: values}))
    if runs is None:
        return None
    change = stacked(runs) - linearisation.w
    size = float(change @ change)
    if size < 1e-6:
        return None
    further, absorbed = linearisation.further(change)
    gain = likelihood(runs) - linearisation.fit.log_likelihood + further
    power = float(np.sqrt(max(size * (1.0 - absorbed), 0.0)))
    part = None if effect.is_event else part_of_finite(case, linearisation.runs, runs, gain)
    gain, denied = (gain, frozenset[int]()) if part is None else (part.gain, part.denied)
    return ScoreTest(effect.name, values, float(np.sqrt(2.0 * max(gain, 0.0))), gain, absorbed, power, denied)
