"""Readings of an encoder that are a few steps off in single rows are left out; motion to and fro, blows, noise and shaking are not."""

from dataclasses import replace

import numpy as np
import pytest

from logcheck.spikes import spike_findings
from records.log import RunLog
from tests.logcheck.flight import clean, examined, kinds
from tests.logcheck.test_parts import STEP_RAD, log_of, rounded

SWING = 0.8 * np.sin(1.3 * np.arange(2000) * 0.01)  # up to 7 steps a row


def spike_rows(psi_rad: np.ndarray, t_s: np.ndarray | None = None) -> np.ndarray:
    log = log_of()
    log = replace(log, y=np.column_stack([psi_rad, log.y[:, 1]]), t_s=log.t_s if t_s is None else t_s)
    found = list(spike_findings(log, "a", "psi_rad", STEP_RAD))
    return found[0].excluded if found else np.zeros(len(psi_rad), bool)


def spoilt(psi_rad: np.ndarray, share: float, steps: int) -> np.ndarray:
    rng = np.random.default_rng(5)
    hit = (rng.random(len(psi_rad)) < share) * rng.choice((-1, 1), len(psi_rad))
    return psi_rad + steps * STEP_RAD * hit


@pytest.mark.parametrize("steps", [4, 5, 25])
@pytest.mark.parametrize("share", [0.004, 0.03, 0.05, 0.12, 0.2])
def test_spikes_are_left_out_also_in_rows_beside_one_another(share: float, steps: int) -> None:
    read = spoilt(rounded(SWING), share, steps)
    found, off = spike_rows(read), np.abs(read - rounded(SWING)) > 0.5 * STEP_RAD
    assert off.sum() >= 5
    assert found[off].mean() > 0.95
    assert (found & ~off).sum() <= 0.03 * off.sum()


@pytest.mark.parametrize("rows", [(0,), (1,), (1998,), (1999,), (1000, 1001), (1000, 1002, 1004), (1000, 1001, 1003)])
def test_spikes_at_the_ends_and_in_a_cluster_are_found_where_others_are(rows: tuple[int, ...]) -> None:
    others = range(300, 900, 60)
    off = np.isin(np.arange(2000), (*rows, *others))
    assert np.array_equal(spike_rows(rounded(SWING) + 5.0 * STEP_RAD * off), off)


def test_a_log_tells_its_spikes_with_column_share_and_time_and_leaves_these_readings_out() -> None:
    log = clean()
    y = np.column_stack([spoilt(log.y[:, 0], 0.03, 5), log.y[:, 1]])
    found, off = examined(replace(log, y=y)), y != log.y
    assert kinds(found, "exclude") == {"spikes"}
    (told,) = [entry for entry in found.findings if entry.kind == "spikes"]
    rows = np.flatnonzero(off[:, 0])
    assert f"psi_rad leaps off the way of its axis and back in {told.rows} rows" in told.sentence
    assert told.rows == pytest.approx(len(rows), rel=0.05)
    assert told.start_s == pytest.approx(log.t_s[rows[0]])
    assert not found.logs[0].excluded.any()


def honest() -> dict[str, np.ndarray]:
    rng, row = np.random.default_rng(3), np.arange(2000)
    burst = np.where(row % 400 < 20, 5.0 * STEP_RAD * np.cos(2.0 * np.pi * row / 3.0), 0.0)
    return {
        "swing": rounded(SWING),
        "blows": rounded(0.03 * np.abs((row % 20) - 10.0)),
        "noise": rounded(SWING + rng.normal(0.0, 3.0 * STEP_RAD, 2000)),
        "shaking": rounded(SWING + burst),
        "hunting": rounded(SWING) + STEP_RAD * (rng.random(2000) < 0.05),
        "heavy": rounded(SWING + 2.0 * STEP_RAD * rng.standard_t(3.0, 2000)),
        "clusters": rounded(SWING) + 5.0 * STEP_RAD * (rng.random(2000) < 0.6) * (row % 100 < 20),
        "two": rounded(SWING) + 5.0 * STEP_RAD * np.isin(row, (700, 1500)),
    }


@pytest.mark.parametrize("name", honest())
def test_no_motion_and_no_noise_is_a_spike(name: str) -> None:
    assert not spike_rows(honest()[name]).any()


def test_late_stamps_of_even_samples_and_late_samples_of_even_rows_are_none() -> None:
    late_s = np.random.default_rng(4).uniform(-4e-3, 4e-3, 2000)
    t_s = log_of().t_s
    assert not spike_rows(rounded(SWING), t_s + late_s).any()
    assert not spike_rows(rounded(0.8 * np.sin(1.3 * (t_s + late_s))), t_s + late_s).any()


def test_a_log_without_any_reading_has_none(recwarn: pytest.WarningsRecorder) -> None:
    log: RunLog = log_of()
    for psi in (np.full(2000, np.nan), np.full(2000, 0.1)):
        assert not spike_rows(psi, np.zeros(2000)).any()
    assert not list(spike_findings(replace(log, t_s=log.t_s[:3], u=log.u[:3], y=log.y[:3]), "a", "psi_rad", STEP_RAD))
    assert not recwarn.list
