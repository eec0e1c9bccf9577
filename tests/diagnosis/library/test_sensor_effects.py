"""What readings say of sensors: play, delay and coarse grids recovered from readings made by their formulas."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from diagnosis.filter.filter_input import FilterInput, beginning, filter_input_of, late
from diagnosis.library import coarse_grid
from diagnosis.library.coarse_grid import coarse_step, grid_evidence
from diagnosis.library.effect_library import effect_library
from diagnosis.library.play import behind_play, pushing
from diagnosis.library.sensor_effects import sensed, unsure_when
from records.log import RunLog
from records.plant import load_plant
from sim.bind import bind
from sim.columns import log_columns
from sim.paths.path import played
from tests.diagnosis.arm import arm
from tests.soak import sampled

STEP = 1.5e-3


def filter_input(y: np.ndarray) -> FilterInput:
    rows = len(y)
    values = y[:, None]
    places = np.arange(rows)[:, None]
    return FilterInput(
        t_s=0.01 * np.arange(rows),
        u=np.zeros((rows, 1)),
        y=values,
        r=np.full(values.shape, STEP**2 / 12),
        read=values,
        standing=np.ones(values.shape),
        single=np.array([STEP**2 / 12]),
        row=np.arange(rows),
        place=places,
        rows=rows,
        usual=np.zeros(values.shape),
        lost=np.zeros(rows),
        loss_power=np.zeros(rows),
        untold_s=np.zeros(rows),
    )


def test_a_reading_of_unsure_time_is_as_unsure_as_its_rate_makes_it() -> None:
    # Truth: 2 ms at 0.3 rad/s are 0.6 mrad; where the axis stands, time does not matter.
    rows = np.arange(400)
    angle = STEP * np.round(0.003 * np.minimum(rows, 200) / STEP)
    found = unsure_when(filter_input(angle), 0, 2e-3, STEP**2 / 12).r[:, 0] - STEP**2 / 12
    np.testing.assert_allclose(found[10:190], (0.3 * 2e-3) ** 2, rtol=0.15)
    assert np.all(found[210:] == 0.0)
    # Noise that the readings had shown beside the step is that scatter, on average.
    noisy = replace(filter_input(angle), r=np.full((400, 1), 2 * STEP**2 / 12), single=np.array([2 * STEP**2 / 12]))
    assert unsure_when(noisy, 0, 2e-3, STEP**2 / 12).r.mean() == pytest.approx(2 * STEP**2 / 12)


def test_a_coarse_grid_is_seen_with_its_step() -> None:
    # 0.011 rad is no multiple of the encoder's step: read to a thousandth of itself.
    angle = 0.4 * np.sin(np.linspace(0.0, 30.0, 4000))
    coarse = 0.011 * np.round(angle / 0.011)
    read = STEP * np.round(coarse / STEP)
    assert coarse_step(read, STEP) == pytest.approx(0.011, rel=1e-3)
    assert grid_evidence(read, 0.011, STEP) > 100.0
    assert grid_evidence(read, 0.008, STEP) == 0.0


def test_a_grid_of_hundreds_of_thousands_of_steps_is_seen() -> None:
    # A carriage whose numbers have steps of 50 nm, read in steps of 16 mm, far from zero: thirteen readings in all.
    angle = 3.0 + 0.1 * np.sin(np.linspace(0.0, 30.0, 4000))
    assert coarse_step(0.016 * np.round(angle / 0.016), 5e-8) == pytest.approx(0.016, rel=1e-6)


def test_a_fine_encoder_has_no_coarse_grid() -> None:
    angle = 0.4 * np.sin(np.linspace(0.0, 30.0, 4000))
    assert coarse_step(STEP * np.round(angle / STEP), STEP) is None


@pytest.mark.parametrize("steps", sampled([1.7, 1.956, 2.046, 2.3], keep=[1.956, 2.3]))
def test_a_grid_of_about_two_steps_is_not_taken_for_its_twin(steps: float) -> None:
    # Grids of g and g / (g - 1) steps meet the same counts, but for rounding.
    angle = 1.2 * np.sin(np.linspace(0.0, 30.0, 4000)) ** 3
    coarse = steps * STEP * np.round(angle / (steps * STEP))
    assert coarse_step(STEP * np.round(coarse / STEP), STEP) == pytest.approx(steps * STEP, rel=1e-3)


@pytest.mark.parametrize("steps", sampled([1.7, 2.47, 4.3], keep=[2.47]))
def test_a_grid_whose_points_are_read_with_noise_is_found(steps: float) -> None:
    # Noise of a fifth of an encoder's step between both roundings: counts beside the grid's points are read as well.
    angle = 1.2 * np.sin(np.linspace(0.0, 30.0, 4000)) ** 3
    noise = np.random.default_rng(2).normal(0.0, 0.2 * STEP, 4000)
    read = STEP * np.round((steps * STEP * np.round(angle / (steps * STEP)) + noise) / STEP)
    assert coarse_step(read, STEP) == pytest.approx(steps * STEP, rel=1e-3)


def test_a_grid_so_coarse_that_few_points_of_it_are_read_is_found() -> None:
    angle = 0.35 + 0.25 * np.sin(np.linspace(0.0, 30.0, 4000))
    coarse = 75.3 * STEP
    read = STEP * np.round(coarse * np.round(angle / coarse) / STEP)
    assert len(np.unique(read)) < 7
    assert coarse_step(read, STEP) == pytest.approx(coarse, rel=3e-3)


@pytest.mark.parametrize("constant", ["STRAY", "ROUNDED", "AS_GOOD"])
@pytest.mark.parametrize("factor", [0.7, 1.4])
def test_what_the_search_for_a_grid_keeps_to_itself_decides_nothing(
    constant: str, factor: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Truth: a grid of 1.7 counts without noise and of 2.47 with it, one of 75.3 counts of which few points are read, and none."""
    wave, noise = np.sin(np.linspace(0.0, 30.0, 4000)), np.random.default_rng(2).normal(0.0, 0.2 * STEP, 4000)
    monkeypatch.setattr(coarse_grid, constant, factor * getattr(coarse_grid, constant))
    for steps, angle in ((1.7, 1.2 * wave**3), (2.47, 1.2 * wave**3), (75.3, 0.35 + 0.25 * wave)):
        grid = steps * STEP
        read = STEP * np.round((grid * np.round(angle / grid) + (noise if steps == 2.47 else 0.0)) / STEP)
        assert coarse_step(read, STEP) == pytest.approx(grid, rel=3e-3)
    assert coarse_step(STEP * np.round(0.4 * wave / STEP), STEP) is None


