"""Inputs at their limits, beyond them or cut off within them are told with level and share; steps are not."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from tests.logcheck.flight import clean, examined, kinds, with_column


def test_saturation_and_inputs_beyond_the_limits_are_shares_of_the_rows() -> None:
    log = clean()
    u = log.u.copy()
    u[:500, 1], u[500:600, 0] = 10.0, 11.0
    found = examined(replace(log, u=u))
    assert kinds(found) == {"saturated", "beyond_limits"}
    assert found.logs[0].saturation["u_T_V"].upper == pytest.approx(500 / 2001)


def test_an_input_at_its_limit_in_one_stretch_is_told_from_when_to_when() -> None:
    log = clean()
    u = log.u.copy()
    u[500:600, 0] = 0.0
    (found,) = examined(replace(log, u=u)).findings
    assert found.sentence == "u_M_V is at its limits: 5.0% of the rows at 0 V, all from 5 s to 5.99 s"
    u[700:800, 0] = 0.0
    (found,) = examined(replace(log, u=u)).findings
    assert found.sentence == "u_M_V is at its limits: 10.0% of the rows at 0 V"


@pytest.mark.parametrize(("cut", "how"), [(np.minimum, "exceeds"), (np.maximum, "falls below")])
def test_an_input_that_is_cut_off_within_the_plants_limits_is_noted(cut: Callable[..., np.ndarray], how: str) -> None:
    log = clean()
    limit = float(np.median(log.u[:, 0]))
    (found,) = examined(with_column(log, "u_M_V", cut(log.u[:, 0], limit))).findings
    assert (found.kind, found.column, found.severity) == ("clipped", "u_M_V", "note")
    assert f"u_M_V never {how} {limit:.5g} V, where 50.0% of its rows stand" in found.sentence


def test_an_input_of_steps_is_not_called_cut_off() -> None:
    log = clean()
    steps = np.where(np.arange(2001) // 100 % 2 == 1, 0.5, -0.5)
    once = np.where(np.arange(2001) < 400, log.u[:, 1].max() + 0.1, log.u[:, 1])
    for u_T in (steps, once):
        assert "clipped" not in kinds(examined(with_column(log, "u_T_V", u_T)))
