"""The prediction beside a rig: exact where the twin is, off where the rig has more than the twin, the same as over the whole log."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis.hypothesis.case import make_case
from diagnosis.hypothesis.hypothesis import nominal_hypothesis
from diagnosis.library.effect_library import effect_library
from diagnosis.validate.ahead import EVERY_S, LIVE_PROCESS_NOISE, Ahead, Lookahead
from diagnosis.validate.prediction import FreeRun, predictions
from records.log import RunLog
from records.logs.live import LiveRow
from sim.added_effects import with_effects
from sim.bind import BoundPlant
from tests.diagnosis.conftest import Fly
from tests.soak import SOAK

STEP_RAD = 1.534e-3
SECONDS = 12.0 if SOAK else 10.0
SPRING = {"azimuth.cable_spring": {"k": 0.004, "angle_0": 0.0, "h": 0.0}}


def rows_of(log: RunLog) -> list[LiveRow]:
    return [
        LiveRow(t_s, tuple(u), tuple(y), (0.0, 0.0))
        for t_s, u, y in zip(log.t_s.tolist(), log.u.tolist(), log.y.tolist(), strict=True)
    ]


def fed(lookahead: Lookahead, rows: list[LiveRow], batch: int = 5) -> list[Ahead]:
    return [entry for k in range(0, len(rows), batch) for entry in lookahead.take(rows[k : k + batch])]


def errors(found: list[Ahead]) -> np.ndarray:
    return np.array([np.subtract(entry.y, entry.predicted) for entry in found])


@pytest.fixture(scope="module")
def low_noise(fly: Fly, plant: BoundPlant) -> list[LiveRow]:
    """A rig with the twin's own coefficients and no air."""
    names = [str(symbol) for symbol in plant.model.parameter_symbols]
    return rows_of(fly(3, seconds=SECONDS, air=False, factors=dict.fromkeys(names, 1.0)))


@pytest.fixture(scope="module")
def followed(plant: BoundPlant, low_noise: list[LiveRow]) -> tuple[Lookahead, list[Ahead]]:
    """A look ahead that has followed that rig, and what it predicted."""
    lookahead = Lookahead(plant)
    return lookahead, fed(lookahead, low_noise)


def test_a_twin_that_is_exact_leaves_what_the_encoder_leaves(followed: tuple[Lookahead, list[Ahead]]) -> None:
    # A state estimated from readings of one step's resolution by a filter that expects some air, run on for a second of a lively
    # flight: rms within one and a half steps, nothing beyond six times that.
    lookahead, found = followed
    assert np.abs(errors(found)).max() < 9 * STEP_RAD
    assert max(gap for gap in lookahead.gap if gap is not None) < 1.5 * STEP_RAD


def test_it_begins_after_three_seconds_and_goes_on_twenty_times_a_second(
    followed: tuple[Lookahead, list[Ahead]],
) -> None:
    times = np.array([entry.t_s for entry in followed[1]])
    assert times[0] == pytest.approx(3.0, abs=0.011)
    assert np.allclose(np.diff(times), EVERY_S)


def test_a_row_that_begins_another_log_is_not_predicted_from_what_was_before(
    plant: BoundPlant, low_noise: list[LiveRow]
) -> None:
    broken = [replace(row, t_s=row.t_s + 5.0 * (row.t_s >= 6.0), begins=row.t_s == 6.0) for row in low_noise]
    times = np.array([entry.t_s for entry in fed(Lookahead(plant), broken)])
    assert times[times > 6.0][0] == pytest.approx(14.0, abs=0.011)


def test_what_the_rig_has_and_the_twin_lacks_shows_as_a_gap(plant: BoundPlant, fly: Fly) -> None:
    # A spring of 4 mN m/rad is some ten times what the encoder leaves; the twin that states it predicts as well as an exact one does.
    names = [str(symbol) for symbol in plant.model.parameter_symbols]
    rows = rows_of(fly(3, SPRING, seconds=SECONDS - 2.0, air=False, factors=dict.fromkeys(names, 1.0)))
    lacking, stating = Lookahead(plant), Lookahead(with_effects(plant, SPRING))
    fed(lacking, rows)
    fed(stating, rows)
    assert lacking.gap[1] is not None
    assert stating.gap[1] is not None
    assert stating.gap[1] < 1.5 * STEP_RAD
    assert lacking.gap[1] > 10 * stating.gap[1]


def test_it_is_the_prediction_of_the_whole_log(plant: BoundPlant, fly: Fly) -> None:
    # It remembers five seconds, the diagnosis the whole log: the states differ by less than an encoder step's worth.
    log = fly(1, seconds=8.0)
    rows = rows_of(log)
    found = fed(Lookahead(plant), rows)
    places = [round(entry.t_s / 0.01) for entry in found]
    case = make_case(effect_library(plant), [log], stated=plant)
    spans = [FreeRun(place - 100, place, place + 1) for place in places]
    whole = predictions(case, case.flights[0], nominal_hypothesis(case, LIVE_PROCESS_NOISE), spans=spans)[places]
    assert np.abs(whole - [entry.predicted for entry in found]).max() < 0.5 * STEP_RAD


def test_rows_one_by_one_and_in_batches_give_the_same(plant: BoundPlant, low_noise: list[LiveRow]) -> None:
    one, many = (np.array([e.predicted for e in fed(Lookahead(plant), low_noise[:500], batch)]) for batch in (1, 25))
    assert one.shape == many.shape
    assert np.abs(one - many).max() < 0.1 * STEP_RAD


def test_after_a_leap_it_begins_anew(plant: BoundPlant, low_noise: list[LiveRow]) -> None:
    lookahead = Lookahead(plant)
    fed(lookahead, low_noise[:400])
    lookahead.forget()
    assert lookahead.gap == (None, None)
    assert not fed(lookahead, low_noise[:290])
    assert fed(lookahead, low_noise[290:310])


def test_a_reading_that_is_missing_leaves_no_gap_of_its_own(plant: BoundPlant, low_noise: list[LiveRow]) -> None:
    blind = [LiveRow(row.t_s, row.u, (row.y[0], float("nan")), row.reference) for row in low_noise[:500]]
    lookahead = Lookahead(plant)
    fed(lookahead, blind)
    assert lookahead.gap[0] is not None
    assert lookahead.gap[1] is None


@pytest.mark.parametrize("unread", [(0,), *([(0, 1)] if SOAK else [])])
def test_behind_a_stretch_without_readings_an_output_is_predicted_anew(
    plant: BoundPlant, low_noise: list[LiveRow], unread: tuple[int, ...]
) -> None:
    """Truth: nothing is read of the outputs from 4 s to 5 s, of two others rows now and then; a prediction needs 2 s of readings, and
    looks ahead by one."""
    lost = {place: 4.0 <= row.t_s < 5.0 or place % 40 in (0, 1) for place, row in enumerate(low_noise)}
    rows = [
        replace(row, y=tuple(np.nan if lost[place] and k in unread else value for k, value in enumerate(row.y)))
        for place, row in enumerate(low_noise)
    ]
    lookahead = Lookahead(plant)
    found = fed(lookahead, rows)
    times = np.array([entry.t_s for entry in found])
    told = np.isfinite([entry.predicted for entry in found])
    for column in range(2):
        blind = (times > 5.0) & (times < 7.99) if column in unread else times < 0.0
        assert not told[blind, column].any()
        assert told[~blind & ((times < 4.0) | (times > 8.01)), column].all()
    assert np.nanmax(np.abs(errors(found)[:, list(unread)])) < 9 * STEP_RAD
