"""Which commands were lost on the line: frame by frame, by what the readings say right after it.

A frame's loss leaves the inputs at what they were. Its answer a in the whitened innovations w is known from the filter; where the
innovations were found with a share pi of the loss supposed already, the log of the likelihood ratio of loss to none is

    L = a'(w + pi a) - a'a / 2

and under a loss with probability p in every frame the log evidence of all is the sum of log(1 - p + p exp L).
"""

from dataclasses import replace

import numpy as np
import sympy
from numpy.typing import NDArray

from diagnosis.case import Case, Flight
from diagnosis.fit import Fit, fit
from diagnosis.ground import Ground
from diagnosis.hypothesis import coefficients
from diagnosis.inputs import LOST_FRAMES, lost_with
from diagnosis.unrest import with_unrest

Array = NDArray[np.float64]
APART = 100  # rows after which the filter has forgotten a frame
SHARES = np.geomspace(1e-3, 0.8, 60)
WORTH = 10.0  # nats below which no frame counts as lost


def with_losses(case: Case, ground: Ground) -> tuple[Case, Fit | None]:
    """The case whose tapes say of each frame how much likelier it is lost than not, and its fit with such losses; the case as it was
    and None where nothing speaks for losses."""
    if LOST_FRAMES not in case.kit.candidates or not _drives(case):
        return case, None
    found = _with_ratios(case, ground)
    if evidence(found, likely_share(found)) < WORTH:
        return case, None
    supposed = ground.fit.supposed
    start = supposed.with_effects({**supposed.effects, LOST_FRAMES: {"p": likely_share(found)}})
    fitted = fit(found, with_unrest(found, start), rounds=4)
    if fitted is None or fitted.log_posterior < ground.fit.log_posterior + WORTH:
        return case, None
    return found, fitted


def likely_share(case: Case) -> float:
    """The share p of lost frames with the most evidence."""
    return float(SHARES[np.argmax([evidence(case, share) for share in SHARES.tolist()])])


def evidence(case: Case, share: float) -> float:
    """Log evidence of a loss with probability `share` in every frame against none."""
    ratios = np.concatenate([flight.tape.lost for flight in case.flights])
    return float(np.sum(np.logaddexp(np.log1p(-share), np.log(share) + ratios[ratios != 0.0])))


def _drives(case: Case) -> dict[int, tuple[int, sympy.Expr]]:
    """Input column -> the state that it drives and by how much; only rotors whose speed is a state of its own have one."""
    kit, model = case.kit, case.kit.bound.model
    return {
        model.inputs.index(rotor.variable): (
            kit.states.index(str(rotor.speed)),
            sympy.diff(rotor.drive, rotor.variable),
        )
        for rotor in model.places.rotors.values()
        if rotor.drive is not None
    }


def _with_ratios(case: Case, ground: Ground) -> Case:
    at = 0
    flights: list[Flight] = []
    for flight, tape in zip(case.flights, ground.tapes, strict=True):
        rows = tape.rows * (max(case.slots) + 1)
        w = ground.w[at : at + rows].reshape(tape.rows, -1)
        at += rows
        flights.append(replace(flight, tape=replace(flight.tape, lost=_ratios(case, ground, len(flights), w))))
    return case.with_flights(flights)


def _ratios(case: Case, ground: Ground, index: int, w: Array) -> Array:
    """L of every frame of a flight; 0 where the command stays as it was."""
    flight, tape, run = case.flights[index], ground.tapes[index], ground.runs[index]
    supposed = ground.fit.supposed
    p = coefficients(case, case.kit.variant(supposed.effects), supposed)
    known = {symbol: p[place] for place, symbol in enumerate(case.kit.bound.model.parameter_symbols)}
    rows = np.arange(len(tape.t_s))
    h = np.append(np.diff(tape.t_s), 0.0)
    drives = _drives(case)
    values = np.zeros((len(rows), len(drives), APART))
    for place, (column, (_, gain)) in enumerate(drives.items()):
        held = np.append(0.0, tape.u[:-1, column] - flight.tape.u[1:, column])
        values[rows, place, rows % APART] = held * h * float(sympy.sympify(gain).subs(known))
    answers = ground.filter.respond(tape, run, values, [state for state, _ in drives.values()], case.slots)
    shares = lost_with(flight.tape.lost, supposed.effects.get(LOST_FRAMES, {}).get("p", 0.0))
    found = np.zeros(len(rows))
    for row in rows[1:].tolist():
        a = answers[row : row + APART, :, row % APART]
        found[row] = np.sum(a * (w[row : row + APART] + shares[row] * a)) - 0.5 * np.sum(a * a)
    return found
