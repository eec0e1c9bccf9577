"""Commands lost on the line: their share from flights whose truth is known, nothing where none was lost."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from threading import Barrier

import numpy as np
import pytest
from numpy.typing import NDArray

from diagnosis import decisions
from diagnosis.detect.linearisation import linearised
from diagnosis.fit.gauss_newton import fit
from diagnosis.fit.linear_problem import Fit
from diagnosis.hypothesis.case import Case, make_case
from diagnosis.library.effect_library import effect_library
from diagnosis.search import loss_ratios
from diagnosis.search.loss_ratios import FORGOTTEN_ROWS, Frames
from diagnosis.search.lost_frames import SWEEPS, likely_share, loss_evidence, with_losses
from records.log import RunLog
from sim.bind import BoundPlant
from sim.paths.input_stages import uniform
from tests.diagnosis.conftest import Fly
from tests.diagnosis.nominal import nominal_fit

SHARE = 0.3
Array = NDArray[np.float64]


def test_threads_that_open_the_library_at_once_get_the_same() -> None:
    # Each pair that cffi makes refuses the requests of every other.
    loss_ratios._opened.cache_clear()
    together = Barrier(8)

    def opened(_: int) -> object:
        together.wait()
        return loss_ratios._library()[0]

    with ThreadPoolExecutor(8) as pool:
        assert len(set(map(id, pool.map(opened, range(8))))) == 1


def losses(plant: BoundPlant, log: RunLog) -> tuple[Case, Fit | None]:
    case = make_case(effect_library(plant), [log])
    return with_losses(case, linearised(case, nominal_fit(case)))


@pytest.mark.soak
def test_lost_frames_are_told_from_others(plant: BoundPlant, fly: Fly) -> None:
    # A loss leaves little trace where the command hardly changes: single frames are told better than by guessing, which would rank 0.5
    # of the pairs (lost, not lost) right, by six times the 0.008 to which 6000 frames tell that share.
    case, fitted = losses(
        plant, fly(41, {"loop.dropped_frames": {"p": SHARE}}, seconds=60.0, air=False, jumps_rad=0.05)
    )
    assert fitted is not None
    ratios = case.flights[0].filter_input.lost
    lost = uniform(np.arange(len(ratios)), 0) < SHARE
    order = np.argsort(np.argsort(ratios))
    told = (order[lost].mean() - 0.5 * (lost.sum() - 1)) / (~lost).sum()
    assert told > 0.55


def test_where_none_is_lost_none_is_supposed(plant: BoundPlant, fly: Fly) -> None:
    case, fitted = losses(plant, fly(41))
    assert fitted is None
    assert loss_evidence(case, likely_share(case)) < decisions.TAKEN_IN


def test_rows_that_a_log_lacks_are_no_lost_frames(plant: BoundPlant, fly: Fly) -> None:
    # Truth: every command arrived; of each 40 rows one to three were not logged.
    log = fly(41)
    kept = np.arange(len(log.t_s)) % 40 >= 1 + np.arange(len(log.t_s)) // 40 % 3
    found, fitted = losses(plant, replace(log, t_s=log.t_s[kept], u=log.u[kept], y=log.y[kept], extra={}))
    assert fitted is None
    assert loss_evidence(found, likely_share(found)) < decisions.TAKEN_IN
    untold = np.flatnonzero(found.flights[0].filter_input.untold_s)
    assert len(untold) > 30
    assert not found.flights[0].filter_input.lost[np.concatenate((untold, untold + 1))].any()


@pytest.mark.soak
def test_a_loop_that_is_late_loses_no_frames(plant: BoundPlant, fly: Fly) -> None:
    """That every frame were lost by a third, which no frame can be, must not explain a delay of a third of a frame as well as the delay."""
    case = make_case(
        effect_library(plant), [fly(41, {"loop.delay": {"tau": 0.0035}}, seconds=60.0, air=False, jumps_rad=0.05)]
    )
    nominal = nominal_fit(case)
    judged, lossy = with_losses(case, linearised(case, nominal))
    late = fit(judged, nominal.hypothesis.with_effects({"loop.delay": {"tau": 0.003}}))
    lost = fit(judged, nominal.hypothesis.with_effects({"loop.dropped_frames": {"p": 0.2}}))
    assert late is not None
    assert max(found.log_posterior for found in (lossy, lost) if found) < late.log_posterior - 50.0


def test_each_frame_s_ratio_is_that_of_its_own_answer() -> None:
    """L = a'(w + pi a) - a'a / 2 with a from what arrived before, written out frame by frame; to rounding."""
    rng = np.random.default_rng(5)
    rows, slots, columns = 150, 2, [0, 2]
    u, w = rng.standard_normal((rows, 3)), rng.standard_normal((rows, slots))
    answers = 0.1 * rng.standard_normal((rows, FORGOTTEN_ROWS, slots, len(columns)))
    before = rng.uniform(0.0, 1.0, rows)
    judged = np.ones(rows, dtype=np.uint8)
    judged[[0, 40, 41]] = 0
    found, power = loss_ratios.loss_ratios(Frames(u, columns, answers, w, before, judged), 0)

    arrived = u[:, columns].copy()
    for row in range(1, rows):
        held = arrived[row - 1] - u[row, columns]
        arrived[row] += before[row] * held
        a = (answers[row] @ held)[: rows - row]
        expected = np.sum(a * (w[row : row + FORGOTTEN_ROWS] + before[row] * a)) - 0.5 * np.sum(a * a)
        np.testing.assert_allclose(found[row], expected if judged[row] else 0.0, rtol=1e-9, atol=1e-12)
        np.testing.assert_allclose(power[row], np.sum(a * a) if judged[row] else 0.0, rtol=1e-9, atol=1e-12)


def answered(u: Array, lost: Array, answers: Array) -> tuple[Array, Array]:
    """What arrives (rows, 1) of the commands u where frames are lost, and what that makes of the innovations (rows, 1)."""
    arrived, w = u.copy(), np.zeros_like(u)
    for row in range(1, len(u)):
        held = lost[row] * (arrived[row - 1] - u[row])
        arrived[row] += held
        end = min(len(u), row + FORGOTTEN_ROWS)
        w[row:end, 0] += answers[row, : end - row, 0, 0] * held
    return arrived, w


def ratios_of(u: Array, answers: Array, w: Array, sweeps: int) -> tuple[Array, Array]:
    """L and a'a of frames of one input, none of which was supposed lost before."""
    frames = Frames(u, [0], answers, w, np.zeros(len(u)), np.ones(len(u), dtype=np.uint8))
    return loss_ratios.loss_ratios(frames, sweeps)


