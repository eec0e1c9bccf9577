"""Each part of the firmware replay by itself, on flights whose firmware is known because it was made so."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from records.log import RunLog
from replay.arithmetic import replayed, replayed_in_fixed
from replay.causes.columns import SCALED, TURNED, UNIT, constant_inputs, given_columns, output_lines
from replay.causes.lone import lone_variants
from replay.causes.midair import begins_in_flight
from replay.causes.overflow import output_wrap
from replay.causes.prefilter import fitted_prefilters
from replay.digits import printing
from replay.flight import ReplayedLog, advanced, flight_of, has_replayable_columns, lagged
from replay.follower import OUTPUT_HELD, Follower
from replay.law import ReplayLaw, Setup
from replay.search import explain
from replay.variants import grid_step, steps_in_words, variants
from replay.workshop import Workshop
from tests.law_tables import ce150_table, changed_axis
from tests.replay.firmware_flights import Lossy, Wrapped, flown, rows_of, stale
from verification.host_law import host_law


@cache
def healthy() -> RunLog:
    return flown(host_law(ce150_table()))


def flight(log: RunLog | None = None) -> ReplayedLog:
    return flight_of(healthy() if log is None else log, ce150_table())


def answers(found: ReplayedLog) -> np.ndarray:
    return ReplayLaw(Setup(ce150_table())).outputs(Workshop(found).inputs(Setup(ce150_table())))


def test_the_law_that_flew_is_found_again_to_the_last_bit_in_its_arithmetic() -> None:
    assert has_replayable_columns(healthy(), ce150_table())
    found = replayed(flight(), ce150_table())
    assert (found.arithmetic, found.agreeing) == ("float32", 1.0)
    assert replayed_in_fixed(flight(), ce150_table()).agreeing < 0.5
    told = explain(flight(), ce150_table())
    assert told is not None
    assert told.cause is None


def test_the_digits_of_a_column_are_those_that_it_was_written_with() -> None:
    values = np.random.default_rng(1).uniform(-9.0, 9.0, 50)
    assert printing(np.round(values, 3)).decimals == 3
    wide = values * 10.0 ** np.arange(-25.0, 25.0)  # which no number of decimals tells
    assert printing(np.array([float(f"{value:.4g}") for value in wide])).digits == 4
    assert printing(values.astype(np.float32).astype(float)).is_exact
    assert printing(np.round(values, 3)).half_step(1.0) == pytest.approx(0.0005)
    assert printing(np.arange(5.0)).is_exact  # a handful of round numbers proves nothing


def test_samples_before_and_behind_are_moved_by_whole_rows() -> None:
    values = np.arange(8.0).reshape(4, 2)
    np.testing.assert_array_equal(lagged(values, 1), values[[0, 0, 1, 2]])
    np.testing.assert_array_equal(advanced(values, 1)[:3], values[1:])


def test_an_output_that_was_held_once_is_one_incident_at_its_sample() -> None:
    log = flown(Lossy(host_law(ce150_table()), {700: "output"}.get))
    follower = Follower(Workshop(flight(log)), Setup(ce150_table()))
    trace = follower.follow()
    assert trace.explains
    assert [(entry.kind, entry.first) for entry in trace.incidents] == [(OUTPUT_HELD, 700)]


@pytest.mark.parametrize(("gain", "name"), [(-1.0, TURNED), (1000.0, UNIT), (1.25, SCALED)])
def test_logged_inputs_that_are_a_line_of_the_laws_answers_are_named(gain: float, name: str) -> None:
    own = answers(flight())
    assert name in {found.name for found in output_lines(own, gain * own, ("u_M_V", "u_T_V"))}
    assert list(output_lines(own, own, ("u_M_V", "u_T_V"))) == []


def test_inputs_that_stand_and_columns_that_may_be_taken_for_others_are_variants() -> None:
    log = healthy()
    still = RunLog(
        log.columns, log.sample_period_s, log.loop, log.t_s, np.full_like(log.u, 3.0), log.y, extra=log.extra
    )
    assert len(list(constant_inputs(flight(still), ("u_M_V", "u_T_V")))) == 1
    assert list(constant_inputs(flight(), ("u_M_V", "u_T_V"))) == []
    assert len({(found.name, found.sentence) for found in given_columns(ce150_table())}) == len(
        list(given_columns(ce150_table()))
    )


def test_every_variant_changes_the_setup_and_says_so() -> None:
    found = [*variants(ce150_table(), flight(), ()), *lone_variants(ce150_table())]
    assert len({(entry.name, entry.sentence) for entry in found}) == len(found) > 50
    plain = Setup(ce150_table())
    assert all(entry.change(plain) != plain for entry in found)
    assert grid_step(0.02 * np.round(np.random.default_rng(1).uniform(0, 400, 500))) == pytest.approx(0.02)
    assert steps_in_words(("heat_W", "u_V"), [0.0125, 0.0125]) == "0.0125 W and 0.0125 V"


def test_a_log_cut_out_of_a_flight_is_told_to_begin_in_flight() -> None:
    log = healthy()
    late = rows_of(log, np.arange(300, len(log.t_s)))
    assert begins_in_flight(Workshop(flight()), ce150_table()) is None
    found = begins_in_flight(Workshop(flight(late)), ce150_table())
    assert found is not None
    assert found[1] <= 1e-3  # V


@pytest.mark.parametrize("factor", [1.0, 1.003])
def test_a_log_cut_out_of_a_flight_is_followed_between_rows_that_lack_a_reading(factor: float) -> None:
    """Truth: the table's own law flew, or one whose elevation gains are 0.3 % larger; 5 % of the rows lack an angle."""
    q = tuple(tuple(factor * value for value in row) for row in ce150_table().axes[0].q_V_rad)
    log = healthy() if factor == 1.0 else flown(host_law(changed_axis(ce150_table(), "elevation", q_V_rad=q)))
    late = rows_of(log, np.arange(300, len(log.t_s)))
    y = np.where(np.random.default_rng(3).random(late.y.shape) < 0.025, np.nan, late.y)
    found = begins_in_flight(Workshop(flight(replace(late, y=y))), ce150_table())
    assert (found is not None) == (factor == 1.0)
    assert found is None or found[1] <= 1e-4  # V


def test_a_command_that_wraps_round_shows_the_range_of_its_integer() -> None:
    # Truth: sixteen bits of tenths of a millivolt wrap at 6.5536 V.
    own = np.linspace(0.0, 9.0, 500)
    wrap = output_wrap(own, np.mod(own, 6.5536), 0.0, 0.0)
    assert wrap is not None
    assert (wrap.low, wrap.span) == (0.0, pytest.approx(6.5536))
    assert output_wrap(own, own, 0.0, 0.0) is None


def test_the_time_constant_of_another_reference_filter_is_found() -> None:
    other = ce150_table(prefilter_time_constant_s=0.5)
    found = flight(flown(host_law(other)))
    inputs = Workshop(found).inputs(Setup(ce150_table()))
    first = next(fitted_prefilters(ce150_table(), found, inputs))
    assert "0.5 s and 0.5 s" in first.sentence


def test_a_stale_angle_is_the_simplest_firmware_that_leaves_no_difference() -> None:
    log = flown(Wrapped(host_law(ce150_table()), before=stale([2])))
    told = explain(flight(log), ce150_table())
    assert told is not None
    assert told.cause is not None
    assert "elevation" in (told.sentence or "")
