"""Logs that were tampered with, or that are not what they seem: the replay names what was done to them, and nothing else."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from records.log import RunLog
from records.table import ControllerTable
from replay.firmware import FirmwareReplay, replay_firmware
from tests.law_tables import ce150_table, changed_axis
from tests.replay.firmware_flights import Wrapped, default_flight, edited_law, flown, own, rows_of, stale
from tests.soak import sampled
from verification.host_law import host_law

TABLE = ce150_table()
TIGHT = changed_axis(changed_axis(TABLE, "elevation", u_min_V=4.8, u_max_V=6.2), "azimuth", u_min_V=1.6, u_max_V=2.3)


def _told(log: RunLog, table: ControllerTable = TABLE) -> FirmwareReplay:
    return replay_firmware(log, table)


def _references(change: Callable[[dict[str, np.ndarray]], dict[str, np.ndarray]]) -> RunLog:
    log = own()
    names = ("psi_ref_rad", "phi_ref_rad")
    return replace(log, extra={**log.extra, **change({name: log.extra[name] for name in names})})


def _moved(samples: int) -> RunLog:
    """The references logged so many samples late, or early where they are less than none."""
    rows = np.clip(np.arange(len(own().t_s)) - samples, 0, None)
    return _references(lambda own: {name: values[np.minimum(rows, len(values) - 1)] for name, values in own.items()})


def _exchanged(own: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    return {"psi_ref_rad": own["phi_ref_rad"], "phi_ref_rad": own["psi_ref_rad"]}


TAMPERED = [
    (lambda log: replace(log, u=log.u[:, ::-1].copy()), "outputs_exchanged", "two outputs"),
    (lambda log: replace(log, y=log.y[:, ::-1].copy()), "inputs_exchanged", "two angles"),
    (
        lambda log: replace(log, y=log.y[:, ::-1] * [1.0, -1.0]),
        "inputs_exchanged + input_sign",
        "and the elevation's with",
    ),
    (lambda log: replace(log, u=np.concatenate([log.u[:1]] * 3 + [log.u[:-3]])), "late_output", "3 samples late"),
    (lambda log: replace(log, u=np.concatenate([log.u[3:]] + [log.u[-1:]] * 3)), "early_output", "3 samples before"),
    (lambda log: replace(log, u=np.stack([log.u[:, 0], np.roll(log.u[:, 1], 2)], 1)), "late_output", "u_T_V 2 samples"),
    (lambda log: replace(log, u=log.u * [1.0, -1.0]), "output_sign", "u_T_V with its sign turned"),
    (lambda log: replace(log, y=log.y * [1.0, -1.0]), "input_sign", "azimuth angle"),
    (lambda log: replace(log, u=log.u * 1000.0), "output_unit", "1000 times"),
    (lambda log: replace(log, u=log.u * [0.9, 1.0]), "output_scaled", "0.9 times"),
    (lambda log: replace(log, u=log.u[:, ::-1] * 1000.0), "outputs_exchanged + output_unit", "exchanges"),
    (lambda log: replace(log, u=log.u * [1.0, 0.0]), "input_constant", "u_T_V stands at 0 V"),
    (lambda log: replace(log, u=0.0 * log.u + 5.0), "input_constant", "u_M_V stands at 5 V and u_T_V"),
]


@pytest.mark.parametrize(("tamper", "cause", "words"), sampled(TAMPERED, keep=TAMPERED[2:11:2]))
def test_columns_that_are_exchanged_turned_moved_scaled_or_dead_are_named(
    tamper: Callable[[RunLog], RunLog], cause: str, words: str
) -> None:
    found = _told(tamper(own()))
    assert (found.bit_exact, found.cause, found.incidents) == (False, cause, ())
    assert words in (found.sentence or "")


MOVED = [
    (1, "reference_logged_late", "one sample too late"),
    (50, "reference_logged_late", "50 samples too late"),
    (-1, "stale_reference", "one sample old"),
    (-7, "stale_reference", "7 samples old"),
]


@pytest.mark.parametrize(("samples", "cause", "words"), sampled(MOVED, keep=MOVED[1:3]))
def test_references_logged_late_or_early_are_named_with_their_age(samples: int, cause: str, words: str) -> None:
    found = _told(_moved(samples))
    assert (found.bit_exact, found.cause, found.incidents) == (False, cause, ())
    assert words in (found.sentence or "")


AGED = [
    (1, (0, 1), "both angles that the log holds one sample"),
    (3, (0,), "the elevation that the log holds 3 samples"),
]


@pytest.mark.parametrize(("samples", "axes", "words"), sampled(AGED, keep=AGED[1:]))
def test_angles_logged_late_are_named_with_their_age(samples: int, axes: tuple[int, ...], words: str) -> None:
    log = own()
    y = log.y.copy()
    y[samples:, axes] = log.y[:-samples, axes]
    y[:samples, axes] = log.y[0, axes]
    found = _told(replace(log, y=y))
    assert (found.bit_exact, found.cause, found.incidents) == (False, "angle_logged_late", ())
    assert words in (found.sentence or "")


def test_a_log_whose_references_were_rounded_is_compared_as_far_as_they_tell() -> None:
    log = default_flight()
    found = _told(replace(log, extra={name: np.round(values, 3) for name, values in log.extra.items()}))
    assert found.cause == "log_rounding"
    assert "3 decimals" in (found.sentence or "")
    assert "print nine digits" in (found.sentence or "")


def test_references_that_are_exchanged_are_named() -> None:
    assert _told(_references(_exchanged)).cause == "inputs_exchanged"


def test_angles_of_different_age_are_named_with_each() -> None:
    found = _told(flown(Wrapped(Wrapped(host_law(TABLE), stale((2,))), stale((3,), 2))))
    assert found.cause == "stale_sample"
    assert "elevation measured one sample and the azimuth measured 2 samples before" in (found.sentence or "")


def _one_place_up(axis: str, key: str) -> ControllerTable:
    numbers = getattr(TABLE.axis(axis), key)
    is_row = not isinstance(numbers[0], tuple)
    first = float(np.nextafter(np.float32(numbers[0] if is_row else numbers[1][0]), np.float32(np.inf)))
    changed = (first, *numbers[1:]) if is_row else (numbers[0], (first, *numbers[1][1:]), *numbers[2:])
    return changed_axis(TABLE, axis, **{key: changed})


OFF = [("elevation", "q_V_rad", "elevation q_V_rad[1][0]"), ("azimuth", "feedforward_V", "azimuth feedforward_V[0]")]


@pytest.mark.parametrize(("axis", "key", "words"), sampled(OFF, keep=OFF[:1]))
def test_a_coefficient_that_is_off_by_one_place_is_named(axis: str, key: str, words: str) -> None:
    found = _told(flown(host_law(_one_place_up(axis, key))))
    assert (found.bit_exact, found.cause) == (False, "coefficient_last_place")
    assert f"{words} one unit of the last place up" in (found.sentence or "")


@pytest.mark.soak
@pytest.mark.parametrize("factor", sampled([1.00001, 1.01], keep=[1.00001]))
def test_other_coefficients_are_not_taken_for_a_log_that_begins_in_flight(factor: float) -> None:
    rows = tuple(tuple(factor * value for value in row) for row in TABLE.axes[0].q_V_rad)
    assert _told(flown(host_law(changed_axis(TABLE, "elevation", q_V_rad=rows)))).cause == "not_found"


def test_an_offset_is_named_and_a_log_that_begins_in_flight_is_its_alternative() -> None:
    log = own()
    log.u[:, 0] += 0.1
    found = _told(log)
    assert (found.cause, found.alternatives) == ("output_offset", ("begins_in_flight",))
    assert "u_M_V 0.1 V above" in (found.sentence or "")
    assert "would look the same" in (found.sentence or "")


HELD = [
    ("v_V -= u_V - limited_V; const law_number w_0_V = 0.0f;", "clamped_integrator"),
    ("if (u_V != limited_V) { v_V = self->v_V; } const law_number w_0_V = 0.0f;", "conditional_integration"),
]


@pytest.mark.parametrize(("change", "cause"), sampled(HELD, keep=HELD[1:]))
def test_integrators_that_are_held_at_the_limits_are_named(change: str, cause: str) -> None:
    law = edited_law("const law_number w_0_V = u_V - limited_V;", change, TIGHT)
    assert _told(flown(law, TIGHT), TIGHT).cause == cause


@pytest.mark.usefixtures("one_change")
def test_a_difference_that_begins_at_a_limit_is_said_to() -> None:
    law = edited_law("w_0_V = u_V - limited_V", "w_0_V = 0.37f * (u_V - limited_V)", TIGHT)
    found = _told(flown(law, TIGHT), TIGHT)
    assert found.cause == "not_found"
    assert "anti-windup" in (found.sentence or "")


@pytest.mark.soak
def test_a_difference_that_begins_at_no_limit_is_not_laid_on_one() -> None:
    other = edited_law("e_2_rad = e_1_rad - self->e_1_rad", "e_2_rad = 0.9f * (e_1_rad - self->e_1_rad)")
    assert "anti-windup" not in (_told(flown(other)).sentence or "")


LACKING = [(numbers, rows) for numbers in (False, True) for rows in ("every other", "the middle")]


@pytest.mark.usefixtures("one_change")
@pytest.mark.parametrize(("has_numbers", "lacks"), sampled(LACKING, keep=LACKING[2:3]))
def test_a_log_that_lacks_half_its_rows_says_so(has_numbers: bool, lacks: str) -> None:
    log = own()
    log = replace(log, seq=np.arange(len(log.t_s)) if has_numbers else None)
    kept = np.arange(len(log.t_s)) % 2 == 0 if lacks == "every other" else (log.t_s < 5.0) | (log.t_s > 15.0)
    found = _told(rows_of(log, kept))
    assert (found.bit_exact, found.cause) == (False, "missing_rows")
    assert f"{kept.sum()} of 2001 samples" in (found.sentence or "")


@pytest.mark.parametrize("every", sampled([1, 100], keep=[100]))
def test_rows_that_stand_twice_are_told_from_a_law_that_was_not_run(every: int) -> None:
    log = own()
    rows = np.sort(np.concatenate([np.arange(len(log.t_s)), np.arange(100, 2000, every)]))
    found = _told(replace(rows_of(log, rows), t_s=0.01 * np.arange(len(rows))))
    assert (found.bit_exact, found.cause, found.alternatives) == (False, "repeated_row", ("lost_sample",))


def test_one_row_that_stands_twice_is_a_law_that_was_not_run_once() -> None:
    log = own()
    rows = np.insert(np.arange(len(log.t_s)), 700, 700)
    found = _told(replace(rows_of(log, rows), t_s=0.01 * np.arange(len(rows))))
    assert (found.cause, found.alternatives) == ("lost_sample", ("repeated_row",))


@pytest.mark.parametrize("factor", sampled([0.5, 0.99, 1.01, 1.1, 2.0, 1000.0], keep=[0.99, 1000.0]))
def test_a_clock_that_runs_fast_or_slow_loses_no_samples(factor: float) -> None:
    log = own()
    assert _told(replace(log, t_s=factor * log.t_s)).bit_exact


@pytest.mark.soak
def test_a_log_cut_in_flight_with_all_at_rest_is_told_by_its_time() -> None:
    assert _told(default_flight(52.0)).cause == "begins_in_flight"
