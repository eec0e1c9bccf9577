"""Each part of the log check by itself, on made-up columns of a CE150 whose truth is what was put in."""

from dataclasses import replace

import numpy as np
import pytest

from logcheck.between import duplicate_findings, holding_ratio, plant_pair_findings, shared_rows
from logcheck.facts import plant_facts
from logcheck.finding import EXCLUDE, NOTE, REFUSE, Found, in_words
from logcheck.grid import grid_step, printed_digits
from logcheck.held import held_findings
from logcheck.inputs import input_findings, saturations
from logcheck.leaps.motion import motion_findings
from logcheck.leaps.seams import seam_findings
from logcheck.plant import plant_findings
from logcheck.stamps import timing, timing_findings
from logcheck.stands.dead import amount, dead_findings, read_again
from logcheck.stands.standing import locked_findings
from logcheck.units.angle import angle_unit
from logcheck.units.derived import rate_unit, reference_unit
from logcheck.units.inputs import input_unit, machine_unit
from logcheck.units.slip import greatest_of, slip
from logcheck.values import value_findings
from records.log import RunLog
from sim.columns import log_columns
from sim.equilibrium import equilibrium
from tests.plants import bound

STEP_RAD = 2.0 * np.pi / 4096.0
STEPS = {"psi_rad": STEP_RAD, "phi_rad": STEP_RAD}
LIMITS = {"u_M_V": (0.0, 10.0), "u_T_V": (-10.0, 10.0)}
PLANT = bound("ce150")


def rounded(angle: np.ndarray) -> np.ndarray:
    return STEP_RAD * np.round(angle / STEP_RAD)


def log_of(rows: int = 2000, **extra: np.ndarray) -> RunLog:
    """Both axes swing by some 0.3 rad, each its own way, read by encoders; the inputs move with them."""
    t_s = 0.01 * np.arange(rows)
    psi, phi = 0.3 * np.sin(1.3 * t_s + 0.2), 0.35 * np.sin(0.9 * t_s) + 0.1 * np.sin(2.1 * t_s)
    u = np.column_stack([6.0 + np.sin(1.3 * t_s), 2.0 * np.sin(0.9 * t_s)])
    return RunLog(log_columns(PLANT.model), 0.01, "closed", t_s, u, rounded(np.column_stack([psi, phi])), extra=extra)


def kinds(found: list[Found]) -> dict[str, str]:
    return {entry.finding.kind: entry.finding.severity for entry in found}


def test_a_plain_log_is_not_remarked_on_by_any_part() -> None:
    log = log_of()
    again = read_again(log)
    facts = plant_facts(PLANT)
    assert not again.any()
    for found in (
        dead_findings(log, "a", STEPS, again),
        held_findings(log, "a"),
        input_findings(log, "a", LIMITS),
        locked_findings(log, "a", PLANT),
        motion_findings(log, "a", PLANT),
        plant_findings(log, "a", PLANT, facts),
        seam_findings(log, "a", STEPS, again),
        timing_findings(log, "a", timing(log)),
        value_findings(log, "a", STEPS),
    ):
        assert list(found) == []


def test_an_output_that_stands_while_its_axis_goes_on_is_told_with_its_times() -> None:
    log = log_of()
    log.y[320:380, 1] = log.y[320, 1]  # 0.6 s in the middle of a fast swing
    (found,) = dead_findings(log, "a", STEPS, read_again(log))
    assert (found.finding.column, found.finding.severity) == ("phi_rad", EXCLUDE)
    assert (found.finding.start_s, found.finding.end_s) == (pytest.approx(3.2, abs=0.02), pytest.approx(3.8, abs=0.02))
    assert amount(3.0 * STEP_RAD, "phi_rad", STEP_RAD) == "3 steps"
    assert amount(3.0, "omega_rad_s", 0.0) == "3 rad/s"
    assert (in_words(1, "row"), in_words(3, "row")) == ("1 row", "3 rows")


@pytest.mark.parametrize(("slept_rows", "told"), [(0, []), (30, ["psi_rad"])])
def test_a_rate_that_an_input_sets_going_rested_and_one_that_was_read_late_did_not(
    slept_rows: int, told: list[str]
) -> None:
    """Truth: a speed that follows a step at 2 s within 10 and 150 ms, read in steps as a counted encoder's; 0.6 s unread are told."""
    t_s = 0.02 * np.arange(300)
    command = np.where(np.arange(300) < 100, 0.0, 9.0)
    after_s = np.maximum(t_s - 2.0, 0.0)
    speed = 7.5 * (1.0 - np.exp(-after_s / 0.01)) + 4.0 * (1.0 - np.exp(-after_s / 0.15))
    read = 0.727 * np.round(speed / 0.727 + 0.4 * np.sin(40.0 * after_s))
    read[100 : 100 + slept_rows] = 0.0
    log = replace(log_of(300), t_s=t_s, sample_period_s=0.02, u=np.column_stack([command, command]))
    log = replace(log, y=np.column_stack([read, np.zeros(300)]))
    found = dead_findings(log, "a", {"psi_rad": 0.727}, np.zeros(300, bool))
    assert [entry.finding.column for entry in found] == told


