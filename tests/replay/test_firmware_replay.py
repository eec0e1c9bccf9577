"""Flights of known firmwares: the table's own is bit-exact, each that differs is named, and what no variant explains is not."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from design.law import FloatLaw
from records.diagnosis import Firmware
from records.errors import BadInput
from records.files import write_atomic
from records.table import ControllerTable, table_text
from replay.build import careless_law, fused_outputs
from replay.firmware import FirmwareReplay, replay_firmware
from replay.law import ReplayLaw, Setup
from replay.table import replay_log
from sim.loop import Controller, fly
from sim.manoeuvres import flight
from tests.controllers.rows import designed
from tests.law_tables import ce150_table, changed_axis, dense_table
from tests.replay.firmware_flights import Lossy, Wrapped, default_flight, edited_law, flown, own, plant, rows_of, stale
from tests.soak import sampled
from verification.host_law import host_law
from verification.stimuli import reference_jumps, saturating, with_special_numbers

TABLE = ce150_table()


def _both_axes(table: ControllerTable, **change: object) -> ControllerTable:
    return changed_axis(changed_axis(table, "elevation", **change), "azimuth", **change)


# Limits that both inputs meet in the lively flight, so that anti-windup shows.
TIGHT = changed_axis(changed_axis(TABLE, "elevation", u_min_V=4.8, u_max_V=6.2), "azimuth", u_min_V=1.6, u_max_V=2.3)


def _rounded(table: ControllerTable, digits: str) -> ControllerTable:
    def written(numbers: tuple[float, ...]) -> tuple[float, ...]:
        return tuple(float(digits % number) for number in numbers)

    for name in ("elevation", "azimuth"):
        axis = table.axis(name)
        rows = {key: tuple(written(row) for row in getattr(axis, key)) for key in ("q_V_rad", "p")}
        table = changed_axis(table, name, **rows, a=written(axis.a), feedforward_V=written(axis.feedforward_V))
    return table


def _replayed(controller: Controller, table: ControllerTable = TABLE, *others: ControllerTable) -> FirmwareReplay:
    return replay_firmware(flown(controller, table), table, others)


@pytest.mark.parametrize("table", [TABLE, dense_table(), ce150_table(degree=5, prefilter_time_constant_s=0.0)])
def test_the_law_as_data_gives_the_bits_of_the_generated_law(table: ControllerTable) -> None:
    law, data, rng = host_law(table), ReplayLaw(Setup(table)), np.random.default_rng(7)
    for stimuli in (reference_jumps, saturating, with_special_numbers):
        stimulus = stimuli(table, rng, 3000, 1)
        _, expected = law.run(law.start(stimulus.angles), stimulus.inputs)
        inputs = np.ascontiguousarray(stimulus.inputs[:, 0].view(np.float32))
        assert np.array_equal(data.outputs(inputs), expected[:, 0].view(np.float32).astype(float))


@pytest.mark.parametrize("table", sampled([TABLE, TIGHT], keep=[TIGHT]))
def test_a_log_of_the_tables_own_law_is_bit_exact(table: ControllerTable) -> None:
    found = _replayed(host_law(table), table)
    assert found.record() == Firmware(True, True, None, None)
    assert [entry.samples_different for entry in found.residuals] == [0, 0]


@pytest.mark.parametrize("table", sampled([TABLE, TIGHT], keep=[TIGHT]))
def test_a_log_of_the_law_in_fixed_point_is_bit_exact_and_said_to_be(table: ControllerTable) -> None:
    found = _replayed(host_law(table, "fixed"), table)
    assert found.record() == Firmware(True, True, None, None)
    assert [entry.samples_different for entry in found.residuals] == [0, 0]
    assert "fixed point" in (found.sentence or "")


def test_a_sample_lost_by_a_law_in_fixed_point_is_found_at_its_time_and_not_explained() -> None:
    lost = Lossy(host_law(TABLE, "fixed"), lambda k: "law" if k == 1500 else None)
    found = _replayed(lost)
    assert (found.bit_exact, found.first_difference_s) == (False, pytest.approx(15.0, abs=0.02))
    assert found.cause == "not_found"
    assert "fixed point" in (found.sentence or "")


STALE = [((2, 3), 1, "both angles"), ((2,), 1, "the elevation"), ((3,), 2, "the azimuth measured two samples")]


@pytest.mark.parametrize(("columns", "samples", "words"), sampled(STALE, keep=STALE[2:]))
def test_stale_angles_are_named_with_axis_and_age(columns: tuple[int, ...], samples: int, words: str) -> None:
    found = _replayed(Wrapped(host_law(TABLE), stale(columns, samples)))
    assert (found.bit_exact, found.cause, found.incidents) == (False, "stale_sample", ())
    assert words in (found.sentence or "")


def test_stale_references_and_late_outputs_are_told_apart() -> None:
    assert _replayed(Wrapped(host_law(TABLE), stale((0, 1)))).cause == "stale_reference"
    late = Wrapped(host_law(TABLE), after=lambda k, sent: sent[max(0, k - 1)])
    assert _replayed(late).cause == "late_output"


OTHER_NUMBERS = [
    (ce150_table(prefilter_time_constant_s=0.0), "reference_unfiltered"),
    (ce150_table(prefilter_time_constant_s=0.5), "other_prefilter"),
    (_rounded(TABLE, "%.6g"), "rounded_coefficients"),
    (_rounded(TABLE, "%.4E"), "rounded_coefficients"),
    (_both_axes(TABLE, feedforward_V=(0.0,)), "no_feedforward"),
]


@pytest.mark.parametrize(("flew", "cause"), sampled(OTHER_NUMBERS, keep=[OTHER_NUMBERS[n] for n in (0, 2, 4)]))
def test_a_law_with_other_numbers_is_named(flew: ControllerTable, cause: str) -> None:
    assert _replayed(host_law(flew)).cause == cause


def test_time_constants_are_given_for_each_axis() -> None:
    flew = changed_axis(
        changed_axis(TABLE, "elevation", prefilter_time_constant_s=0.27), "azimuth", prefilter_time_constant_s=0.413
    )
    found = _replayed(host_law(flew))
    assert found.cause == "other_prefilter"
    assert "0.27 s and 0.413 s" in (found.sentence or "")


def test_another_table_is_named_when_it_is_at_hand() -> None:
    flew = ce150_table(degree=2)
    assert _replayed(host_law(flew), TABLE, flew).cause == "other_table"


@pytest.mark.soak
def test_another_table_is_not_guessed() -> None:
    assert _replayed(host_law(ce150_table(degree=2))).cause == "not_found"


LIMITED = [
    (lambda: host_law(_both_axes(TIGHT, a=(1.0, 0.0, 0.0))), "anti_windup_fb"),
    (lambda: edited_law("w_0_V = u_V - limited_V", "w_0_V = 0.0f", TIGHT), "no_anti_windup"),
    (lambda: host_law(changed_axis(TIGHT, "elevation", u_max_V=5.9)), "other_limits"),
    (lambda: host_law(TABLE), "other_limits"),
    (lambda: Wrapped(host_law(TIGHT), after=lambda k, u: (min(u[k][0], 5.9), u[k][1])), "limited_behind_the_law"),
]


@pytest.mark.parametrize(("controller", "cause"), sampled(LIMITED, keep=[LIMITED[n] for n in (0, 1, 3, 4)]))
def test_anti_windup_and_limits_are_named(controller: object, cause: str) -> None:
    assert _replayed(controller(), TIGHT).cause == cause  # type: ignore[operator]


@pytest.mark.parametrize("step_V", sampled([10.0 / 3200.0, 10.0 / 255.0], keep=[10.0 / 3200.0]))
def test_an_output_in_steps_is_named(step_V: float) -> None:
    controller = Wrapped(
        host_law(TABLE), after=lambda k, u: (round(u[k][0] / step_V) * step_V, round(u[k][1] / step_V) * step_V)
    )
    found = _replayed(controller)
    assert found.cause == "quantised_output"
    assert f"{step_V:.6g} V" in (found.sentence or "")


def test_double_precision_is_named() -> None:
    assert _replayed(FloatLaw(TABLE)).cause == "float64"


def test_a_build_that_fuses_products_and_sums_is_named() -> None:
    if fused_outputs(TABLE, np.zeros((2, 4), np.float32)) is None:
        pytest.skip("this processor has no fused multiply-add")
    found = _replayed(careless_law(TABLE))
    assert found.cause == "fused_multiply_add"
    assert 0 < max(entry.max_V for entry in found.residuals) < 1e-3


@pytest.mark.parametrize(("fate", "cause"), [("output", "dropped_frame"), ("law", "lost_sample")])
@pytest.mark.parametrize("probability", sampled([0.02, 0.3], keep=[0.3]))
def test_lost_frames_and_lost_samples_are_told_apart_and_counted(fate: str, cause: str, probability: float) -> None:
    lost = np.random.default_rng(3).random(3000) < probability
    lost[0] = False
    found = _replayed(Lossy(host_law(TABLE), lambda k: fate if lost[k] else None))
    assert found.cause == cause
    times = {round(at_s, 2) for _, at_s in found.incidents}
    begins = np.flatnonzero(lost[1:2001] & ~lost[:2000]) + 1
    # A loss while the output rests leaves no trace.
    assert len(times - {round(0.01 * k, 2) for k in begins}) == 0
    assert len(times) > 0.9 * len(begins)


def test_a_reset_in_flight_is_found_at_its_time() -> None:
    found = _replayed(Lossy(host_law(TABLE), lambda k: "reset" if k == 700 else None))
    assert (found.cause, found.incidents) == ("reset", (("reset", pytest.approx(7.0)),))
    assert found.first_difference_s == pytest.approx(7.0)


def test_a_cause_and_lost_frames_are_both_named() -> None:
    lost = np.random.default_rng(3).random(3000) < 0.02
    lost[0] = False
    found = _replayed(Lossy(Wrapped(host_law(TABLE), stale((2, 3))), lambda k: "output" if lost[k] else None))
    assert found.cause == "stale_sample + dropped_frame"


@pytest.mark.soak
def test_two_causes_at_once_are_both_named() -> None:
    fb = _both_axes(TIGHT, a=(1.0, 0.0, 0.0))
    assert _replayed(Wrapped(host_law(fb), stale((2, 3))), TIGHT).cause == "stale_sample + anti_windup_fb"


UNKNOWN = [
    ("e_2_rad = e_1_rad - self->e_1_rad", "e_2_rad = 0.9f * (e_1_rad - self->e_1_rad)"),
    ("self->v_V = v_V;", "self->v_V = v_V * 0.9999f;"),
]


@pytest.mark.parametrize(("old", "new"), sampled(UNKNOWN, keep=UNKNOWN[:1]))
def test_what_no_variant_explains_is_not_named(old: str, new: str) -> None:
    found = _replayed(edited_law(old, new))
    assert (found.bit_exact, found.cause, found.incidents) == (False, "not_found", ())
    assert "no other firmware that was tried" in (found.sentence or "")


@pytest.mark.soak
def test_random_outputs_are_not_explained_by_incidents() -> None:
    log = own()
    held = np.repeat(np.random.default_rng(5).normal(5.0, 1.0, (len(log.t_s) // 3 + 1, 2)), 3, axis=0)[: len(log.t_s)]
    assert replay_firmware(replace(log, u=held), TABLE).cause == "not_found"


def test_the_digits_of_the_log_are_told_from_the_firmware() -> None:
    log = own()
    for rounded in (
        replace(log, u=np.round(log.u, 4)),
        replace(log, u=np.round(log.u, 4), y=np.round(log.y, 5)),
        replace(log, y=np.round(log.y, 5)),
    ):
        found = replay_firmware(rounded, TABLE)
        assert (found.bit_exact, found.cause) == (False, "log_rounding")
    nine_digits = [[float(f"{value:.9g}") for value in row] for row in log.u.tolist()]
    assert replay_firmware(replace(log, u=np.array(nine_digits)), TABLE).bit_exact


@pytest.mark.parametrize("numbered", sampled([False, True], keep=[True]))
def test_missing_rows_are_recovered_where_the_log_allows_it(numbered: bool) -> None:
    log = own()
    log = replace(log, seq=np.arange(len(log.t_s)) if numbered else None)
    kept = np.ones(len(log.t_s), bool)
    kept[[200, 500, 501, 1300]] = False
    found = replay_firmware(rows_of(log, kept), TABLE)
    assert (found.bit_exact, found.cause) == (False, "sample_not_logged")


@pytest.mark.soak
def test_of_five_rows_missing_in_a_row_nothing_is_recovered() -> None:
    log = own()
    kept = np.ones(len(log.t_s), bool)
    kept[800:805] = False
    assert replay_firmware(rows_of(log, kept), TABLE).cause == "missing_rows"


@pytest.mark.soak
def test_missing_numbers_are_recovered_where_the_log_allows_it() -> None:
    log = own()
    y = log.y.copy()
    y[[300, 900, 901], [0, 1, 1]] = np.nan
    assert replay_firmware(replace(log, y=y), TABLE).cause == "sample_not_logged"


def test_a_log_of_another_table_is_refused_and_a_table_is_found_beside_the_log(tmp_path: Path) -> None:
    log, path = own(), tmp_path / "run.csv"
    with pytest.raises(BadInput, match="which the log names"):
        replay_firmware(log, TIGHT)
    with pytest.raises(BadInput, match="a flight of table"):
        replay_log(log, path, [TIGHT])
    absent = replay_log(log, path)
    assert absent is not None
    assert (absent.replayed, absent.cause) == (False, "table_not_found")
    write_atomic(tmp_path / "controller.json", table_text(TABLE))
    found = replay_log(log, path)
    assert found is not None
    assert found.bit_exact
    assert replay_log(replace(log, table_digest=None), path) is None


def test_a_log_that_another_controller_flew_says_whose_table_lies_beside_it(tmp_path: Path) -> None:
    row, table = designed("fuzzy")
    write_atomic(tmp_path / "controller.json", row.text(table))
    log = replace(own(), table_digest=table.digest)
    found = replay_log(log, tmp_path / "run.csv")
    assert found is not None
    assert not found.replayed
    assert "'fuzzy'" in found.sentence


def test_a_log_without_references_is_not_replayed() -> None:
    log = own()
    found = replay_firmware(replace(log, extra={}), TABLE)
    assert (found.replayed, found.bit_exact, found.cause) == (False, False, "not_replayable")


BEGUN = [(flew, begin_s) for flew in (TABLE, ce150_table(degree=2)) for begin_s in (20.0, 52.0, 90.0)]


@pytest.mark.usefixtures("one_change")
@pytest.mark.parametrize(("flew", "begin_s"), sampled(BEGUN, keep=[BEGUN[2]]))
def test_a_log_that_begins_in_flight_is_told_from_another_firmware(flew: ControllerTable, begin_s: float) -> None:
    # References that move now and then do not matter: the filters forget how they began as well as if all rested.
    if flew is TABLE:
        log = default_flight(begin_s)
    else:
        log = fly(plant(), host_law(flew), flight(plant()), table_digest=TABLE.digest)
        log = rows_of(log, log.t_s > begin_s)
    found = replay_firmware(log, TABLE)
    assert (found.bit_exact, found.cause) == (False, "begins_in_flight" if flew is TABLE else "not_found")


@pytest.mark.usefixtures("one_change")
def test_a_log_too_short_to_tell_the_laws_state_says_that_its_beginning_may_be_missing() -> None:
    found = replay_firmware(default_flight(100.0), TABLE)
    assert found.cause == "not_found"
    assert "from the first row on" in (found.sentence or "")
    assert "beginning" in (found.sentence or "")
