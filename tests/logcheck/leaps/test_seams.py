"""One file of several recordings is cut where all outputs leap at once; a slip, a gap or noise is no such seam."""

from dataclasses import replace

import numpy as np
import pytest

from logcheck.facts import plant_facts
from logcheck.integrity import examine
from records.log import RunLog
from tests.logcheck.flight import TURN_STEP_RAD, clean, examined, kinds, with_column
from tests.replay.firmware_flights import plant, rows_of


def one_after_another(*logs: RunLog) -> RunLog:
    """Several logs in one file, the time of which goes on."""
    y, u = np.concatenate([log.y for log in logs]), np.concatenate([log.u for log in logs])
    return replace(logs[0], t_s=np.linspace(0.0, 0.01 * (len(y) - 1), len(y)), y=y, u=u, extra={})


def test_several_recordings_in_one_file_are_cut_apart_at_their_seams() -> None:
    log = clean()
    found_in = examined(one_after_another(log, log, log))
    (found,) = [finding for finding in found_in.findings if finding.kind == "seam"]
    assert np.flatnonzero(found_in.logs[0].begins).tolist() == [2001, 4002]
    assert [found.start_s, found.end_s] == pytest.approx([20.01, 40.02])
    leaps = np.abs(log.y[0] - log.y[-1]) / TURN_STEP_RAD
    assert f"psi_rad by {leaps[0]:.0f} steps and phi_rad by {leaps[1]:.0f} steps" in found.sentence
    assert "and so at 40.02 s" in found.sentence


@pytest.mark.parametrize("columns", [[0], [1]])
def test_one_output_that_jumps_alone_is_a_count_slip_and_no_seam(columns: list[int]) -> None:
    log = clean()
    y = log.y.copy()
    y[900:, columns] -= 200 * TURN_STEP_RAD
    assert not kinds(examined(replace(log, y=y, extra={}))) & {"seam", "dead_stretch"}


def test_a_leap_of_all_outputs_over_missing_rows_or_repeated_readings_is_no_seam() -> None:
    # From 7 s on both axes are under way: 20 rows later both are far from where they were, as honest motion.
    log, rows = clean(), np.arange(2001)
    fastest = int(np.argmax(np.abs(log.y[20:] - log.y[:-20]).min(axis=1)))
    lost = (rows > fastest) & (rows < fastest + 20)
    assert (np.abs(log.y[fastest + 20] - log.y[fastest]) > 40 * TURN_STEP_RAD).all()
    assert kinds(examined(rows_of(log, ~lost))) == {"missing_rows", "break"}
    held = replace(log, y=log.y[np.where(lost, fastest, rows)])
    assert "seam" not in kinds(examined(held))


def test_noise_of_a_count_in_a_log_at_rest_is_no_seam() -> None:
    log = clean()
    counts = np.zeros((2001, 2))
    counts[::150], counts[1000:] = 2.0, 1.0
    assert "seam" not in kinds(examined(replace(log, y=counts * TURN_STEP_RAD, extra={})))


@pytest.mark.parametrize("speed_rad_s", [0.05, 0.1, 0.2, 0.5])
@pytest.mark.parametrize("step_deg", [0.5, 1.0, 3.0])
def test_coarse_readings_of_a_fine_encoder_that_follow_their_reference_are_no_seam(
    step_deg: float, speed_rad_s: float
) -> None:
    # A count comes every few rows only, and the encoder as stated would have moved ten thousand steps by then.
    step_rad, log, facts = np.radians(step_deg), clean(), plant_facts(plant())
    reference_rad = 0.8 * np.sin(speed_rad_s * log.t_s)
    coarse = with_column(log, "psi_rad", np.round(reference_rad / step_rad) * step_rad)
    follows = replace(coarse, extra={"psi_ref_rad": reference_rad})
    fine = replace(facts, steps=dict.fromkeys(facts.steps, 1e-6))
    assert not kinds(examine([follows], fine))


def test_flights_of_coarse_readings_are_cut_apart_where_their_reference_leaps() -> None:
    log = clean()
    coarse = replace(log, y=np.round(log.y / 0.02) * 0.02, extra={})
    assert np.flatnonzero(examined(one_after_another(coarse, coarse)).logs[0].begins).tolist() == [2001]