def test_readings_that_are_repeated_until_the_next_one_are_left_out() -> None:
    log = log_of()
    log.y[:] = log.y[4 * (np.arange(2000) // 4)]
    (found,) = held_findings(log, "a")
    assert found.finding.severity == EXCLUDE
    assert found.excluded is not None
    assert found.excluded.mean() == pytest.approx(0.75, abs=0.01)


def test_inputs_at_a_limit_and_held_within_it_are_told() -> None:
    log = log_of()
    log.u[:, 0] = np.clip(log.u[:, 0], None, 6.5)
    log.u[:300, 1] = 10.0
    found = list(input_findings(log, "a", LIMITS))
    assert {entry.finding.column for entry in found} == {"u_M_V", "u_T_V"}
    assert all(entry.finding.severity == NOTE for entry in found)
    assert saturations(log, LIMITS)["u_T_V"].upper == pytest.approx(300 / 2000)


def test_an_axis_that_never_moves_though_it_would_is_refused() -> None:
    log = log_of()
    log.y[:, 1] = 0.0
    log.u[:, 1] = 5.0  # the tail rotor at half of what it can: no base stands under that
    (found,) = locked_findings(log, "a", PLANT)
    assert found.finding.severity == REFUSE
    assert "phi_rad" in (found.finding.column or found.finding.sentence)


def test_shuffled_rows_are_no_motion() -> None:
    log = log_of()
    np.random.default_rng(1).shuffle(log.y)
    assert set(kinds(list(motion_findings(log, "a", PLANT))).values()) == {REFUSE}


def test_degrees_are_no_radians_and_a_grid_is_found_by_its_step() -> None:
    log = log_of()
    assert grid_step(log.y[:, 0]) == pytest.approx(STEP_RAD)
    log.y[:] = np.degrees(log.y)
    found = list(plant_findings(log, "a", PLANT, plant_facts(PLANT)))
    assert REFUSE in kinds(found).values()
    assert any("degrees" in entry.finding.sentence for entry in found)


@pytest.mark.parametrize(("beyond", "told"), [([1.0], False), ([1.0, 1.01], False), ([1.0, 1.01, 1.05], True)])
def test_a_sensor_s_own_decimal_steps_are_few_digits_only_where_readings_enough_are_as_coarse(
    beyond: list[float], told: bool
) -> None:
    """Truth: steps of 1 mrad up to a reference of exactly 1 rad; of a few readings that are multiples of 0.01 rad none needs more."""
    log, facts = log_of(), plant_facts(PLANT)
    rising = np.round(np.arange(-200, 1000) * 1e-3, 3)
    log.y[:, 1] = np.resize(np.concatenate([rising, np.repeat(beyond, 100)]), len(log.y))
    stated = replace(facts, steps={**facts.steps, "phi_rad": 1e-3})
    assert ("few_digits" in kinds(list(plant_findings(log, "a", PLANT, stated)))) == told


@pytest.mark.parametrize(("digits", "severity"), [(2, REFUSE), (3, EXCLUDE), (4, NOTE)])
def test_readings_printed_with_few_digits_are_told_and_the_coarse_ones_left_out(digits: int, severity: str) -> None:
    # Truth: an encoder's angles of 1.2 rad at most. With three digits those above 1 rad stand in steps of 0.01, the others of 0.001.
    angle = rounded(1.2 * np.sin(0.01 * np.arange(2000)))
    printed = np.array([float(f"{value:.{digits}g}") for value in angle])
    assert printed_digits(printed) == digits
    assert printed_digits(angle) is None
    assert printed_digits(np.round(angle, 3)) is None
    log = log_of()
    log.y[:, 1] = printed
    (found,) = [
        found for found in plant_findings(log, "a", PLANT, plant_facts(PLANT)) if found.finding.column == "phi_rad"
    ]
    assert (found.finding.kind, found.finding.severity) == ("few_digits", severity)
    assert f"printed with {digits} digits, in steps of up to {10.0 ** (1 - digits):.2g}" in found.finding.sentence
    if severity == EXCLUDE:
        assert found.excluded is not None
        assert np.array_equal(found.excluded, np.abs(printed) >= 1.0)


def test_two_recordings_in_one_file_leap_in_all_outputs_at_once() -> None:
    log = log_of()
    log.y[1000:] += rounded(np.array([0.5, -0.6]))
    (found,) = seam_findings(log, "a", STEPS, read_again(log))
    assert found.begins is not None
    assert np.flatnonzero(found.begins).tolist() == [1000]
    assert "10" in found.finding.sentence  # s, where the second begins


def test_missing_rows_and_another_period_are_seen_in_the_stamps() -> None:
    log = log_of()
    kept = np.delete(np.arange(2000), np.arange(700, 705))
    gappy = RunLog(log.columns, 0.01, "closed", log.t_s[kept], log.u[kept], log.y[kept])
    told = timing(gappy)
    assert (told.rows, told.missing_by_time) == (1995, 5)
    assert "missing_rows" in kinds(list(timing_findings(gappy, "a", told)))
    slow = RunLog(log.columns, 0.01, "closed", 1.01 * log.t_s, log.u, log.y)
    assert timing(slow).period_error_ppm == pytest.approx(1e4, rel=1e-3)


def test_units_of_references_and_rates_follow_from_what_they_equal() -> None:
    t_s = log_of().t_s
    psi_dot = 0.39 * np.cos(1.3 * t_s + 0.2)
    log = log_of(psi_ref_rad=np.degrees(log_of().y[:, 0]), psi_dot_rad_s=np.degrees(psi_dot))
    (reference,) = reference_unit(log, "a", "psi_rad")
    (rate,) = rate_unit(log, "a", PLANT.model)
    for found in (reference, rate):
        assert found.finding.severity == REFUSE
        assert "degrees" in found.finding.sentence
    right = log_of(psi_ref_rad=log_of().y[:, 0], psi_dot_rad_s=psi_dot)
    assert list(reference_unit(right, "a", "psi_rad")) == list(rate_unit(right, "a", PLANT.model)) == []


def test_numbers_that_are_missing_or_fly_off_are_left_out() -> None:
    log = log_of()
    log.y[100, 0] += 2.0
    log.y[200:210, 1] = np.nan
    found = {entry.finding.column: entry for entry in value_findings(log, "a", STEPS)}
    assert found["psi_rad"].excluded is not None
    assert np.flatnonzero(found["psi_rad"].excluded).tolist() == [100]
    assert "10 rows" in found["phi_rad"].finding.sentence


def test_rows_that_stand_in_two_logs_and_rigs_that_differ_are_seen_between_them() -> None:
    one, other = log_of(), log_of()
    other.y[:1500] = rounded(other.y[:1500] + 0.01)
    rows = shared_rows(one, other)
    assert rows[1500:].all()
    assert not rows[:1400].any()
    ((_, twice),) = duplicate_findings([one], ["a"], [other], ["b"])
    assert twice.finding.severity == REFUSE  # of rows to fit and rows to check on
    assert list(plant_pair_findings([one, one], ["a", "b"])) == []


def test_logs_that_rest_at_one_angle_by_other_inputs_are_told_and_a_turned_sign_is_no_ratio() -> None:
    # Truth: an axis that creeps by 5 mrad a second while 6 V and more hold it, and a second log of twice that input, or of the other sign.
    log = log_of(4000)
    one = replace(log, y=rounded(np.column_stack([0.005 * log.t_s, log.y[:, 1]])))
    assert holding_ratio(one, replace(one, u=2.0 * one.u)) == pytest.approx(2.0)
    ((_, told),) = plant_pair_findings([one, replace(one, u=2.0 * one.u)], ["a", "b"])
    assert "u_M_V that holds the same psi_rad is 2 times that of a" in told.finding.sentence
    assert holding_ratio(one, replace(one, u=-one.u)) is None


@pytest.mark.parametrize(("scale", "unit"), [(np.degrees(1.0), "degrees"), (1.0 / STEP_RAD, "encoder counts")])
def test_an_angle_far_beyond_its_stops_is_told_with_its_unit(scale: float, unit: str) -> None:
    # Truth: half a radian of the azimuth as 29 degrees and as 298 counts of a turn's 4096.
    log = log_of()
    found = list(angle_unit(replace(log, y=log.y * [1.0, scale]), "a", "phi_rad", PLANT, plant_facts(PLANT)))
    assert kinds(found) == {"unit_slip": REFUSE}
    assert f"phi_rad is in {unit}" in found[0].finding.sentence
    assert not list(angle_unit(log, "a", "phi_rad", PLANT, plant_facts(PLANT)))


def test_inputs_in_percent_and_in_machine_units_are_told() -> None:
    # Truth: 7 of 10 V as 70 percent; what holds the arm level, as a share of 10 V.
    log, facts = log_of(), plant_facts(PLANT)
    (found,) = input_unit(replace(log, u=log.u * [10.0, 1.0]), "a", facts)
    assert "u_M_V is in percent" in found.finding.sentence
    held = float(equilibrium(PLANT, 0.0).u0[0])
    level = replace(log, u=np.full_like(log.u, held / 10.0), y=np.zeros_like(log.y))
    (found,) = machine_unit(level, "a", PLANT, facts)
    assert "u_M_V is in machine units, 1 for 10 V" in found.finding.sentence
    assert not list(input_unit(log, "a", facts))
    assert not list(machine_unit(log, "a", PLANT, facts))


def test_a_slip_spans_the_log_and_one_wild_row_is_no_size() -> None:
    log = log_of()
    span = slip(log, "a", "u_M_V", "it is in percent", "volt", "convert it").finding
    assert (span.start_s, span.end_s, span.severity) == (log.t_s[0], log.t_s[-1], REFUSE)
    values = np.append(np.full(1999, -2.0), 1e6)
    assert greatest_of(values) == 2.0
