"""An axis whose sign turns within a log is refused with its column and time; a leap to anywhere else, or of a reference too, is none."""

from dataclasses import replace

import numpy as np
import pytest

from logcheck.facts import plant_facts
from logcheck.integrity import demand, examine
from logcheck.leaps.turned import turned_findings
from records.errors import BadInput
from records.log import RunLog
from tests.logcheck.test_parts import PLANT, STEP_RAD, log_of, rounded

FACTS = plant_facts(PLANT)


def turned(log: RunLog, *rows: int, column: int = 1) -> RunLog:
    """The log with an output's sign turned from each of the rows on."""
    y = log.y.copy()
    for row in rows:
        y[row:, column] *= -1.0
    return replace(log, y=y)


def times_s(log: RunLog) -> list[float]:
    return [found.finding.start_s for found in turned_findings(log, "a", PLANT, FACTS)]


def at_rest(log: RunLog) -> RunLog:
    """Both axes stand between the rows 900 and 1100, and hunt there by an encoder step."""
    y = log.y.copy()
    y[900:1100] = y[900] + STEP_RAD * (np.arange(200)[:, None] // 7 % 2)
    return replace(log, y=y)


@pytest.mark.parametrize(
    "row", [700, 1000, 1300, int(np.argmax(log_of().y[:, 1])), int(np.argmin(log_of().y[:, 1])) + 2]
)
def test_a_sign_that_turns_is_refused_with_its_column_and_time(row: int) -> None:
    with pytest.raises(BadInput, match=rf"the sign of phi_rad turns at {0.01 * row:g} s.*turn the sign of phi_rad"):
        demand(examine([turned(log_of(), row)], PLANT, names=["a"]))


def test_it_is_found_at_rest_and_there_and_back_and_between_unread_rows() -> None:
    assert times_s(turned(at_rest(log_of()), 1000)) == pytest.approx([10.0])
    (found,) = turned_findings(turned(log_of(), 700, 730), "a", PLANT, FACTS)
    assert "turns at 7 s, 7.3 s" in found.finding.sentence
    unread = turned(log_of(), 1000)
    unread.y[[700, 995, 1004], 1] = np.nan
    assert times_s(unread) == pytest.approx([10.0])


def fast() -> RunLog:
    """The azimuth swings through zero at 1 rad/s, seven encoder steps from row to row."""
    y = log_of().y.copy()
    y[:, 1] = rounded(0.35 * np.sin(3.0 * log_of().t_s))
    return replace(log_of(), y=y)


def test_it_is_found_where_the_axis_passes_zero_and_nothing_leaps() -> None:
    rows = np.flatnonzero(np.diff(np.sign(fast().y[:, 1])))
    for row in rows[[4, 7, 12]] + 1:
        assert times_s(turned(fast(), row)) == pytest.approx([0.01 * row], abs=0.011)
    assert times_s(fast()) == []


def test_an_axis_that_a_stop_at_zero_throws_back_has_not_turned_its_sign() -> None:
    """Truth: a plant without stops in its file, and nothing is read below zero."""
    thrown = replace(fast(), y=np.abs(fast().y))
    assert list(turned_findings(thrown, "a", PLANT, replace(FACTS, stops={}))) == []


def test_a_leap_elsewhere_or_a_turn_about_or_a_glitch_is_no_turned_sign() -> None:
    assert times_s(log_of()) == []
    slipped = log_of()
    slipped.y[1000:, 1] -= 1.5 * slipped.y[1000, 1]
    thrown_back = log_of()  # from y to -y, where the axis goes on in its own direction
    thrown_back.y[1000:, 1] -= 2.0 * thrown_back.y[1000, 1]
    glitch = log_of()
    glitch.y[1000, 1] *= -1.0
    for log in (slipped, thrown_back, glitch):
        assert times_s(log) == []


def test_another_flight_that_begins_where_the_mirror_is_is_none_where_references_or_inputs_leap() -> None:
    log = turned(log_of(), 1000)
    reference = np.where(np.arange(2000) < 1000, 0.3, -0.3)
    assert times_s(replace(log, extra={"phi_ref_rad": reference})) == []
    resting, u = turned(at_rest(log_of()), 1000), log.u.copy()
    u[1000:, 1] -= 2.0
    assert times_s(replace(resting, u=u)) == []


def test_an_axis_that_missing_rows_carry_to_its_mirror_has_not_turned_its_sign() -> None:
    log = log_of()
    y = log.y.copy()
    y[:, 1] = rounded(0.3 * np.sin(np.linspace(-1.2, 1.2, 2000)))
    kept = np.r_[:500, 1500:2000]
    assert times_s(replace(log, t_s=log.t_s[kept], u=log.u[kept], y=y[kept])) == []
