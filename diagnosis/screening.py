"""Whether there is a gap at all: the plant alone as its logs have it, what of the library shows beside it, and whether names are sought
beside noise with a memory."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from diagnosis import decisions
from diagnosis.decisions import decided
from diagnosis.detect.detection import detect
from diagnosis.detect.linearisation import Linearisation, linearised
from diagnosis.detect.score_tests import score_effects
from diagnosis.detect.starts import ScoreTest
from diagnosis.fit.between_rows import between_rows, held_beside, with_commands
from diagnosis.fit.evidence import FittedHypothesis, as_fitted, log_evidence
from diagnosis.fit.gauss_newton import fit
from diagnosis.fit.linear_problem import Fit
from diagnosis.fit.nominal import best_plain_fit, plain_beside, plain_from, with_memory, with_memory_from
from diagnosis.hypothesis.case import Case, make_case
from diagnosis.hypothesis.usual import with_usual
from diagnosis.library.effect_library import effect_library
from diagnosis.result import HeldInputs, Material, Seen
from diagnosis.search.draughts import gust_shares, without_memory
from diagnosis.search.lost_frames import with_losses
from diagnosis.search.singles import Alone, FirstFits, alone, first_fits
from diagnosis.validate.fitted_logs import FittedLogs
from records.reasons import Decision
from sim.added_effects import without_effects
from sim.bind import BoundPlant


def seen_of(bound: BoundPlant, material: Material) -> Seen:
    """Ask whether there is a gap at all."""
    library = effect_library(without_effects(bound))
    library.prepare()
    split = len(material.logs)
    case = make_case(library, material.logs, material.used[:split], bound)
    checked = make_case(library, material.holdout, material.used[split:], bound, split) if material.holdout else None
    return detected(case, checked)


def detected(case: Case, checked: Case | None) -> Seen:
    """Fit the plant alone, and score the library beside it; where a gap shows, once more from where the best single effect left the plant's
    numbers, as slopes from the stated ones may lead to another hill."""
    return _detected(case, checked, best_plain_fit(case), with_memory)


def detected_anew(case: Case, seen: Seen, beside: FittedHypothesis | None) -> Seen:
    """The same of another reading of the logs, from the plant as it was fitted before; `beside` is what was fitted already. What inputs did
    between rows is asked anew: where an axis was taken to stick that creeps, they may have seemed to move."""
    known, checked = seen.retuned.fit.hypothesis, seen.checked
    if seen.held is not None:
        case, checked = case.with_flights(seen.held.case.flights), seen.held.checked

    def noisy(case: Case, found: Fit) -> Fit:
        return with_memory_from(case, found, known)

    return _detected(case, checked, plain_from(case, known), noisy, beside)


def _detected(
    case: Case,
    checked: Case | None,
    as_held: Fit,
    noisy: Callable[[Case, Fit], Fit],
    beside: FittedHypothesis | None = None,
) -> Seen:
    commands, nominal, between = between_rows(case, as_held)
    held = HeldInputs(case, checked, as_held, between[0].value or 0.0) if nominal is not as_held else None
    logs = case if held is None else with_commands(case, commands)
    others = None if checked is None or held is None else with_commands(checked, commands)
    seen, names = _screened(logs, others or checked, noisy(logs, nominal), between, beside)
    if names is None or held is None:
        return replace(seen, held=held)
    rule, as_logged = held_beside(case, commands, names.best)
    if not as_logged:
        return replace(seen, held=held).because(rule)
    return _screened(case, checked, noisy(case, as_held), (*between, rule), beside)[0]


def _screened(
    case: Case, checked: Case | None, nominal: Fit, rules: tuple[Decision, ...], beside: FittedHypothesis | None
) -> tuple[Seen, FirstFits | None]:
    """What the plant alone leaves to the library, and single effects beside it as they begin; None of these where there is no gap."""
    beside = None if beside is None else _as_read(case, beside)
    seen = replace(scored(case, checked, nominal, rules), beside=beside)
    if not alarmed(seen.detection.p):
        return seen, None
    still = _still(seen)
    seen = with_tests(seen) if still is None else replace(seen, still=still)
    names = _first_fits(seen.still or seen)
    best = names.best
    again = plain_beside(case, best.fit, nominal)
    if again is None:
        return _with_names(seen, names), names
    gain = log_evidence(again, case.library.effects) - seen.retuned.evidence
    better = gain > decisions.TAKEN_IN
    outcome = "the plant alone is fitted from there" if better else "the plant alone stays as it was fitted"
    rule = decided("plain_again", " + ".join(best.effects), gain, decisions.TAKEN_IN, outcome)
    if not better:
        return _with_names(seen, names).because(rule), names
    return replace(scored(case, checked, with_memory(case, again), (*rules, rule)), beside=beside), names


def _as_read(case: Case, known: FittedHypothesis) -> FittedHypothesis | None:
    """What was fitted already, as these logs are read; None where it cannot be run along them so."""
    found = fit(case, known.fit.hypothesis, rounds=0)
    return None if found is None else as_fitted(case, found)


def scored(case: Case, checked: Case | None, nominal: Fit, rules: tuple[Decision, ...]) -> Seen:
    """What the plant alone as fitted leaves to the library, and whether that is a gap."""
    case = with_usual(case, nominal.hypothesis)
    linearisation = linearised(case, nominal)
    case, lossy = with_losses(case, linearisation)
    linearisation = replace(linearisation, case=case)
    retuned = FittedHypothesis((), nominal, log_evidence(nominal, case.library.effects))
    detection, score_tests = detect(case, linearisation, lambda: _tests(linearisation), lossy)
    rules = (*rules, *detection.decisions, false_alarm("logs", detection.p))
    return Seen(case, checked, retuned, linearisation, score_tests, lossy, detection, rules)


def with_tests(seen: Seen) -> Seen:
    """The same with its score tests."""
    return seen if seen.score_tests is not None else replace(seen, score_tests=_tests(seen.linearisation))


def _tests(linearisation: Linearisation) -> tuple[ScoreTest, ...]:
    return tuple(score_effects(linearisation.case, linearisation, linearisation.case.library.candidates))


def beside_noise(seen: Seen) -> Seen:
    """The same, from the plant without noise with a memory where a name is to be had for it: such noise follows any motion row by row, as
    slow as it is, and beside it a name would explain only what is fast. What follows does not foresee, so the best name there must
    predict the logs better over a second; where nothing shows beside the noise, it must be by far likelier."""
    still = seen.still or _still(seen)
    if still is None:
        return seen
    names = alone_of(still)
    best = names.best(1)[0]
    rule, stands = (_foreseen if alarmed(seen.detection.p) else _over_noise)(seen, best)
    if not stands:
        return with_tests(seen).because(rule)
    chance = min(seen.detection.p, float(np.exp(-max(best.evidence - seen.retuned.evidence, 0.0))))
    found = replace(still, begun=names, detection=replace(seen.detection, p=chance), decisions=seen.decisions)
    return found.because(rule)


def alone_of(seen: Seen) -> Alone:
    """Its single effects, fitted where that was not done yet."""
    return seen.begun or alone(seen.case, _first_fits(seen))


def _first_fits(seen: Seen) -> FirstFits:
    return first_fits(seen.case, seen.retuned, seen.linearisation, seen.tests, seen.lossy, seen.beside)


def alarmed(p: float) -> bool:
    """Whether so large a gap has a chance without one that is small enough to look for a cause."""
    return p <= decisions.ALARM


def false_alarm(of: str, p: float) -> Decision:
    """The rule that asks whether a gap of the chance `p` without one is worth a cause."""
    return decided("false_alarm", of, p, decisions.ALARM, "a cause is looked for" if alarmed(p) else "no gap")


def _with_names(seen: Seen, names: FirstFits) -> Seen:
    """The same with single effects as fitted from where they begin: without noise with a memory where the plant has any, as beside that
    they explain little."""
    found = alone(seen.case, names)
    if seen.still is None:
        return replace(seen, begun=found)
    return replace(seen, still=replace(seen.still, begun=found))


def _foreseen(seen: Seen, best: FittedHypothesis) -> tuple[Decision, bool]:
    """Whether the best name without noise with a memory predicts the logs better than the plant with it, and the rule; or whether that is
    larger than noise, as where two effects are missing at once."""
    shares = gust_shares(seen.case, seen.retuned.fit.hypothesis)
    largest = max(shares, key=lambda name: shares[name], default="plant")
    without = "a cause is looked for without noise"
    if shares.get(largest, 0.0) > decisions.USUAL_GUST:
        return decided("beyond_noise", largest, shares[largest], decisions.USUAL_GUST, without), True
    gain = FittedLogs(seen.case).gain(best.fit.hypothesis, seen.retuned.fit.hypothesis) if best.effects else 0.0
    stands = gain >= decisions.MATTERS
    outcome = without if stands else "a cause is looked for beside noise"
    return decided("beside_noise", " + ".join(best.effects) or "plant", gain, decisions.MATTERS, outcome), stands


def _over_noise(seen: Seen, best: FittedHypothesis) -> tuple[Decision, bool]:
    """Whether it is likelier, by as much as anything further must gain, and the rule."""
    gain = best.evidence - seen.retuned.evidence
    stands = bool(best.effects) and gain > decisions.TAKEN_IN
    outcome = "a cause is looked for" if stands else "noise"
    return decided("over_noise", " + ".join(best.effects) or "plant", gain, decisions.TAKEN_IN, outcome), stands


def _still(seen: Seen) -> Seen | None:
    """The same from the plant without noise with a memory; None where it has none, or cannot follow its logs then."""
    case = seen.case
    still = without_memory(case, seen.retuned)
    if still is None:
        return None
    linearisation = linearised(case, still.fit)
    tests = _tests(linearisation)
    return replace(seen, retuned=still, linearisation=linearisation, score_tests=tests, begun=None, still=None)
