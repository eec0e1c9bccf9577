"""Score tests of all effects: how much of what is left a signature explains once the plant's own coefficients have had their share."""

from collections.abc import Mapping, Sequence, Set
from dataclasses import replace
from itertools import chain

import numpy as np
from numpy.typing import NDArray

from diagnosis.detect.by_log import Part, parts
from diagnosis.detect.full_size import tried
from diagnosis.detect.instants import instants
from diagnosis.detect.linearisation import Linearisation, Scores
from diagnosis.detect.starts import ScoreTest, each_best, shape_starts
from diagnosis.detect.waves import wave_starts
from diagnosis.filter.kalman import Pass
from diagnosis.fit.free_numbers import size_scale
from diagnosis.fit.likelihood import flat_slopes, stacked
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import passes
from diagnosis.library.effect_library import EffectLibrary
from jobs.thread_map import thread_map
from sim.effect import Effect, EffectParameter, Role, Values

Array = NDArray[np.float64]
SMALL_SIZE = 0.05
FARTHEST_SIZE = 30.0  # references: no larger size is proposed


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
        (tried, _smooth, _smooth, _first_order),
        (finite + holding(library, wanted), others, stateless, costly),
    )
    found = thread_map(lambda kind, names: kind(case, linearisation, names), kinds, chosen)
    best: dict[str, ScoreTest] = {}
    for entry in chain.from_iterable(found):
        if entry.effect not in best or entry.gain > best[entry.effect].gain:
            best[entry.effect] = entry
    return sorted(best.values(), key=lambda entry: -entry.gain)


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
    return each_best(found)


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
