"""One hypothesis fitted: a first joint fit of an effect with the plant and what was found before, then to its end."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import partial, reduce

import numpy as np
from numpy.typing import NDArray

from diagnosis import decisions
from diagnosis.detect.by_log import with_start
from diagnosis.detect.score_tests import holding
from diagnosis.detect.starts import ScoreTest
from diagnosis.fit.coloured_noise import coloured_noise_of
from diagnosis.fit.evidence import FittedHypothesis, as_fitted
from diagnosis.fit.free_numbers import from_zero
from diagnosis.fit.gauss_newton import fit
from diagnosis.fit.jitter import scatters, with_jitter
from diagnosis.fit.linear_problem import Fit
from diagnosis.fit.process_noise import with_process_noise
from diagnosis.hypothesis.case import Case, beginning_of
from diagnosis.hypothesis.hypothesis import Hypothesis, first_state_noise
from diagnosis.search.rough_numbers import POLISHING, STEP_FINELY, is_rough, likeliest_size, polished
from sim.effect import Role

Array = NDArray[np.float64]
LESS = 0.2  # of an effect's size, from which it is fitted once more where more made all worse
REFINED_ROUNDS = 5  # from where a first fit ended: its own rule stops earlier where little is gained
MOST_TURNS = 5  # of what is rough and all else: an input's steps behind a delay of 25 ms took three
EXPECTS_LESS = 1.0  # decades: one to three led a lag of 0.12 s and a sag home, none to a lag of 0.5 s beside a mass 16 deviations off
VANISHED = 0.02  # of where a shape's search begins: so near none its slopes vanish
FRICTION_FACTORS = np.geomspace(
    0.5, 2.0, 7
)  # of a friction that holds an axis: where it holds, slopes do not tell what more of it would do


@dataclass(frozen=True, eq=False)
class Proposal:
    """A further effect to fit from a start."""

    start: Fit
    score_test: ScoreTest

    def begun(self, case: Case) -> Hypothesis:
        """Where its fit begins."""
        return self.all_begun(case)[0]

    def all_begun(self, case: Case) -> list[Hypothesis]:
        """Where it may begin, the most promising first."""
        effect = case.library.effects[self.score_test.effect]
        return [
            with_start(case, self.start.hypothesis, effect, start.values, start.denied)
            for start in self.score_test.starts
        ]


def rough(case: Case, proposal: Proposal) -> FittedHypothesis | None:
    """A first joint fit, under the process noise that was there before, the better one where it may begin at several values."""
    found = [_rough(case, proposal, start) for start in proposal.all_begun(case)]
    return max((entry for entry in found if entry), key=lambda entry: entry.evidence, default=None)


def _rough(case: Case, proposal: Proposal, start: Hypothesis) -> FittedHypothesis | None:
    entry = proposal.score_test
    if is_rough(case, entry.effect):
        start = polished(case, start, entry.effect, POLISHING)
    stated = _from_stated(case, start) if is_astray(start, decisions.ASTRAY) else None
    found = stated or fit(case, start, rounds=4)
    if found is not None and found.log_posterior < proposal.start.log_posterior:
        found = _likelier(found, fit(case, _lessened(case, start, entry.effect), rounds=4))
    found = _scattered(case, found, [entry.effect])
    if stated is None and (found is None or is_astray(found.hypothesis, decisions.ASTRAY)):
        found = _likelier(found, _from_stated(case, start))
    if found is not None and holding(case.library, [entry.effect]):
        found = _at_its_level(case, found, entry.effect)
    return None if found is None or not _whole_counts(case, found) else as_fitted(case, found)


def is_astray(hypothesis: Hypothesis, limit: float) -> bool:
    """Whether the parameters went so far, in mean square standard deviations."""
    return bool(hypothesis.theta @ hypothesis.theta > limit * len(hypothesis.theta))


def at_its_place(case: Case, begun: Hypothesis) -> FittedHypothesis | None:
    """A first fit from where the rest fits already."""
    found = fit(case, begun, rounds=4)
    return None if found is None or not _whole_counts(case, found) else as_fitted(case, found)


def refined(case: Case, fitted: FittedHypothesis) -> FittedHypothesis | None:
    """The fit with the process noise that then remains; what is rough and all else are fitted in turns, until a turn moves all else
    little: what is rough is as likely as it was then."""
    start, effects = _under_own_noise(case, fitted.fit.hypothesis, fitted.effects), fitted.effects
    coarse = [name for name in effects if is_rough(case, name)]
    if not coarse:
        found = _refined_once(case, start, effects)
        return None if found is None else as_fitted(case, found)
    best: Fit | None = None
    for _ in range(MOST_TURNS):
        for name in coarse:
            start = polished(case, start, name, STEP_FINELY)
        begun = fit(case, start, rounds=0)
        found = None if begun is None else _refined_once(case, _under_own_noise(case, start, effects), effects)
        best = _likelier(best, found)
        if found is None or begun is None or found.log_posterior < begun.log_posterior + decisions.TAKEN_IN:
            break
        start = found.hypothesis
    return None if best is None else as_fitted(case, best)


def _under_own_noise(case: Case, hypothesis: Hypothesis, effects: Sequence[str]) -> Hypothesis:
    """The same with the noise that remains, and the scatter of what comes late."""
    return with_jitter(case, coloured_noise_of(case, hypothesis), effects)


def _refined_once(case: Case, start: Hypothesis, effects: Sequence[str]) -> Fit | None:
    """Frictions that hold, then all that has slopes."""
    for name in holding(case.library, effects):
        start = likeliest_size(case, start, name, FRICTION_FACTORS)
    found = fit(case, start, rounds=REFINED_ROUNDS)
    for begun in [] if found is None else _rounder(case, found.hypothesis):
        found = _likelier(found, fit(case, begun, rounds=REFINED_ROUNDS))
    return found


def _rounder(case: Case, hypothesis: Hypothesis) -> list[Hypothesis]:
    """The hypothesis with each shape that vanished at its start again: a corner that is sharp has no slope by how round it is."""
    return [
        hypothesis.with_value(name, parameter.symbol, parameter.starts[-1])
        for name in case.added(hypothesis.effects)
        for parameter in case.library.effects[name].parameters
        if parameter.refining and parameter.role is Role.NUMBER and not parameter.rough
        if parameter.starts and hypothesis.effects[name][parameter.symbol] < VANISHED * parameter.starts[-1]
    ]


def in_all_logs(case: Case, fitted: FittedHypothesis) -> FittedHypothesis:
    """The same with what some logs seem to lack in all of them, where that ends better: by first order, at sizes far off, a log denies what
    it shows."""
    hypothesis = fitted.fit.hypothesis
    if not hypothesis.lacks:
        return fitted
    begun = fit(case, replace(hypothesis, lacks={}), rounds=REFINED_ROUNDS)
    end = None if begun is None else refined(case, as_fitted(case, begun))
    return fitted if end is None or end.evidence <= fitted.evidence else end


def once_more(case: Case, fitted: FittedHypothesis) -> FittedHypothesis:
    """The same begun once more by a filter that expects any motion, where that ends better: with little noise slopes lead to the next hill
    only, and noise with a memory holds it there. Where its parameters went far also from those as stated: by the same filter, and with
    effects a fifth as large by one that expects less, whose readings cannot make up for a plant that is bent."""
    hypothesis = fitted.fit.hypothesis
    starts = [_open_to_all(case, hypothesis, 0.0)]
    if is_astray(hypothesis, decisions.ASTRAY):
        stated = replace(hypothesis, theta=np.zeros_like(hypothesis.theta))
        less = reduce(partial(_lessened, case), fitted.effects, stated)
        starts += [_open_to_all(case, stated, 0.0), _open_to_all(case, less, EXPECTS_LESS)]
    found = [begun for begun in (_begun(case, start) for start in starts) if begun is not None]
    start = max(found, key=lambda begun: begun.log_posterior, default=None)
    end = None if start is None else refined(case, as_fitted(case, start))
    return fitted if end is None or end.evidence <= fitted.evidence else end


def _open_to_all(case: Case, hypothesis: Hypothesis, less: float) -> Hypothesis:
    """The same without noise with a memory, its white noise `less` decades below that of every first fit."""
    level = float(decisions.FIRST_PROCESS_NOISE) - less
    effects = {n: v for n, v in hypothesis.effects.items() if not case.library.effects[n].is_noise}
    return replace(
        hypothesis.with_effects(effects),
        process_noise=np.full_like(hypothesis.process_noise, level),
        reading_noise={},
        state_noise=first_state_noise(case, level),
    )


def _begun(case: Case, start: Hypothesis) -> Fit | None:
    """A first fit, and one with the noise that it leaves."""
    found = fit(case, start, rounds=4)
    return None if found is None else fit(case, with_process_noise(beginning_of(case), found.hypothesis), rounds=3)


def _scattered(case: Case, found: Fit | None, effects: Sequence[str]) -> Fit | None:
    """The fit, or a likelier one where readings come after a delay that scatters, with the process noise that the delay leaves."""
    if found is None or not any(scatters(case, name) for name in effects):
        return found
    start = with_jitter(case, with_process_noise(case, found.hypothesis), effects)
    if start.effects == found.hypothesis.effects:
        return found
    return _likelier(found, fit(case, with_process_noise(case, start), rounds=4))


def _at_its_level(case: Case, found: Fit, effect: str) -> Fit:
    """The fit, or a likelier one from another level of a friction that holds its axis."""
    start = likeliest_size(case, found.hypothesis, effect, FRICTION_FACTORS)
    if start.effects[effect] == found.hypothesis.effects[effect]:
        return found
    return _likelier(found, fit(case, start, rounds=4)) or found


def _lessened(case: Case, start: Hypothesis, effect: str) -> Hypothesis:
    """The start with an effect of a fifth of its size: what it is added to must not fit worse for it."""
    values = dict(start.effects[effect])
    for parameter in case.library.effects[effect].parameters:
        if from_zero(parameter):
            zero = parameter.zero or 0.0
            values[parameter.symbol] = zero + LESS * (values[parameter.symbol] - zero)
    return start.with_effects({**start.effects, effect: values})


def _from_stated(case: Case, start: Hypothesis) -> Fit | None:
    """The fit from the parameters as stated: where the nominal plant had gone far astray, nothing is found from there."""
    low_noise = np.minimum(start.process_noise, decisions.FIRST_PROCESS_NOISE)
    first = first_state_noise(case, float(decisions.FIRST_PROCESS_NOISE))
    low_states = {state: min(level, first.get(state, level)) for state, level in start.state_noise.items()}
    return _begun(
        case, replace(start, theta=np.zeros_like(start.theta), process_noise=low_noise, state_noise=low_states)
    )


def _likelier(one: Fit | None, other: Fit | None) -> Fit | None:
    if one is None or other is None:
        return one or other
    return one if one.log_posterior >= other.log_posterior else other


def _whole_counts(case: Case, found: Fit) -> bool:
    """Whether every slip of a sensor is at least a count: what is smaller is rounding."""
    library = case.library
    for name, values in found.hypothesis.effects.items():
        effect = library.effects[name]
        jump = effect.having(Role.JUMP)
        if jump is not None:
            sensor = library.bound.model.places.sensors[effect.place].output
            if abs(values[jump.symbol]) < decisions.MORE_THAN_ONE * library.bound.plant.sensors[sensor]:
                return False
    return True


def keep_better(found: dict[frozenset[str], FittedHypothesis], fitted: Iterable[FittedHypothesis]) -> None:
    """Of each set of effects the better of what was found and what was tried."""
    for entry in fitted:
        known = found.setdefault(frozenset(entry.effects), entry)
        if entry.evidence > known.evidence:
            found[frozenset(entry.effects)] = entry