def test_in_sweeps_every_frame_is_judged_beside_the_others() -> None:
    """Losses whose answers overlap are all found where together they explain the innovations without rest."""
    rng = np.random.default_rng(6)
    rows = 200
    u, lost = rng.standard_normal((rows, 1)), np.zeros(rows)
    lost[[20, 22, 23, 90, 91, 150]] = 1.0
    answers = np.zeros((rows, FORGOTTEN_ROWS, 1, 1))
    answers[:, :, 0, 0] = 10.0 * np.exp(-np.arange(FORGOTTEN_ROWS) / 5.0)
    arrived, w = answered(u, lost, answers)
    ratios, _ = ratios_of(u, answers, w, 10)
    clear = np.append(False, np.abs(arrived[:-1, 0] - u[1:, 0]) > 0.2)
    np.testing.assert_array_equal(ratios[clear] > 0.0, lost[clear] > 0.5)


def test_losses_side_by_side_are_told_apart() -> None:
    """Slow answers of neighbouring frames look alike: of losses that stand out of the noise by ten standard deviations one in a hundred
    may stand at another's place. Judged one after another, one in five does."""
    rng = np.random.default_rng(7)
    rows = 3000
    u, lost = rng.standard_normal((rows, 1)).cumsum(axis=0), rng.uniform(size=rows) < 0.25
    lost[0] = False
    lags = np.arange(FORGOTTEN_ROWS)
    answers = np.zeros((rows, FORGOTTEN_ROWS, 1, 1))
    answers[:, :, 0, 0] = 5.0 * lags / 3.0 * np.exp(1.0 - lags / 3.0)
    w = rng.standard_normal((rows, 1)) + answered(u, lost.astype(float), answers)[1]
    ratios, power = ratios_of(u, answers, w, SWEEPS)
    clear = power > 100.0
    wrong = (ratios > 0.0) != lost
    assert clear.mean() > 0.4
    assert wrong[clear].mean() < 0.01
