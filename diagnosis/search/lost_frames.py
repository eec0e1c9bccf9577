"""Which commands were lost on the line, by what the readings say right after each.

With L the log of the likelihood ratio of each frame's loss to none (loss_ratios.py eq (1)), under a loss with probability p in every frame
the log evidence of all is the sum of log(1 - p + p exp L). Where a loss stays in doubt, with probability q, the mean of what may have
arrived is supposed, and the log likelihood counts less by a'a q (1 - q) / 2.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np
import sympy
from numpy.typing import NDArray

from diagnosis import decisions
from diagnosis.detect.linearisation import Linearisation, linearised
from diagnosis.filter.filter_input import FilterInput
from diagnosis.fit.gauss_newton import fit, unfitted
from diagnosis.fit.linear_problem import Fit
from diagnosis.fit.process_noise import with_process_noise
from diagnosis.hypothesis.case import Case, FilteredLog
from diagnosis.hypothesis.hypothesis import Hypothesis, coefficients
from diagnosis.library.input_effects import lost_with
from diagnosis.search.loss_ratios import FORGOTTEN_ROWS, Frames, loss_ratios
from jobs.thread_map import thread_map
from sim.bind import evaluated
from sim.effect import Effect, Role

Array = NDArray[np.float64]
SWEEPS = 12  # times that each frame is judged beside what is supposed of all others
LITTLE_GAINED = 0.005  # of what losses gain, below which another round is not worth its time
LOSS_ROUNDS = 8  # with what was found in the hypothesis there is less process noise, and more shows
LOSS_SHARES = np.geomspace(1e-3, 0.8, 60)


def with_losses(case: Case, linearisation: Linearisation) -> tuple[Case, Fit | None]:
    """The case whose filter inputs say of each frame how much likelier it is lost than not, and its fit with such losses, None where
    nothing speaks for them: then what the filter inputs say keeps losses from explaining a delay. The case as it was where nothing can be
    said."""
    losses = case.library.losses
    if losses is None or losses.name not in case.library.candidates or not drives(case):
        return case, None
    if any(len(filter_input.t_s) != filter_input.rows for filter_input in linearisation.filter_inputs):
        return case, None
    answers = _all_answers(case, linearisation)
    alone = _with_ratios(case, linearisation, answers, 0)
    if loss_evidence(alone, likely_share(alone)) < decisions.TAKEN_IN:
        return alone, None
    found, fitted = _settled(case, linearisation, losses, answers)
    theta = linearisation.fit.hypothesis.theta
    if fitted is not None and theta @ theta > decisions.ASTRAY * len(theta):
        found, fitted = _likelier((found, fitted), _from_stated(case, linearisation, losses))
    return found, fitted


def _settled(
    case: Case, linearisation: Linearisation, losses: Effect, answers: Sequence[Array]
) -> tuple[Case, Fit | None]:
    """What the innovations say of every frame, found again with what was found supposed until nothing is gained."""
    found, fitted = _fitted(case, linearisation, losses, answers)
    if fitted is None or fitted.log_posterior < linearisation.fit.log_posterior + decisions.TAKEN_IN:
        return found, None
    for _ in range(LOSS_ROUNDS):
        refined_noise = linearised(found, fitted)
        again, better = _fitted(found, refined_noise, losses, _all_answers(found, refined_noise))
        if better is None or better.log_posterior < fitted.log_posterior + decisions.TAKEN_IN:
            break
        more = better.log_posterior - fitted.log_posterior
        found, fitted = again, better
        if more < LITTLE_GAINED * (fitted.log_posterior - linearisation.fit.log_posterior):
            break
    return found, fitted


def _from_stated(case: Case, linearisation: Linearisation, losses: Effect) -> tuple[Case, Fit | None]:
    """The same from the parameters as stated: those of a plant fitted without losses bend to take their part."""
    start = unfitted(case, linearisation.fit.hypothesis)
    if start is None:
        return case, None
    stated = linearised(case, start)
    return _settled(case, stated, losses, _all_answers(case, stated))


def _likelier(one: tuple[Case, Fit | None], other: tuple[Case, Fit | None]) -> tuple[Case, Fit | None]:
    return max(one, other, key=lambda entry: -np.inf if entry[1] is None else entry[1].log_posterior)


def _all_answers(case: Case, linearisation: Linearisation) -> list[Array]:
    return thread_map(partial(_unit_answers, case, linearisation), range(len(case.flights)))


def _fitted(
    case: Case, linearisation: Linearisation, losses: Effect, answers: Sequence[Array]
) -> tuple[Case, Fit | None]:
    """What the innovations of a ground say of every frame, and the fit with that; None where it says nothing."""
    found = _with_ratios(case, linearisation, answers, SWEEPS)
    share = likely_share(found)
    if loss_evidence(found, share) < decisions.TAKEN_IN:
        return found, None
    hypothesis = linearisation.fit.hypothesis
    start = hypothesis.with_effects({**hypothesis.effects, losses.name: {losses.symbol(Role.LOSS): share}})
    return found, fit(found, with_process_noise(found, start), rounds=4)


def likely_share(case: Case) -> float:
    """The share p of lost frames with the most evidence."""
    return float(LOSS_SHARES[np.argmax([loss_evidence(case, share) for share in LOSS_SHARES.tolist()])])


def loss_evidence(case: Case, share: float) -> float:
    """Log evidence of a loss with probability `share` in every frame against none."""
    ratios = np.concatenate([flight.filter_input.lost for flight in case.flights])
    return float(np.sum(np.logaddexp(np.log1p(-share), np.log(share) + ratios[ratios != 0.0])))


def drives(case: Case) -> dict[int, tuple[int, sympy.Expr]]:
    """Input column -> the state that it drives and by how much; only rotors whose speed is a state of its own have one.

    Where an input pushes an axis at once, frames that are judged one by one take what a lag does.
    """
    library, model = case.library, case.library.bound.model
    return {
        model.inputs.index(rotor.variable): (
            library.states.index(str(rotor.speed)),
            sympy.diff(rotor.drive, rotor.variable),
        )
        for rotor in model.places.rotors.values()
        if rotor.drive is not None
    }


def _with_ratios(case: Case, linearisation: Linearisation, answers: Sequence[Array], sweeps: int) -> Case:
    """The case with L of every frame, 0 where the command stays as it was; `sweeps` 0 takes every frame for itself."""
    ends = np.cumsum([flight.filter_input.rows for flight in case.flights])[:-1]
    columns = list(drives(case))

    def judged(flight: FilteredLog, unit: Array, w: Array) -> FilteredLog:
        given = flight.filter_input
        before = _prior_loss(case, given, linearisation.fit.hypothesis)
        ratios, power = loss_ratios(Frames(given.u, columns, unit, w, before, _judged(given)), sweeps)
        return replace(flight, filter_input=replace(given, lost=ratios, loss_power=power))

    flights = thread_map(
        judged, case.flights, answers, np.split(linearisation.w.reshape(-1, max(case.slots) + 1), ends)
    )
    return case.with_flights(flights)


def _unit_answers(case: Case, linearisation: Linearisation, index: int) -> Array:
    """Answers (rows, FORGOTTEN_ROWS, slots, drives) of the innovations from a frame's own row on to a unit of each
    drive's input over that frame."""
    filter_input, run, hypothesis = (
        linearisation.filter_inputs[index],
        linearisation.runs[index],
        linearisation.fit.hypothesis,
    )
    p = coefficients(case, case.library.compiled(hypothesis.effects), hypothesis)
    model = case.library.bound.model
    rows = np.arange(len(filter_input.t_s))
    h = np.append(np.diff(filter_input.t_s), 0.0)
    found = []
    for state, gain in drives(case).values():
        values = np.zeros((len(rows), 1, FORGOTTEN_ROWS))
        values[rows, 0, rows % FORGOTTEN_ROWS] = h * evaluated(model, p[: case.library.own], gain)
        found.append(linearisation.filter.response(filter_input, run, values.__getitem__, [state], case.slots))
    return _unfolded(np.stack(found, axis=2))


