"""Score tests of all effects: how much of what is left a signature explains once the plant's own coefficients have had their share."""

from collections.abc import Iterable, Mapping, Sequence, Set
from dataclasses import dataclass, replace
from itertools import chain, product

import numpy as np
from numpy.typing import NDArray

from diagnosis import decisions
from diagnosis.detect.by_log import Part, part_of_finite, parts
from diagnosis.detect.input_steps import Kind, likely_steps
from diagnosis.detect.input_tries import promises
from diagnosis.detect.instants import instants
from diagnosis.detect.linearisation import Linearisation, Scores
from diagnosis.detect.waves import wave_starts
from diagnosis.filter.kalman import Pass
from diagnosis.fit.gauss_newton import flat_slopes, likelihood, size_scale, stacked
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import passes
from diagnosis.library.coarse_grid import coarse_step
from diagnosis.library.effect_library import EffectLibrary
from jobs.thread_map import thread_map
from sim.effect import Effect, EffectParameter, Role, Values

Array = NDArray[np.float64]
# Where the search of a limit begins: the level below which the command stays for these shares of the time, as a peak may be a kick of a
# moment, and beyond its peak by these factors, where only a rounded corner is reached.
LEVEL_SHARES, PEAK_SHARES = (0.5, 0.75, 0.9, 0.97, 0.99, 0.995, 0.998, 0.9995), (1.05, 1.2)
SMALL_SIZE = 0.05
MOST_STARTS = 8  # of an effect's shapes that are scored: time
FARTHEST_SIZE = 30.0  # references: no larger size is proposed


@dataclass(frozen=True)
class Start:
    """Values from where a fit may begin, and the logs, by number, that deny the effect."""

    values: Values
    denied: frozenset[int] = frozenset()


@dataclass(frozen=True, eq=False)
class ScoreTest:
    """An effect with values to start a fit from: `z` its efficient score in standard deviations, `gain` of the log likelihood to first
    order, `absorbed` the share of its signature that the plant's coefficients imitate, `power` the score that its reference size
    would have. `denied` are the numbers of logs that show nothing of it where others do, `others` further starts that promise nearly
    as much, from which a fit may end on another hill."""

    effect: str
    values: Values
    z: float
    gain: float
    absorbed: float
    power: float
    denied: frozenset[int] = frozenset()
    others: tuple[Start, ...] = ()

    @property
    def starts(self) -> tuple[Start, ...]:
        """All from where its fit may begin, the most promising first."""
        return (Start(self.values, self.denied), *self.others)


def score_effects(
    case: Case, linearisation: Linearisation, names: Sequence[str], worth: Set[str] | None = None
) -> list[ScoreTest]:
    """Score tests of all `names` that the hypothesis does not hold already: one for each effect, from the best of its starts.

    Effects on the way of the signals cost a pass for each start, events a grid of instants, sines one of waves; `worth` restricts
    these, but for limits, which often show only beside another effect.
    """
    hypothesis = linearisation.fit.hypothesis
    wanted = [name for name in names if name not in hypothesis.effects]
    library = case.library
    costly = [name for name in wanted if worth is None or name in worth or library.effects[name].having(Role.LEVEL)]
    stateless = [n for n in wanted if n in library.names and (n in costly or not _is_sought(library.effects[n]))]
    others = [name for name in wanted if name in library.wide_names]
    finite = [name for name in costly if not library.effects[name].on_equations or library.effects[name].is_limit]
    kinds, chosen = (
        (_finite, _smooth, _smooth, _first_order),
        (finite + holding(library, wanted), others, stateless, costly),
    )
    found = thread_map(lambda kind, names: kind(case, linearisation, names), kinds, chosen)
    best: dict[str, ScoreTest] = {}
    for entry in chain.from_iterable(found):
        if entry.effect not in best or entry.gain > best[entry.effect].gain:
            best[entry.effect] = entry
    return sorted(best.values(), key=lambda entry: -entry.gain)


