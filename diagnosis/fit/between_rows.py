"""What inputs did between two rows of a log: held as they were logged, or commanded anew before the next; whichever the logs find likelier.

A controller that wrote the log holds its command to the next row. A log that keeps every second or fourth of its rows, or of an input that
somebody else sampled, shows the ends of a way: to hold the first puts the input late, which looks like a delay or a lead. Of n commands a
row, straight from one row to the next, the mean is

(1)  u_k + (1 - 1/n) (u_(k+1) - u_k) / 2

which stands for the way to second order in the step.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from diagnosis import decisions
from diagnosis.decisions import decided, held_against
from diagnosis.fit.evidence import FittedHypothesis
from diagnosis.fit.gauss_newton import fit
from diagnosis.fit.linear_problem import Fit
from diagnosis.fit.nominal import NOMINAL_ROUNDS, gain_over, settled
from diagnosis.hypothesis.case import Case, FilteredLog
from records.reasons import Decision

HELD = 1.0
COMMANDS = (2.0, 4.0, np.inf)  # a row: every second row kept, every fourth, or an input that never stands still


def between_rows(case: Case, held: Fit) -> tuple[tuple[float, ...], Fit, tuple[Decision, ...]]:
    """How many commands each input had from row to row, with the nominal fit then, where that fits better than they were `held`, and the
    record of that."""
    none = tuple(HELD for _ in case.library.bound.model.inputs)
    commands = _sought(case, none, held)
    if commands == none:
        return none, held, ()
    found = settled(with_commands(case, commands), held.hypothesis)
    gain = gain_over(case, held, found)
    better = gain > decisions.TAKEN_IN
    told = " and ".join("ever new" if np.isinf(count) else f"{count:g}" for count in commands)
    rule = decided("between_rows", "inputs", gain, decisions.TAKEN_IN, f"{told} commands a row" if better else "held")
    return (commands, found, (rule,)) if better else (none, held, (rule,))


def held_beside(case: Case, commands: tuple[float, ...], best: FittedHypothesis) -> tuple[Decision, bool]:
    """Whether inputs were held after all, beside what explains most: without it a lag or friction passes for inputs that move. The
    record of that is by how much `commands` a row are likelier beside it."""
    hypothesis = best.fit.hypothesis
    found = [fit(logs, hypothesis, rounds=NOMINAL_ROUNDS) for logs in (case, with_commands(case, commands))]
    held, moved = (-np.inf if entry is None else entry.log_posterior for entry in found)
    gain = float(moved - held) if np.isfinite(held) else np.inf
    as_logged = gain <= 0.0
    rule = held_against(
        "between_rows_beside", " + ".join(best.effects), gain, 0.0, "nats", "held" if as_logged else "as before"
    )
    return rule, as_logged


def _sought(case: Case, none: tuple[float, ...], held: Fit) -> tuple[float, ...]:
    """More commands of all inputs while a first fit gains by them; then each input held again, as one that was switched by hand is."""
    commands, best = none, held
    for count in COMMANDS:
        tried = tuple(count for _ in none)
        found = fit(with_commands(case, tried), best.hypothesis, rounds=NOMINAL_ROUNDS)
        if found is None or found.log_posterior <= best.log_posterior:
            break
        commands, best = tried, found
    for place in range(len(none) if commands != none and len(none) > 1 else 0):
        tried = (*commands[:place], HELD, *commands[place + 1 :])
        found = fit(with_commands(case, tried), best.hypothesis, rounds=NOMINAL_ROUNDS)
        if found is not None and found.log_posterior > best.log_posterior:
            commands, best = tried, found
    return commands


def with_commands(case: Case, commands: Sequence[float]) -> Case:
    """The case with the mean of so many commands a row of each input; itself where all were held."""
    if set(commands) <= {HELD}:
        return case
    share = 0.5 * (1.0 - 1.0 / np.array(commands))
    return case.with_flights([_read(flight, share) for flight in case.flights])


def _read(flight: FilteredLog, share: NDArray[np.float64]) -> FilteredLog:
    u = flight.filter_input.u
    return replace(flight, filter_input=replace(flight.filter_input, u=u + share * np.diff(u, axis=0, append=u[-1:])))
