"""Columns that are not what they are called: one with its sign turned, in all rows or in some, or two in each other's place. Then the plant
is not at fault."""

from collections.abc import Callable, Sequence

import numpy as np

from diagnosis import decisions
from diagnosis.decide.column_wiring import ColumnWiring, rewired, turned_signs, wirings
from diagnosis.decide.columns import (
    fitted_or_none,
    is_as_good,
    is_refused,
    is_strained,
    is_told,
    looked_at,
)
from diagnosis.decide.turned import in_words, turned_within
from diagnosis.fit.likelihood import likelihood_of
from diagnosis.fit.linear_problem import Fit
from diagnosis.fit.nominal import gain_over
from diagnosis.fit.process_noise import with_process_noise
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import nominal_hypothesis
from jobs.thread_map import thread_map
from records.errors import BadInput
from records.reasons import Note

Read = tuple[ColumnWiring, Fit]  # a wiring of the columns, and the plant's fit to the logs that are read so
LEAVE_OUT = ", or leave these rows out: `twinlaw import --from`, `--until`"


def demand_wiring(
    case: Case,
    nominal: Fit,
    fitted: Callable[[Case], Fit],
    where: str,
    names: Sequence[str],
    part: Case | None = None,
) -> tuple[Note, ...]:
    """What is to be known of the columns: that one may be another, or that these logs do not tell the sign of an input.

    Raises BadInput where turning one column's sign, in all rows or in some, or swapping two columns, lets the plant as stated follow the
    logs. `nominal` is the plant's fit to the logs as they are; `fitted` makes such a fit, and is asked only where that one is strained.
    `where` says which logs they are, `names` what each is called; `part` are the rows by which what holds in all is asked, the first of
    each log if None.
    """
    found = likelier_wiring(case, fitted, part) if is_strained(case, nominal) else None
    if found is None:
        return _blind_signs(case, nominal)
    alike, gain = found
    rows = [in_words(case, wiring, names) for wiring in alike]
    what, remedy = (
        ", or ".join(said + there for said, there in zip(some, rows, strict=True))
        for some in ([wiring.what for wiring in alike], [wiring.remedy for wiring in alike])
    )
    got = f"{what}: read so, the plant follows them {gain:.0f} nats better"
    if not is_refused(gain):
        return (Note("columns_doubted", "columns", {"gain_nats": gain}, f"perhaps {got}"),)
    remedy += LEAVE_OUT if any(rows) else ""
    raise BadInput("columns", where, got, "columns that are what they are called", remedy)


def likelier_wiring(
    case: Case, fitted: Callable[[Case], Fit], part: Case | None = None
) -> tuple[list[ColumnWiring], float] | None:
    """Another reading of the columns under which the plant is likelier, as stated and as fitted, before those that the logs cannot tell
    from it, of a plant that is the same both ways round either sign; and what it gains in nats. None where there is none.

    What holds in all rows is asked of a `part`, the first if None, as every rule on columns is: of a sign that turns, all rows tell.
    """
    within = turned_within(case)
    found = _likelier(case, (*wirings(case), *within), fitted) if within else None
    if found is not None and found[0][0].rows is not None:
        return found
    return _likelier(looked_at(case) if part is None else part, tuple(wirings(case)), fitted)


def _likelier(
    asked: Case, readings: Sequence[ColumnWiring], fitted: Callable[[Case], Fit]
) -> tuple[list[ColumnWiring], float] | None:
    """The same, of these readings and all rows of the case."""
    least = as_stated(asked)
    slips = [(wiring, read) for wiring in readings if as_stated(read := rewired(asked, wiring)) > least]
    usual = fitted_or_none(asked, fitted) if slips else None
    fits = thread_map(lambda slip: fitted_or_none(slip[1], fitted), slips)
    found = [(wiring, fit) for (wiring, _), fit in zip(slips, fits, strict=True) if fit is not None]
    if usual is None or not found:
        return None
    alike = _as_good_as_the_best(found)
    best, fit = alike[0]
    gain = gain_over(asked, usual, fit) - best.cost
    if not (is_told(gain) and is_told(_gain_alone(asked, best, fitted, gain))):
        return None
    return [wiring for wiring, _ in alike], gain


def _as_good_as_the_best(found: Sequence[Read]) -> list[Read]:
    """The best reading, and then those that the logs cannot tell from it; what holds in all rows goes before what holds in some."""
    most = max(map(_worth, found))
    alike = [read for read in found if is_as_good(_worth(read), most)]
    whole = [read for read in alike if read[0].rows is None]
    return sorted(whole or alike, key=_worth, reverse=True)


def _worth(read: Read) -> float:
    wiring, fit = read
    return fit.log_posterior - wiring.cost


def _gain_alone(case: Case, wiring: ColumnWiring, fitted: Callable[[Case], Fit], together: float) -> float:
    """What another reading of the columns, which gains so many nats of all logs `together`, gains of each by itself: a slip is one in
    every log, but a start that the model does not foresee looks like one where calmer logs keep the noise that is shared too small."""
    if len(case.flights) == 1:
        return together
    alone = [case.with_flights([flight]) for flight in case.flights]
    usual = thread_map(lambda own: fitted_or_none(own, fitted), alone)
    read = thread_map(lambda own: fitted_or_none(rewired(own, wiring), fitted), alone)
    found = zip(alone, usual, read, strict=True)
    gains = (gain_over(own, one, other) for own, one, other in found if one is not None and other is not None)
    return sum(gains) - wiring.cost


def _blind_signs(case: Case, nominal: Fit) -> tuple[Note, ...]:
    """That the plant answers alike to either sign of an input that moves it."""
    inputs = [str(u) for u in case.library.bound.model.inputs]
    blind = [
        name
        for place, (name, wiring) in enumerate(zip(inputs, turned_signs(case), strict=False))
        if any(np.any(flight.filter_input.u[:, place]) for flight in case.flights)
        and not is_told(abs(likelihood_of(rewired(case, wiring), nominal.hypothesis) - nominal.log_likelihood))
    ]
    if not blind:
        return ()
    names = " and ".join(blind)
    said = f"the sign of {names} cannot be seen in these logs: the plant as stated answers alike to either"
    return (Note("sign_unseen", names, {}, said),)


def as_stated(case: Case) -> float:
    """The log likelihood of the plant as it is stated, with the white noise that it then needs: what cannot follow the logs better so is no
    reading that anybody meant."""
    return likelihood_of(case, with_process_noise(case, nominal_hypothesis(case, float(decisions.FIRST_PROCESS_NOISE))))