def test_a_swing_that_is_sampled_at_the_same_few_angles_has_no_grid() -> None:
    angle = np.tile(0.9 * np.sin(np.linspace(0.0, 2.0 * np.pi, 14, endpoint=False) + 0.3), 300)
    assert coarse_step(STEP * np.round(angle / STEP), STEP) is None


def test_an_axis_that_rests_between_two_counts_has_no_grid() -> None:
    places = np.repeat(np.random.default_rng(4).uniform(-0.5, 0.5, 30), 200)
    noise = np.random.default_rng(5).normal(0.0, 0.5 * STEP, len(places))
    assert coarse_step(STEP * np.round((places + noise) / STEP), STEP) is None


@pytest.mark.parametrize("share", [3 / 4, 3 / 5])
def test_counts_that_a_conversion_leaves_out_are_no_coarse_grid_of_five_thirds(share: float) -> None:
    # A board that turns counts of another sensor into its own leaves out one in four; and any count is within 2/3 of a step of such a grid.
    swing = np.random.default_rng(5).uniform(-0.9, 0.9, 400)
    read = STEP * np.floor(np.round(share * swing / STEP) / share)
    assert coarse_step(read, STEP) is None
    assert grid_evidence(read, 5 / 3 * STEP, STEP) == 0.0


def test_readings_that_turn_are_unsure_behind_play() -> None:
    # Up, still, down: between the last step up and the first step down the axis crosses the play.
    up, still, down = np.arange(50) * STEP, np.full(30, 49 * STEP), (49 - np.arange(1, 50)) * STEP
    way = pushing(np.concatenate([up, still, down]), STEP)  # a count back and forth is no reversal
    assert set(way[1:48]) == {1.0}
    assert set(way[50:79]) == {0.0}
    assert set(way[82:-1]) == {-1.0}


@pytest.mark.parametrize("tau_s", [0.004, 0.02, 0.0237])
def test_late_readings_are_put_back_to_when_they_were_true(tau_s: float) -> None:
    moved = late(filter_input(np.arange(100.0)), 0, tau_s)
    seen = np.isfinite(moved.y[:, 0])
    # Reading k was taken at 0.01 k s; those from before the log are lost.
    assert np.allclose(moved.t_s[seen], 0.01 * moved.y[seen, 0] - tau_s, atol=1e-6)
    assert np.array_equal(moved.place[seen, 0], moved.y[seen, 0].astype(int))
    assert seen.sum() >= 97


def test_the_beginning_of_late_readings_has_no_place_behind_its_rows() -> None:
    # Within the first 0.1 s are rows 0 to 10; readings 11 and 12, 20 ms late, were taken there too but belong to later rows.
    begun = beginning(late(filter_input(np.arange(100.0)), 0, 0.02), 0.1)
    assert begun.rows == 11
    assert begun.place.max() == 10
    assert np.nanmax(begun.y) == 12.0


def readings(y: np.ndarray) -> FilterInput:
    """Readings of one output of the CE150 that only an encoder of STEP rounds."""
    plant = load_plant(Path("plants/ce150.toml"))
    columns = log_columns(bind(plant).model)
    t_s = 0.01 * np.arange(len(y))
    log = RunLog(columns, 0.01, "closed", t_s, np.zeros((len(y), 2)), np.column_stack([y, y]))
    return filter_input_of(log, replace(plant, sensors={"psi_rad": STEP, "phi_rad": STEP}), list(columns.outputs))


