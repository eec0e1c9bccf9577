"""Inputs between rows: held where a controller held them, in the mean of several commands where rows were left out."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from diagnosis.fit.between_rows import HELD, between_rows, with_commands
from diagnosis.fit.evidence import as_fitted
from diagnosis.hypothesis.case import Case
from diagnosis.result import HeldInputs, Seen
from diagnosis.screening import detected_anew
from records.log import RunLog
from tests.diagnosis.arm import LONG_S, arm_case, arm_log
from tests.diagnosis.nominal import nominal_fit

EVERY = 4  # rows: 40 ms, a twentieth of the fastest sine's period


def sparse(log: RunLog) -> RunLog:
    """One row in EVERY."""
    kept = slice(None, None, EVERY)
    return replace(log, t_s=log.t_s[kept], u=log.u[kept], y=log.y[kept], sample_period_s=EVERY * log.sample_period_s)


def asked(log: RunLog) -> tuple[Case, Case, list[str]]:
    case = arm_case(log)
    commands, _, rules = between_rows(case, nominal_fit(case))
    return case, with_commands(case, commands), [rule.outcome for rule in rules]


def test_commands_that_were_held_stay_as_they_were_logged() -> None:
    case, found, told = asked(sparse(arm_log(seed=81, rows=EVERY)))
    assert found is case
    assert told in ([], ["held"])


def test_the_mean_of_the_commands_that_have_no_row_is_taken() -> None:
    # Truth: each command is held for a row of the log before every fourth is kept, (1 - 1/4) / 2 of the way on in the mean; an angle is
    # moved more by the first of them, so half as many may fit as well.
    log = sparse(arm_log(seed=81, seconds=LONG_S))
    _, found, (told,) = asked(log)
    assert told in ("2 commands a row", "4 commands a row")
    share = 0.5 * (1.0 - 1.0 / float(told[0]))
    u = found.flights[0].filter_input.u[:, 0]
    assert u[:-1] == pytest.approx((1.0 - share) * log.u[:-1, 0] + share * log.u[1:, 0])
    assert u[-1] == log.u[-1, 0]
    assert np.array_equal(found.flights[0].log.u, log.u)  # the log itself is as it was


def test_of_an_input_that_never_stands_still_the_way_is_straight() -> None:
    case = arm_case(arm_log(seed=81))
    u = case.flights[0].filter_input.u
    assert with_commands(case, (np.inf,)).flights[0].filter_input.u[:-1] == pytest.approx(0.5 * (u[:-1] + u[1:]))
    assert with_commands(case, (HELD,)) is case


def test_inputs_that_seemed_to_move_beside_another_plant_are_held_again() -> None:
    # Truth: commands held from row to row, which had been taken for two a row when the logs were first read.
    case = arm_case(sparse(arm_log(seed=81, rows=EVERY)))
    moving, plain = with_commands(case, (2.0,)), nominal_fit(case)
    unseen: Any = None  # no matter what showed beside it
    seen = Seen(
        moving, None, as_fitted(case, plain), unseen, (), None, unseen, held=HeldInputs(case, None, plain, 20.0)
    )
    anew = detected_anew(moving, seen, None)
    assert np.array_equal(anew.case.flights[0].filter_input.u, case.flights[0].filter_input.u)
    assert anew.held is None