def _unfolded(answers: Array) -> Array:
    """Answers by frame and lag, 0 beyond the end, from columns (rows, slots, drives, FORGOTTEN_ROWS) that frames
    FORGOTTEN_ROWS rows apart share."""
    rows = np.arange(len(answers))[:, None]
    later = rows + np.arange(FORGOTTEN_ROWS)
    own = answers[np.minimum(later, len(answers) - 1), :, :, rows % FORGOTTEN_ROWS]
    return np.where((later < len(answers))[:, :, None, None], own, 0.0)


def _prior_loss(case: Case, filter_input: FilterInput, hypothesis: Hypothesis) -> Array:
    """The probability with which each frame's loss is supposed already."""
    losses = case.library.losses
    if losses is None or losses.name not in hypothesis.effects:
        return np.zeros(filter_input.rows)
    return lost_with(filter_input.lost, hypothesis.effects[losses.name][losses.symbol(Role.LOSS)])


def _judged(filter_input: FilterInput) -> NDArray[np.uint8]:
    """Whether each frame can be judged (rows,): not the two beside rows that the log lacks, as nobody knows for how long the one was held,
    nor what the other's loss would hold."""
    judged = np.ones(filter_input.rows, dtype=np.uint8)
    for row in np.flatnonzero(filter_input.untold_s):
        judged[row : row + 2] = 0
    return judged