def test_the_same_count_read_again_says_no_more_than_once() -> None:
    # n equal readings in a row are worth one reading: their weights 1/r add up to that of one, however many they are.
    y = STEP * np.repeat([0, 2, 6, 9], [1, 7, 30, 2]).astype(float)
    found = readings(y)
    for first, last in ((0, 1), (1, 8), (8, 38), (38, 40)):
        assert np.sum(1.0 / found.r[first:last, 0]) == pytest.approx(1.0 / found.single[0])


def test_rounding_alone_is_no_noise_and_noise_is_seen() -> None:
    # Rounding has STEP^2 / 12; white noise of two steps on top of it is seen to a tenth.
    rng = np.random.default_rng(3)
    angle = 0.3 * np.sin(np.linspace(0.0, 12.0, 6000))
    assert readings(STEP * np.round(angle / STEP)).single[0] == pytest.approx(STEP**2 / 12)
    noisy = angle + 2.0 * STEP * rng.standard_normal(6000)
    assert readings(STEP * np.round(noisy / STEP)).single[0] == pytest.approx(4.0 * STEP**2, rel=0.1)


def test_play_that_is_no_wider_than_what_noise_does_is_no_play() -> None:
    # A count back and forth, or noise of two steps over 6000 readings, some seventeen steps, hides play of as much; of 40 steps not.
    angle, rng = 0.3 * np.sin(np.linspace(0.0, 12.0, 6000)), np.random.default_rng(6)
    for noise, hidden in ((0.0, 0.9), (2.0, 16.0)):
        plain = readings(STEP * np.round(angle / STEP + noise * rng.standard_normal(len(angle))))
        assert behind_play(plain, 0, hidden * STEP, STEP) is plain
        assert np.any(behind_play(plain, 0, 40.0 * STEP, STEP).r > plain.r)


@pytest.mark.parametrize("noise", [0.0, 1.0, 2.0])
def test_noise_that_moves_counts_back_and_forth_is_no_reversal_behind_play(noise: float) -> None:
    # Truth: an angle that swings behind play of 40 steps, read with noise of so many steps. Where the axis is sure to push, what is made of
    # the readings is the angle, but for their noise: not half the play off to one side and the other.
    width, angle = 40.0 * STEP, 0.3 * np.sin(np.linspace(0.0, 12.0, 6000))
    rng = np.random.default_rng(6)
    read = played(angle, width, None)[0] + noise * STEP * rng.standard_normal(len(angle))
    plain = readings(STEP * np.round(read / STEP))
    behind = behind_play(plain, 0, width, STEP)
    sure = behind.r[:, 0] < 1.01 * plain.r[:, 0]
    assert sure.mean() > 0.6
    off = behind.y[sure, 0] - angle[sure]
    assert np.abs(off.mean()) < 0.02 * width
    assert np.mean(np.abs(off) > 0.25 * width) < 0.01


def test_play_charges_nothing_for_readings_that_stand_but_once_a_stretch() -> None:
    # What an interval costs as a bell of the same variance, ln sqrt(12 / 2 pi) = 0.32, for each stretch in which the axis may be anywhere:
    # the first reading, the top, the last one. Of an axis that moves three counts a row none lies beside an edge.
    up, still = 3.0 * STEP * np.arange(50), np.full(30, 147.0 * STEP)
    plain = readings(np.concatenate([up, still, up[::-1][1:]]))
    behind = behind_play(plain, 0, 20.0 * STEP, STEP)
    widened = plain.r[:, 0] < 0.99 * behind.r[:, 0]
    own = 0.5 * np.log(behind.r[widened, 0] / plain.r[widened, 0]).sum()
    assert behind.known - plain.known - own == pytest.approx(-0.32 * 3, abs=0.02)


def test_play_charges_for_standing_once_a_stretch() -> None:
    # What an interval costs as a bell of the same variance, ln sqrt(12 / 2 pi) = 0.32, for each stretch in which the axis may be anywhere:
    # the first readings, the top. A reading that is a count off its stretch costs 2 nats, half a step off an edge; each holds one at most.
    up, still = STEP * np.arange(50), np.full(30, 49 * STEP)
    plain = readings(np.concatenate([up, still, up[::-1][1:]]))
    behind = behind_play(plain, 0, 20.0 * STEP, STEP)
    widened = plain.r[:, 0] < 0.99 * behind.r[:, 0]
    own = 0.5 * np.log(behind.r[widened, 0] / plain.r[widened, 0]).sum()
    charged = plain.known + own - behind.known
    assert 2.0 * 0.32 < charged < 2.0 * (0.32 + 2.0)


def test_a_coarser_grid_brings_back_no_reading_of_an_axis_that_is_held() -> None:
    # Truth: the readings of a held axis count no more, so no size of a grid may change what the filter makes of them.
    library = effect_library(arm())
    held = replace(filter_input(np.zeros(40)), y=np.full((40, 1), np.nan))
    found = sensed(library, held, {"theta_sensor.quantization": {"q": 0.003}})
    assert np.isnan(found.y).all()
    assert np.array_equal(found.r, held.r)
    assert found.known == held.known
