"""What an input did between two rows of a log: held as it was logged, or went straight to the next; whichever the logs find likelier.

A controller that wrote the log holds its command to the next row. A log with fewer rows than commands, or of an input that somebody else
sampled, shows the ends of a way: to hold it puts it half a row late, which looks like a delay.
"""

from dataclasses import replace

import numpy as np

from diagnosis import decisions
from diagnosis.decisions import held_against
from diagnosis.fit.gauss_newton import likelihood_of
from diagnosis.hypothesis.case import Case, FilteredLog
from diagnosis.hypothesis.hypothesis import Hypothesis
from records.reasons import Decision


def between_rows(case: Case, hypothesis: Hypothesis) -> tuple[Case, tuple[Decision, ...]]:
    """The case with each log's inputs straight between rows where that makes it likelier under a hypothesis by WORTH_STRAIGHT nats, and a
    record for each log in which the two differ."""
    flights, rules = [], []
    for flight in case.flights:
        other = _straight(flight)
        gain = likelihood_of(case.with_flights([other]), hypothesis) - likelihood_of(
            case.with_flights([flight]), hypothesis
        )
        better = gain > decisions.WORTH_STRAIGHT
        flights.append(other if better else flight)
        outcome = "straight" if better else "held"
        rules.append(
            held_against("between_rows", f"log {flight.number + 1}", gain, decisions.WORTH_STRAIGHT, "nats", outcome)
        )
    straight = any(rule.outcome == "straight" for rule in rules)
    return (case.with_flights(flights) if straight else case), tuple(rules) if straight else ()


def _straight(flight: FilteredLog) -> FilteredLog:
    """The log with the mean of each input and the next for what was held: a straight way to second order in the step."""
    u = flight.filter_input.u
    mean = 0.5 * (u + np.concatenate([u[1:], u[-1:]]))
    return replace(flight, filter_input=replace(flight.filter_input, u=mean))