def shape_starts(effect: Effect) -> list[dict[str, float]]:
    """Values of an effect's shapes to start from, its sizes left out."""
    shapes = [parameter for parameter in effect.parameters if not parameter.is_size]
    choices = [p.starts or (p.reference,) for p in shapes]
    return [dict(zip((p.symbol for p in shapes), chosen, strict=True)) for chosen in product(*choices)][:MOST_STARTS]


def _starts(linearisation: Linearisation, effect: Effect) -> list[dict[str, float]]:
    """Values of an effect's shapes to start from; those of a sine are sought, and where none is likely there are none."""
    if effect.swings:
        return wave_starts(linearisation, effect)
    return instants(linearisation, effect) or shape_starts(effect)


def _smooth(case: Case, linearisation: Linearisation, names: Sequence[str]) -> list[ScoreTest]:
    """Effects in the library's equations whose first order counts: all in one pass for each of their starts."""
    library, hypothesis = case.library, linearisation.fit.hypothesis
    starts: dict[str, list[dict[str, float]]] = {}
    for name in names:
        effect = library.effects[name]
        if not effect.is_limit:
            starts[name] = _starts(linearisation, effect)
    found = []
    for turn in range(max((len(values) for values in starts.values()), default=0)):
        now = {name: values[turn] for name, values in starts.items() if turn < len(values)}
        touched = {name: {**_touched(library.effects[name]), **shapes} for name, shapes in now.items()}
        compiled = library.compiled((*hypothesis.effects, *now))
        places = [compiled.place(name, library.effects[name].size.symbol) for name in now]
        runs = passes(case, hypothesis.with_effects({**touched, **hypothesis.effects}), places, slopes=True)
        if runs is not None:
            found += _judged(case, linearisation, touched, runs)
    return _each_best(found)


def _each_best(found: Iterable[ScoreTest]) -> list[ScoreTest]:
    """Of each effect the best, with further starts."""
    by_effect: dict[str, list[ScoreTest]] = {}
    for entry in found:
        by_effect.setdefault(entry.effect, []).append(entry)
    return [_best(entries) for entries in by_effect.values()]


def _best(found: Iterable[ScoreTest]) -> ScoreTest:
    """The best of one effect's, with the others that promise enough: by first order nobody knows which shape's hill is the highest."""
    best, *others = sorted(found, key=lambda entry: -entry.gain)
    least = max(decisions.PROMISED_SHARE * best.gain, float(decisions.TAKEN_IN))
    return replace(
        best, others=tuple(Start(o.values, o.denied) for o in others[: decisions.NEXT - 1] if o.gain > least)
    )


def _is_sought(effect: Effect) -> bool:
    """Effects whose starts are sought in the logs."""
    return effect.is_event or effect.swings


def _touched(effect: Effect) -> dict[str, float]:
    return {parameter.symbol: parameter.touched for parameter in effect.parameters}


def holding(library: EffectLibrary, names: Sequence[str]) -> list[str]:
    """Dry friction of an axis that has none as stated: of how it holds the axis where it rests first order knows nothing."""
    return [
        name
        for name in names
        if library.effects[name].holds_at_rest and library.effects[name].place in library.frictionless
    ]


def _judged(
    case: Case, linearisation: Linearisation, values: Mapping[str, Values], runs: Sequence[Pass]
) -> list[ScoreTest]:
    """Score tests from a pass whose columns are one effect's size each."""
    scale = np.array([size_scale(case.library.effects[name].size) for name in values])
    columns = np.concatenate([flat_slopes(run) for run in runs]) * scale
    found = _score_tests(case, values, linearisation.scores_of(columns), scale)
    return found + _in_some_logs(case, linearisation, found, columns[:, [list(values).index(e.effect) for e in found]])


