"""Inputs between rows: held where a controller held them, straight where rows of a smooth way were left out."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis.fit.between_rows import between_rows
from diagnosis.fit.nominal import nominal_fit
from diagnosis.hypothesis.case import Case
from records.log import RunLog
from tests.diagnosis.arm import LONG_S, arm_case, arm_log

EVERY = 4  # rows: 40 ms, a twentieth of the fastest sine's period


def sparse(log: RunLog) -> RunLog:
    """One row in EVERY."""
    kept = slice(None, None, EVERY)
    return replace(log, t_s=log.t_s[kept], u=log.u[kept], y=log.y[kept], sample_period_s=EVERY * log.sample_period_s)


def asked(log: RunLog) -> tuple[Case, Case, list[str]]:
    case = arm_case(log)
    found, _, rules = between_rows(case, nominal_fit(case))
    return case, found, [rule.outcome for rule in rules]


def test_commands_that_were_held_stay_as_they_were_logged() -> None:
    case, found, told = asked(sparse(arm_log(seed=81, rows=EVERY)))
    assert found is case
    assert told in ([], ["held"])


def test_the_ends_of_a_smooth_way_are_joined() -> None:
    log = sparse(arm_log(seed=81, seconds=LONG_S))
    _, found, told = asked(log)
    assert told == ["straight"]
    u = found.flights[0].filter_input.u[:, 0]
    assert u[:-1] == pytest.approx(0.5 * (log.u[:-1, 0] + log.u[1:, 0]))
    assert u[-1] == log.u[-1, 0]
    assert np.array_equal(found.flights[0].log.u, log.u)  # the log itself is as it was
