"""Inputs at their limits, beyond them or cut off within them are told with level and share; steps are not."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from logcheck.inputs import input_findings
from logcheck.integrity import as_read, as_sent
from tests.logcheck.flight import clean, examined, kinds, with_column


def test_saturation_and_inputs_beyond_the_limits_are_shares_of_the_rows() -> None:
    log = clean()
    u = log.u.copy()
    u[:500, 1], u[500:600, 0] = 10.0, 11.0
    found = examined(replace(log, u=u))
    assert kinds(found) == {"saturated", "beyond_limits"}
    # Truth: 500 of 2001 rows.
    (saturated,) = (entry for entry in found.findings if entry.kind == "saturated" and entry.column == "u_T_V")
    assert "25.0% of the rows at 10 V" in saturated.sentence


@pytest.mark.parametrize("limits", [(-4.0, 10.0), (-4.0, np.inf)])
def test_an_input_beyond_a_limit_is_told_whether_or_not_there_is_another(limits: tuple[float, float]) -> None:
    log = clean()
    u = log.u.copy()
    u[500:600, 1] = -5.0
    told = {entry.finding.kind for entry in input_findings(replace(log, u=u), "log", {"u_T_V": limits})}
    assert told == {"saturated", "beyond_limits"}


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


@pytest.mark.parametrize(("column", "share"), [("u_M_V", 0.001), ("u_M_V", 0.05), ("u_T_V", 0.015)])
def test_a_command_of_zero_now_and_then_is_not_known_and_taken_as_between_its_neighbours(
    column: str, share: float
) -> None:
    """Truth: the flight of the compiled law, whose command was not written down in random rows; beside zero nobody sees it."""
    log, place = clean(), clean().columns.inputs.index(column)
    lost = np.random.default_rng(3).random(len(log.t_s)) < share
    far = np.abs(log.column(column)) > 0.5
    found = examined(with_column(log, column, np.where(lost, 0.0, log.column(column))))
    assert kinds(found) == {"zero_command"}
    (looked,) = found.logs
    assert looked.unknown[lost & far, place].all()
    assert not looked.unknown[~lost].any()
    assert not looked.unread.any()
    assert not looked.excluded.any()
    taken = as_read(with_column(log, column, np.where(lost, 0.0, log.column(column))), looked)
    assert np.abs(taken.u - log.u).max() < 1.0  # of up to 8 V that zero is off
    assert np.array_equal(np.isnan(as_sent(log, looked).u), looked.unknown)


def test_an_input_that_is_switched_off_passes_zero_or_is_limited_there_is_what_was_sent() -> None:
    log, rows = clean(), np.arange(2001)
    noise = np.random.default_rng(5).normal(0.0, 1.0, 2001)
    stairs = np.where(rows % 97 == 50, 0.0, 1.0 + rows // 500)  # no switch: five levels, and zero in single rows
    assert "zero_command" in kinds(examined(with_column(log, "u_T_V", stairs)))
    sent = {
        "on and off": np.where(rows % 97 == 50, 0.0, 5.0),
        "pulses": np.where(rows % 7 == 0, 0.0, 3.0 + 0.01 * noise),
        "rests": np.where(rows % 100 < 5, 0.0, 3.0 + 0.01 * noise),
        "through zero": np.where(rows % 200 == 100, 0.0, np.where(rows % 200 < 100, 2.0, -2.0) + 0.01 * noise),
        "limited": np.maximum(0.3 + 0.3 * noise, 0.0),
    }
    for values in sent.values():
        assert "zero_command" not in kinds(examined(with_column(log, "u_T_V", values)))