def _in_some_logs(
    case: Case, linearisation: Linearisation, found: Sequence[ScoreTest], columns: Array
) -> list[ScoreTest]:
    """The same tests of effects that some logs show and others deny, from a column (rows, k) of each in units of its size. An event is in a
    log of its own anyway (search/own_events.py)."""
    effects = [case.library.effects[entry.effect] for entry in found]
    gains, limits = [entry.gain for entry in found], [_limits(effect.size) for effect in effects]
    of_logs = zip(found, effects, parts(linearisation, columns, gains, limits), strict=True)
    return [_in_part(entry, effect.size, part) for entry, effect, part in of_logs if part and not effect.is_event]


def _limits(size: EffectParameter) -> tuple[float, float]:
    """How small and how large a size is proposed, in its unit from where it vanishes."""
    zero, unit = size.zero or 0.0, size_scale(size)
    least, most = (size.lower - zero) / unit, (size.upper - zero) / unit
    return max(least, -FARTHEST_SIZE), min(most, FARTHEST_SIZE)


def _in_part(entry: ScoreTest, size: EffectParameter, part: Part) -> ScoreTest:
    values = {**entry.values, size.symbol: (size.zero or 0.0) + part.size * size_scale(size)}
    return replace(entry, values=values, gain=part.gain, z=float(np.sqrt(2.0 * part.gain)), denied=part.denied)


def _score_tests(case: Case, values: Mapping[str, Values], scores: Scores, units: Array) -> list[ScoreTest]:
    """Score tests from the scores of one column for each effect, per unit of its size."""
    norm = np.sqrt(np.maximum(np.diag(scores.gram), 0.0))
    found = []
    for index, (name, given) in enumerate(values.items()):
        if norm[index] < 1e-3 or not np.isfinite(norm[index]):
            continue
        parameter, unit = case.library.effects[name].size, units[index]
        score = float(scores.score[index] / norm[index])
        size = float(np.clip(score / norm[index], -FARTHEST_SIZE, FARTHEST_SIZE))
        value = float(np.clip((parameter.zero or 0.0) + size * unit, parameter.lower, parameter.upper))
        size = (value - (parameter.zero or 0.0)) / unit
        gain = float(size * norm[index] * (score - 0.5 * size * norm[index]))
        absorbed = 1.0 - float(norm[index] ** 2 / max(scores.raw[index], 1e-12))
        found.append(ScoreTest(name, {**given, parameter.symbol: value}, score, gain, absorbed, float(norm[index])))
    return found


def _first_order(case: Case, linearisation: Linearisation, names: Sequence[str]) -> list[ScoreTest]:
    """Smooth effects on the way of the signals, by a small size."""
    found = []
    hypothesis = linearisation.fit.hypothesis
    for name in names:
        effect = case.library.effects[name]
        plain = sum(not parameter.refining for parameter in effect.parameters) == 1
        if effect.on_equations or not effect.smooth or not plain or effect.reads_late:
            continue
        unit = size_scale(effect.size)
        small = {**effect.absent, effect.size.symbol: (effect.size.zero or 0.0) + SMALL_SIZE * unit}
        runs = passes(case, hypothesis.with_effects({**hypothesis.effects, name: small}))
        if runs is not None:
            column = ((stacked(runs) - linearisation.w) / SMALL_SIZE)[:, None]
            own = _score_tests(case, {name: small}, linearisation.scores_of(column), np.array([unit]))
            found += [*own, *(_in_some_logs(case, linearisation, own, column) if own else [])]
    return found


def _finite(case: Case, linearisation: Linearisation, names: Sequence[str]) -> list[ScoreTest]:
    """Effects on the way of the signals, and limits: tried at each of their starts at full size. Steps keep several, as each has a hill of
    its own."""
    effects = [case.library.effects[name] for name in names]
    begun = thread_map(lambda effect: _ways(case, linearisation, effect), effects)
    ways = [(effect, way) for effect, found in zip(effects, begun, strict=True) for way in found]
    tried, ways = _first_told(linearisation, ways)
    tried += chain.from_iterable(thread_map(lambda way: along(case, linearisation, *way), ways))
    steps = {effect.name for effect in effects if effect.size.role is Role.STEP}
    return [entry for entry in tried if entry.effect not in steps] + _each_best(
        entry for entry in tried if entry.effect in steps
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
