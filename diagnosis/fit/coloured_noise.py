"""Noise with a memory, by maximum likelihood: a torque that comes and goes on an axis, errors of readings that are alike from row to row.

Both are Ornstein-Uhlenbeck processes of a standard deviation and a correlation time, states of every filter (sim/effects/gust.py eq (2),
library/reading_noise.py eq (1)). Those that the plant alone shows count where a gap is asked for; beside names only errors of readings do.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from diagnosis import decisions
from diagnosis.fit.foretold import foretold_of
from diagnosis.fit.likelihood import likelihood_of
from diagnosis.fit.linear_problem import Fit
from diagnosis.fit.process_noise import white_noise
from diagnosis.fit.profile_likelihood import likeliest, likelihoods
from diagnosis.fit.scoring import Number, likeliest_numbers
from diagnosis.hypothesis.case import Case, beginning_of
from diagnosis.hypothesis.hypothesis import Hypothesis, noise_on
from diagnosis.library.reading_noise import ReadingNoise
from sim.effect import Effect, Role

# Where searches begin. A torque that comes and goes: shares of the axis' usual torque, correlation times in s, and how many decades lower
# the white noise is whose place it takes; errors alike from row to row: standard deviations of a reading, correlation times in rows, and
# the same of the axes' white noise, which may have taken their place.
PUSH_SHARES, PUSH_TIMES_S, PUSH_LOWERS_NOISE = (0.001, 0.006, 0.03), (0.06, 0.25, 1.0, 4.0), 0.7
READING_SIZES, READING_ROWS, READING_LOWERS_NOISE = (0.5, 2.0), (1.5, 6.0, 25.0, 100.0), (0.0, 1.5)
NO_NOISE_SHARE = 0.02  # of the least size from which a search begins: less is none
BEND_FACTOR = 1.2  # a factor of size and time over which the likelihood's bend is taken

Numbers = tuple[float, float]  # standard deviation, correlation time in s


@dataclass(frozen=True, eq=False)
class Colour:
    """One noise with a memory: its numbers in a hypothesis, a hypothesis with others of them, or without; where its search begins, below
    which size there is none, the `most` that one has, the shortest and the longest time."""

    of: Callable[[Hypothesis], Numbers | None]
    put: Callable[[Hypothesis, Numbers], Hypothesis]
    without: Callable[[Hypothesis], Hypothesis]
    begun: Callable[[Hypothesis], Sequence[Hypothesis]]
    starts: tuple[Numbers, ...]
    least: float
    most: float
    times_s: tuple[float, float]


def with_colours(case: Case, found: Fit, asked: Sequence[Colour]) -> Hypothesis:
    """What was fitted with all of the `asked` noise with a memory that the logs tell of: each must gain what its two numbers cost in
    evidence, and is not sought where the innovations foretell no more."""
    hypothesis, value, part = found.hypothesis, found.log_likelihood, beginning_of(case)
    left = foretold_of(case, hypothesis)
    for colour in asked:
        if left < decisions.TAKEN_IN:
            break
        starts = [colour.put(begun, numbers) for begun in colour.begun(hypothesis) for numbers in colour.starts]
        begun = likeliest(part, starts)[0]
        start, there = _likeliest(part, begun, [colour], white_noise(case, begun))
        # What is there already was found beside other effects, and may be another noise than what is left beside these.
        is_new = colour.of(hypothesis) is None
        if colour.of(start) is None or (is_new and there <= likelihood_of(part, hypothesis)):
            continue
        if part is not case:
            start, there = _likeliest(case, start, [colour], white_noise(case, start))
        if colour.of(start) is not None and there > value + decisions.TAKEN_IN:
            hypothesis, value = start, there
            left = foretold_of(case, hypothesis)
    return hypothesis


def coloured_noise_of(case: Case, hypothesis: Hypothesis) -> Hypothesis:
    """The hypothesis with the likeliest numbers of all noise that it has, white and with a memory."""
    chosen = [colour for colour in colours(case) if colour.of(hypothesis) is not None]
    return _likeliest(case, hypothesis, chosen, white_noise(case, hypothesis))[0]


def beyond(case: Case, before: Hypothesis, there: Hypothesis, by: float) -> Hypothesis:
    """What lies `by` times the way from one to the other behind that, of parameters and of all noise; both have the same kinds of it."""
    chosen = [colour for colour in colours(case) if colour.of(there) is not None]
    found = replace(there, theta=there.theta + by * (there.theta - before.theta))
    for number in [*white_noise(case, there), *_numbers_of(chosen)]:
        at = number.of(there)
        found = number.put(found, at + by * (at - number.of(before)))
    return found


def colour_sd(case: Case, hypothesis: Hypothesis, gust: Effect) -> dict[str, float]:
    """What is known of a gust's size and time (one standard deviation of each), by how the likelihood bends over BEND_FACTOR to all sides,
    with each known to a factor of e before."""
    names = gust.symbol(Role.STRENGTH), gust.symbol(Role.MEMORY)
    values = hypothesis.effects[gust.name]

    def at(by_size: float, by_time: float) -> Hypothesis:
        moved = {names[0]: by_size * values[names[0]], names[1]: by_time * values[names[1]]}
        return hypothesis.with_effects({**hypothesis.effects, gust.name: moved})

    folds = (1.0, BEND_FACTOR, 1.0 / BEND_FACTOR)
    v = np.reshape(likelihoods(case, [at(by_size, by_time) for by_size in folds for by_time in folds]), (3, 3))
    bends = v[1, 0] + v[2, 0] - 2.0 * v[0, 0], v[0, 1] + v[0, 2] - 2.0 * v[0, 0]
    both = 0.25 * (v[1, 1] + v[2, 2] - v[1, 2] - v[2, 1])
    curvature = -np.nan_to_num([[bends[0], both], [both, bends[1]]]) / np.log(BEND_FACTOR) ** 2
    bent, vectors = np.linalg.eigh(curvature)
    relative = np.sqrt(vectors**2 @ (1.0 / (1.0 + np.maximum(bent, 0.0))))
    return {name: float(share * values[name]) for name, share in zip(names, relative, strict=True)}


def _likeliest(
    case: Case, hypothesis: Hypothesis, chosen: Sequence[Colour], white: Sequence[Number] = ()
) -> tuple[Hypothesis, float]:
    """The likeliest numbers of the `chosen` and of the white noise, without those colours that are too small to tell; and the log
    likelihood."""
    found, value = likeliest_numbers(case, hypothesis, [*white, *_numbers_of(chosen)])
    kept = found
    for colour in chosen:
        kept = kept if _numbers(colour, kept)[0] > colour.least else colour.without(kept)
    return (found, value) if kept is found else (kept, likelihood_of(case, kept))


def _numbers_of(chosen: Sequence[Colour]) -> list[Number]:
    return [number for colour in chosen for number in (size_of(colour), _time(colour))]


def size_of(colour: Colour) -> Number:
    """The size of a noise as a number of a hypothesis, log10 of its standard deviation: no larger than a plant file may state."""

    def put(hypothesis: Hypothesis, x: float) -> Hypothesis:
        return colour.put(hypothesis, (min(float(10.0**x), colour.most), _numbers(colour, hypothesis)[1]))

    return Number(lambda hypothesis: float(np.log10(_numbers(colour, hypothesis)[0])), put)


def _time(colour: Colour) -> Number:
    def put(hypothesis: Hypothesis, x: float) -> Hypothesis:
        return colour.put(hypothesis, (_numbers(colour, hypothesis)[0], float(np.clip(10.0**x, *colour.times_s))))

    return Number(lambda hypothesis: float(np.log10(_numbers(colour, hypothesis)[1])), put)


def _numbers(colour: Colour, hypothesis: Hypothesis) -> Numbers:
    numbers = colour.of(hypothesis)
    assert numbers is not None
    return numbers


def colours(case: Case) -> list[Colour]:
    """All that the rig may have: on axes that are not held in all logs, in outputs that any log has."""
    return [*_pushes(case), *_misreadings(case)]


def _pushes(case: Case) -> Iterator[Colour]:
    library = case.library
    held = set.intersection(*(set(flight.locked) for flight in case.flights))
    for index, axis in enumerate(library.bound.model.axes):
        effect = noise_on(case, index)
        if effect is not None and axis.name not in held:
            yield _push(effect, library.bound.model.places.axes[axis.name].torque_size, index, _longest_s(case))


def _misreadings(case: Case) -> Iterator[Colour]:
    step_s = min(flight.step_s for flight in case.flights)
    for name in case.library.bound.model.outputs:
        place = case.library.outputs.index(name)
        if any(np.isfinite(flight.filter_input.y[:, place]).any() for flight in case.flights):
            unit = float(np.sqrt(min(flight.filter_input.single[place] for flight in case.flights)))
            yield _misreading(name, unit, (step_s, max(step_s, _longest_s(case))))


def _longest_s(case: Case) -> float:
    """The longest memory that such noise may have."""
    return decisions.LONGEST_MEMORY_SHARE * max(float(np.ptp(flight.log.t_s)) for flight in case.flights)


def _push(effect: Effect, usual: float, axis: int, longest_s: float) -> Colour:
    size, time = effect.symbol(Role.STRENGTH), effect.symbol(Role.MEMORY)
    bounds = effect.parameter[time]
    upper = float(np.clip(longest_s, bounds.lower, bounds.upper))

    def of(hypothesis: Hypothesis) -> Numbers | None:
        values = hypothesis.effects.get(effect.name)
        return None if values is None else (values[size], values[time])

    def put(hypothesis: Hypothesis, numbers: Numbers) -> Hypothesis:
        return hypothesis.with_effects({**hypothesis.effects, effect.name: {size: numbers[0], time: numbers[1]}})

    def without(hypothesis: Hypothesis) -> Hypothesis:
        return hypothesis.with_effects({n: v for n, v in hypothesis.effects.items() if n != effect.name})

    def begun(hypothesis: Hypothesis) -> Sequence[Hypothesis]:
        process_noise = hypothesis.process_noise.copy()
        process_noise[axis] -= PUSH_LOWERS_NOISE
        return [replace(hypothesis, process_noise=process_noise)]

    times_s = dict.fromkeys(float(np.clip(time_s, bounds.lower, upper)) for time_s in PUSH_TIMES_S)
    starts = tuple((share * usual, time_s) for share in PUSH_SHARES for time_s in times_s)
    return Colour(
        of,
        put,
        without,
        begun,
        starts,
        NO_NOISE_SHARE * PUSH_SHARES[0] * usual,
        effect.parameter[size].upper,
        (bounds.lower, upper),
    )


def _misreading(output: str, unit: float, times_s: tuple[float, float]) -> Colour:
    def of(hypothesis: Hypothesis) -> Numbers | None:
        noise = hypothesis.reading_noise.get(output)
        return None if noise is None else (noise.sd, noise.time_s)

    def put(hypothesis: Hypothesis, numbers: Numbers) -> Hypothesis:
        return replace(hypothesis, reading_noise={**hypothesis.reading_noise, output: ReadingNoise(*numbers)})

    def without(hypothesis: Hypothesis) -> Hypothesis:
        return replace(
            hypothesis,
            reading_noise={name: noise for name, noise in hypothesis.reading_noise.items() if name != output},
        )

    def begun(hypothesis: Hypothesis) -> Sequence[Hypothesis]:
        return [replace(hypothesis, process_noise=hypothesis.process_noise - less) for less in READING_LOWERS_NOISE]

    starts = tuple((share * unit, rows * times_s[0]) for share in READING_SIZES for rows in READING_ROWS)
    least = NO_NOISE_SHARE * READING_SIZES[0] * unit
    return Colour(of, put, without, begun, starts, least, np.inf, times_s)
