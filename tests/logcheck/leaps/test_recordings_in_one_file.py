"""Several recordings in one file, by clocks, counters or leaps, and readings that stop where no jump shows; honest logs are left whole."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from logcheck.integrity import examine
from logcheck.leaps.seams import seam_findings
from logcheck.stands.dead import dead_findings, read_again
from recordings.datasets.files import datasets_folder
from recordings.datasets.library import IMPORTERS, import_record, records
from records.errors import BadInput
from records.log import RunLog, load_log, save_log
from records.logs.restarts import restart_rows
from sim.columns import log_columns
from sim.manoeuvres import stir
from sim.simulate import Conditions, simulate
from tests.logcheck.test_parts import PLANT, STEP_RAD, STEPS, log_of, rounded
from tests.plants import bound

POSITIONS = ("psi_rad", "phi_rad")
PLAYED = (
    1,
    7,
    9,
    13,
)  # of 120 seeds the first four of the 26 in which a turn had passed for a sensor that was not read


def in_one_file(folder: Path, *logs: RunLog, header: bool = False) -> Path:
    """The logs as one file, each with its own times; with `header`, each with its header too."""
    texts = []
    for index, log in enumerate(logs):
        save_log(folder / f"{index}.csv", log)
        texts.append((folder / f"{index}.csv").read_text())
    rest = texts[1:] if header else [text.partition("\n")[2] for text in texts[1:]]
    (folder / "log.csv").write_text("".join([texts[0], *rest]))
    (folder / "log.toml").write_text((folder / "0.toml").read_text())
    return folder / "log.csv"


def begins(log: RunLog) -> list[int]:
    return np.flatnonzero(examine([log], PLANT, names=["log"]).logs[0].begins).tolist()


@pytest.mark.parametrize("header", [False, True])
def test_times_that_begin_again_begin_another_log(tmp_path: Path, header: bool) -> None:
    """Truth: 20 s from 0 s on, then 8 s from 0 s on, then 8 s from 5 s on."""
    first = log_of(2000)
    later = replace(log_of(800), t_s=5.0 + 0.01 * np.arange(800))
    log = load_log(in_one_file(tmp_path, first, log_of(800), later, header=header), first.columns)
    assert begins(log) == [2000, 2800]
    assert np.diff(log.t_s).min() > 0.0
    assert [(entry.at_s, entry.own_s) for entry in log.mended.restarts] == [(21.0, 0.0), (30.0, 5.0)]
    (found,) = examine([log], PLANT, names=["log"]).findings
    assert found.kind == "restart"
    assert "at 0 s behind 19.99 s, which counts as 21 s here" in found.sentence


def with_rows(folder: Path, log: RunLog, rows: list[int]) -> Path:
    path = in_one_file(folder, log)
    lines = path.read_text().splitlines()
    path.write_text("\n".join([lines[0], *(lines[row + 1] for row in rows)]) + "\n")
    return path


@pytest.mark.parametrize(
    ("rows", "kept", "told"),
    [
        ([*range(200), 150, *range(200, 300)], 300, "1 row whose time does not rise, first at 1.5 s; left out"),
        ([*range(290), *range(20)], 290, "20 rows whose time does not rise, first at 0 s; left out"),
        ([*range(100), *range(80, 200)], 200, "20 rows whose time does not rise, first at 0.8 s; left out"),
    ],
)
def test_a_few_rows_out_of_order_are_no_recording_and_left_out(
    rows: list[int], kept: int, told: str, tmp_path: Path
) -> None:
    log = log_of(300)
    read = load_log(with_rows(tmp_path, log, rows), log.columns)
    np.testing.assert_array_equal(read.y, log.y[:kept])
    assert f"t_s: {told}" in [found.sentence for found in examine([read], PLANT, names=["log"]).findings]


def test_stamps_coarser_than_the_rows_lose_no_sample_and_no_command(tmp_path: Path) -> None:
    """Truth: rows 0.5 ms apart whose file has their milliseconds; readings and commands of all are kept, and it is told."""
    log = log_of(2000)
    log = replace(log, sample_period_s=0.0005, t_s=np.floor(np.arange(2000) * 0.5) * 1e-3)
    read = load_log(in_one_file(tmp_path, log), log.columns)
    np.testing.assert_array_equal(np.hstack([read.y, read.u]), np.hstack([log.y, log.u]))
    np.testing.assert_allclose(read.t_s, 0.0005 * np.arange(2000), atol=1e-3)
    assert np.diff(read.t_s) == pytest.approx(0.0005, rel=1e-3)
    assert "coarse_stamps" in {found.kind for found in examine([read], PLANT, names=["log"]).findings}


def test_a_clock_that_is_back_for_three_rows_begins_no_other_recording(tmp_path: Path) -> None:
    """Truth: one recording, of which three rows bear a time 3 s too early, more than a short recording lasts."""
    log = log_of(1500)
    t_s = log.t_s.copy()
    t_s[700:703] -= 3.0
    read = load_log(in_one_file(tmp_path, replace(log, t_s=t_s)), log.columns)
    assert (len(read.t_s), read.t_s[-1], read.mended.restarts) == (1497, log.t_s[-1], ())
    assert read.mended.disordered is not None
    assert read.mended.disordered.rows == 3


@pytest.mark.parametrize("rows", [[*range(300)][::-1], [*range(100), *range(60, 160), *range(120, 300)]])
def test_more_than_a_tenth_of_the_rows_out_of_order_are_refused(rows: list[int], tmp_path: Path) -> None:
    log = log_of(300)
    with pytest.raises(BadInput, match="a time that increases"):
        load_log(with_rows(tmp_path, log, rows), log.columns)


def test_sequence_numbers_that_begin_again_begin_another_log_and_a_counter_at_its_end_does_not(tmp_path: Path) -> None:
    log = log_of(2000)
    anew = np.concatenate([np.arange(1200), np.arange(800)])
    assert begins(replace(log, seq=anew)) == [1200]
    path = in_one_file(tmp_path, replace(log, seq=(65_000 + np.arange(2000)) % 65_536))
    whole = load_log(path, log.columns)
    assert whole.seq is not None
    assert np.all(np.diff(whole.seq) == 1)
    assert begins(whole) == []
    assert restart_rows(np.arange(9.0)).size == 0


def test_rows_in_front_of_an_input_s_first_number_are_left_out_in_each_recording(tmp_path: Path) -> None:
    """Truth: u_T_V begins 1.2 s behind the outputs, in the second recording 0.3 s; both are told, and no other row is lost."""
    log = log_of(1000)
    path = in_one_file(tmp_path, log, log)
    lines = path.read_text().splitlines()
    late = [*range(120), *range(1000, 1030)]
    for row in late:
        cells = lines[row + 1].split(",")
        lines[row + 1] = ",".join([*cells[:2], "", *cells[3:]])
    path.write_text("\n".join(lines) + "\n")
    read = load_log(path, log.columns)
    assert len(read.t_s) == 2000 - len(late)
    assert np.isfinite(read.u).all()
    assert begins(read) == [880]
    told = {entry.kind: entry.sentence for entry in examine([read], PLANT, names=["log"]).findings}
    assert set(told) == {"late_input", "restart"}
    assert [(late.column, late.begins_s, late.rows) for late in read.mended.late_inputs] == [
        ("u_T_V", 1.2, 120),
        ("u_T_V", 11.3, 30),
    ]
    lines[500] = lines[500].replace(lines[500].split(",")[1], "nan", 1)
    path.write_text("\n".join(lines) + "\n")
    with pytest.raises(BadInput, match="line 501"):
        load_log(path, log.columns)


def second_run(log: RunLog, row: int) -> RunLog:
    """The log up to a row, at which the azimuth is back where it began, and then from its first row on: the rig started again."""
    rows = np.r_[0:row, 0 : len(log.t_s) - row]
    phi = rounded(0.2 * np.sin(2.0 * np.pi / row * np.arange(len(rows))))
    return replace(log, u=log.u[rows], y=np.column_stack([log.y[rows, 0], phi]))


def test_a_run_that_begins_where_the_first_began_is_another_one_though_one_output_leaps_alone() -> None:
    log = second_run(log_of(), 780)  # elevation 0.3 rad from where it began
    (found,) = seam_findings(log, "a", STEPS, read_again(log), POSITIONS)
    assert found.begins is not None
    assert np.flatnonzero(found.begins).tolist() == [780]
    assert "the log leaps between 7.79 s and 7.8 s, psi_rad by" in found.finding.sentence


@pytest.mark.parametrize("told_by", ["a reference", "an input in an open loop"])
def test_one_output_that_leaps_with_a_reference_or_an_open_loop_s_input_is_another_run(told_by: str) -> None:
    log = log_of()
    rows = np.arange(2000) >= 900
    log.y[rows, 0] += 80 * STEP_RAD
    (either,) = seam_findings(log, "a", STEPS, read_again(log), POSITIONS)  # its sensor may have slipped
    assert (either.finding.kind, either.begins) == ("lone_leap", None)
    assert "psi_rad alone leaps at 9 s" in either.finding.sentence
    if told_by == "a reference":
        other = replace(log, extra={"psi_ref_rad": np.where(rows, 0.2, -0.2)})
    else:
        other = replace(log, loop="open", u=log.u + np.where(rows, 2.0, 0.0)[:, None])
    (found,) = seam_findings(other, "a", STEPS, read_again(other), POSITIONS)
    assert found.begins is not None
    assert np.flatnonzero(found.begins).tolist() == [900]


@pytest.mark.parametrize("rest_s", [0.5, 3.0])
@pytest.mark.parametrize("told_by", ["references", "the first row", "both outputs"])
def test_a_flight_that_ends_at_rest_is_cut_from_the_one_behind_it(told_by: str, rest_s: float) -> None:
    """Truth: both axes come to rest and stand, then another flight begins where the first did, or elsewhere."""
    first = log_of(1400)
    rest = round(rest_s / 0.01)
    rows = np.concatenate([np.arange(1400), np.full(rest, 1399), np.arange(400)])
    away = np.where(np.arange(len(rows)) < 1400 + rest, 0.0, 90 * STEP_RAD * (told_by == "both outputs"))
    reference = np.where(np.arange(len(rows)) < 1400 + rest, 0.2, -0.2)
    extra = {"psi_ref_rad": reference} if told_by == "references" else {}
    log = replace(first, t_s=0.01 * np.arange(len(rows)), u=first.u[rows], y=first.y[rows] + away[:, None], extra=extra)
    assert np.flatnonzero(examine([log], PLANT, names=["log"]).logs[0].begins).tolist() == [1400 + rest]


def test_an_axis_that_rests_at_once_where_another_leaps_begins_another_log() -> None:
    """Truth: the flight ends at 1 rad/s; in the next psi begins 60 steps away and phi about where it was, both from rest."""
    first = log_of(1400)
    first.y[:] = rounded(0.9 * np.sin(np.column_stack([1.3 * first.t_s, 0.9 * first.t_s])))
    begun = 0.3 * (1.0 - np.cos(1.3 * first.t_s[:400, None])) + first.y[-1] + [60 * STEP_RAD, 0.0]
    y, u = np.vstack([first.y, rounded(begun)]), np.vstack([first.u, first.u[-400:]])
    assert begins(replace(first, t_s=0.01 * np.arange(1800), u=u, y=y)) == [1400]


@pytest.mark.parametrize("period_s", [0.02, 0.01, 0.002])
def test_readings_that_stop_and_go_on_within_four_counts_of_there_are_left_out(period_s: float) -> None:
    """Truth: a sine of 0.5 rad is not read for the half of its period after which it is back; without that nothing is told."""
    t_s = np.arange(0.0, 12.0, period_s)
    psi = rounded(0.5 * np.sin(2.5 * t_s))
    plain = log_of(len(t_s))
    log = replace(plain, t_s=t_s, sample_period_s=period_s, y=np.column_stack([psi, plain.y[:, 1]]))
    assert list(dead_findings(log, "a", STEPS, np.zeros(len(t_s), bool), POSITIONS)) == []
    start_s = (2.0 * np.pi + 0.4) / 2.5
    unread = (t_s > start_s) & (t_s < start_s + (np.pi - 0.8) / 2.5)  # from 0.4 rad of phase up and down again
    first = int(np.argmax(unread))
    log.y[unread, 0] = psi[first]
    assert abs(psi[unread.nonzero()[0][-1] + 1] - psi[first]) < 4.0 * STEP_RAD + 0.5 * 2.5 * period_s
    (found,) = dead_findings(log, "a", STEPS, np.zeros(len(t_s), bool), POSITIONS)
    assert found.excluded is not None
    assert found.excluded[unread].mean() > 0.9
    assert found.excluded.sum() <= unread.sum() + 1
    assert " a second just before" in found.finding.sentence


def with_play(psi: NDArray[np.float64], width_rad: float) -> NDArray[np.float64]:
    """Angles read behind play of that width."""
    shown, found = float(psi[0]), []
    for angle in psi.tolist():
        shown = min(max(shown, angle - 0.5 * width_rad), angle + 0.5 * width_rad)
        found.append(shown)
    return np.array(found)


@pytest.mark.parametrize("seed", PLAYED)
def test_an_axis_that_turns_back_in_its_play_is_read(seed: int) -> None:
    """Truth: four slow sines behind play of eight counts: the reading stands where the axis turns, and no row of it is old."""
    rng = np.random.default_rng(seed)
    t_s = np.arange(0.0, 40.0, 0.01)
    rates_rad_s, begun_rad = 0.3 + 0.45 * np.arange(4) * rng.uniform(0.7, 1.3, 4), rng.uniform(0.0, 6.0, 4)
    psi = sum(0.3 / (k + 1) * np.sin(rates_rad_s[k] * t_s + begun_rad[k]) for k in range(4))
    plain = log_of(len(t_s))
    log = replace(plain, t_s=t_s, y=np.column_stack([rounded(with_play(psi, 8 * STEP_RAD)), plain.y[:, 1]]))
    assert list(dead_findings(log, "a", STEPS, np.zeros(len(t_s), bool), POSITIONS)) == []


@pytest.mark.parametrize("plant", ["maglev_coil", "aeroshield"])
def test_a_current_that_settles_and_an_arm_that_an_input_sets_going_are_read(plant: str) -> None:
    # Truth: a simulated run without noise, every reading of it sound; the input's steps set off all that moves.
    rig = bound(plant)
    moved = stir(rig)
    y = simulate(rig, moved.t_s, moved.x0, moved.u, Conditions(keep="y")).y
    assert y is not None
    step = rig.plant.sensors[next(iter(rig.model.outputs))]
    log = RunLog(log_columns(rig.model), 0.01, "open", moved.t_s, moved.u, step * np.round(y / step))
    assert {entry.kind for entry in examine([log], rig, names=["log"]).findings} <= {"saturated"}


@pytest.mark.soak
@pytest.mark.parametrize("dataset", IMPORTERS)
def test_no_recording_of_a_rig_is_cut_where_rows_follow_one_another_or_loses_a_reading(dataset: str) -> None:
    if not (datasets_folder() / dataset).is_dir():
        pytest.skip(f"no recordings in {datasets_folder()}: see recordings/datasets/registry.toml")
    for record in records(dataset):
        log = import_record(dataset, record)
        found = examine([log], bound(log.columns.plant), names=[record])
        assert {entry.kind for entry in found.findings} <= KINDS_OF_HONEST_LOGS, (record, found.findings)
        assert not found.logs[0].unread.any()
        assert not found.logs[0].excluded.any()


KINDS_OF_HONEST_LOGS = {"break", "constant", "jitter", "missing_rows", "not_a_number", "not_recorded", "other_grid"}
KINDS_OF_HONEST_LOGS |= {"sample_period", "saturated", "simulated", "simulated_looking"}
