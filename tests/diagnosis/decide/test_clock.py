"""A log's clock that runs fast or slow is told with its size; a rig that lacks something, or is known too little, is none."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis import decisions
from diagnosis.decide.clock import clock_in_doubt, on_clock
from diagnosis.fit.nominal import plain_fit
from diagnosis.hypothesis.case import make_case
from diagnosis.library.effect_library import EffectLibrary, effect_library
from records.log import RunLog
from records.reasons import DOUBTS, Note
from tests.diagnosis.arm import arm, arm_log
from tests.diagnosis.conftest import RUB, SECONDS, SPRING, Fly
from tests.soak import SOAK


def counted(log: RunLog, rate: float) -> RunLog:
    """The log as a clock counts it that runs so many times as fast."""
    return replace(log, t_s=log.t_s * rate)


def told(library: EffectLibrary, log: RunLog) -> tuple[Note, ...]:
    case = make_case(library, [log])
    return clock_in_doubt(case, plain_fit(case))


@pytest.mark.parametrize(
    ("rate", "way"), [(0.9, "slow"), *([(1.05, "fast"), (1.02, "fast"), (1.1, "fast")] if SOAK else [])]
)
def test_a_clock_that_runs_fast_or_slow_is_told_with_its_size(
    stateless: EffectLibrary, fly: Fly, rate: float, way: str
) -> None:
    (note,) = told(stateless, counted(fly(33, seconds=2.0 * SECONDS if SOAK else SECONDS), rate))
    assert note.kind in DOUBTS
    assert note.numbers["clock_rate"] == pytest.approx(rate, abs=0.006)
    assert note.numbers["gain_nats"] > decisions.LOGS_DOUBTED
    assert f"runs {100 * abs(note.numbers['clock_rate'] - 1.0):.2g} % {way}" in str(note.said)


@pytest.mark.parametrize("effects", [None, *([SPRING, {"azimuth.coulomb": {"b": 0.004}}] if SOAK else [SPRING])])
def test_a_rig_as_stated_or_one_that_lacks_something_has_no_other_clock(
    stateless: EffectLibrary, fly: Fly, effects: dict[str, dict[str, float]] | None
) -> None:
    assert told(stateless, fly(31, effects, SECONDS)) == ()


def test_an_arm_that_rubs_or_of_which_rates_are_hardly_known_has_no_other_clock() -> None:
    """Truth: dry friction that the file lacks; and times 5 % off of an arm whose numbers are known by magnitude alone."""
    assert told(effect_library(arm()), arm_log(RUB, seed=32)) == ()
    known_little = replace(arm(), sd=np.where(arm().sd > 0.0, np.abs(arm().p), 0.0))
    assert told(effect_library(known_little), counted(arm_log(seed=32), 1.05)) == ()


def test_a_clock_that_is_a_quarter_off_is_none(stateless: EffectLibrary, fly: Fly) -> None:
    assert told(stateless, counted(fly(31, seconds=SECONDS), 1.25)) == ()


def test_times_on_another_clock_are_so_many_times_shorter(stateless: EffectLibrary, fly: Fly) -> None:
    case = make_case(stateless, [counted(fly(31, seconds=2.0), 1.25)])
    (was,), (found,) = case.flights, on_clock(case, 1.25).flights
    np.testing.assert_allclose(np.diff(found.filter_input.t_s), 0.01)
    assert found.step_s == pytest.approx(0.01)
    np.testing.assert_array_equal(found.filter_input.y, was.filter_input.y)
