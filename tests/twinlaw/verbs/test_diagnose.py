"""`twinlaw diagnose` on logs that allow no conclusion: one clear line and exit status 2, or an honest verdict; its files where it can."""

import json
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from records.diagnosis import load_diagnosis
from records.log import RunLog, save_log
from records.plant import load_plant
from sim.bind import BoundPlant, bind
from sim.loop import fly_law
from sim.manoeuvres import flight
from tests.diagnosis.arm import arm_log
from tests.plants import bound, stated_table
from tests.soak import SOAK
from twinlaw.command import main
from twinlaw.workflows.diagnose.files import earlier_predictions, writable

PLANT = "plants/ce150.toml"
ARM = "plants/aeroshield.toml"  # whose equations are the smallest


@pytest.fixture(scope="module")
def rig() -> BoundPlant:
    return bound("ce150")


@pytest.fixture(scope="module")
def whole(rig: BoundPlant) -> RunLog:
    """The default flight, in which no air moves."""
    table = stated_table("ce150")
    return replace(fly_law(rig, table, flight(rig)), table_digest=None)


@pytest.fixture(scope="module")
def log(whole: RunLog) -> RunLog:
    """Twenty seconds of it."""
    return part(whole, slice(2000, 4000))


def part(log: RunLog, rows: slice) -> RunLog:
    extra: Mapping[str, np.ndarray] = {name: column[rows] for name, column in log.extra.items()}
    return replace(log, t_s=log.t_s[rows] - log.t_s[rows][0], u=log.u[rows], y=log.y[rows], extra=extra)


def diagnosed(folder: Path, *logs: RunLog, holdout: RunLog | None = None, plant: str = PLANT) -> int:
    names = []
    for index, entry in enumerate(logs):
        save_log(folder / f"run-{index}.csv", entry)
        names.append(str(folder / f"run-{index}.csv"))
    options = []
    if holdout is not None:
        save_log(folder / "hold.csv", holdout)
        options = ["--holdout", str(folder / "hold.csv")]
    return main(["diagnose", "--plant", plant, *options, "--out", str(folder / "out"), *names])


def refused(
    folder: Path,
    capsys: pytest.CaptureFixture[str],
    *logs: RunLog,
    holdout: RunLog | None = None,
    plant: str = PLANT,
) -> str:
    assert diagnosed(folder, *logs, holdout=holdout, plant=plant) == 2
    assert not (folder / "out").exists()
    lines = capsys.readouterr().err.strip().splitlines()
    assert len(lines) == 1
    return lines[0]


def test_ten_samples_are_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str], log: RunLog) -> None:
    assert "run-0" in refused(tmp_path, capsys, part(log, slice(0, 10)))


def test_a_hold_out_out_of_the_training_run_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], log: RunLog
) -> None:
    assert "hold" in refused(tmp_path, capsys, log, holdout=part(log, slice(500, 1500)))


def test_a_log_of_one_constant_gives_no_name(tmp_path: Path, log: RunLog) -> None:
    still = replace(log, u=np.tile(log.u[:1], (len(log.t_s), 1)), y=np.tile(log.y[:1], (len(log.t_s), 1)), extra={})
    if diagnosed(tmp_path, still) == 0:
        diagnosis = load_diagnosis(tmp_path / "out" / "diagnosis.json")
        assert diagnosis.found == ()


def test_noise_instead_of_angles_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str], log: RunLog) -> None:
    rng, log = np.random.default_rng(3), part(log, slice(0, 600))
    step = 1.5339807878856412e-3
    y = step * np.round(0.3 * rng.standard_normal(log.y.shape) / step)
    assert "from row to row" in refused(tmp_path, capsys, replace(log, y=np.clip(y, -0.7, 0.7), extra={}))


@pytest.mark.soak
def test_an_angle_with_the_wrong_sign_is_refused_by_name(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    log = arm_log(seconds=10.0)
    line = refused(tmp_path, capsys, replace(log, y=-log.y), plant=ARM)
    assert "theta_rad has the wrong sign" in line
    assert "turn the sign of theta_rad" in line


@pytest.mark.soak
def test_the_stated_plants_flight_from_rest_has_no_gap(tmp_path: Path, whole: RunLog) -> None:
    # It begins with rotors at rest, in still air: a filter that takes them to run sees a push there.
    assert diagnosed(tmp_path, whole if SOAK else part(whole, slice(0, 1500))) == 0
    assert load_diagnosis(tmp_path / "out" / "diagnosis.json").verdict == "no gap"


def test_the_stated_plants_own_run_has_no_gap_and_leaves_whole_files_in_the_folder_of_another(tmp_path: Path) -> None:
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "prediction-gone.csv").write_text("t_s\n")
    assert diagnosed(tmp_path, arm_log(seconds=9.0), holdout=arm_log(seed=2, seconds=5.0), plant=ARM) == 0
    content = json.loads((tmp_path / "out" / "diagnosis.json").read_text())
    assert content["verdict"] in ("no gap", "cannot tell")
    assert [path.name for path in (tmp_path / "out").glob("prediction-*")] == ["prediction-hold.csv"]
    rows = (tmp_path / "out" / "prediction-hold.csv").read_text().splitlines()
    assert rows[0] == "t_s,theta_rad,theta_nominal_rad,theta_before_rad,theta_after_rad"
    assert len(rows) == 501
    assert bind(load_plant(tmp_path / "out" / "plant.toml")).model.name == "aeroshield"


@pytest.mark.parametrize("below", ["file", "file/out", "/proc/xx/out"])
def test_a_folder_that_cannot_be_written_is_refused_before_the_work(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, log: RunLog, below: str
) -> None:
    monkeypatch.setattr("twinlaw.workflows.diagnose.together.read_material", lambda *_: pytest.fail("began to work"))
    (tmp_path / "file").write_text("in the way")
    save_log(tmp_path / "run.csv", log)
    for each in ([], ["--each"]):
        out = str(tmp_path / below)
        assert main(["diagnose", *each, "--plant", PLANT, "--out", out, str(tmp_path / "run.csv")]) == 2
        line = capsys.readouterr().err
        assert "output file" in line
        assert "choose another --out" in line
    assert (tmp_path / "file").read_text() == "in the way"


def interrupted_in(out: Path) -> bool:
    """Whether `out` was there when the work in it was interrupted."""
    there = False
    with suppress(KeyboardInterrupt), writable(out):
        there = out.is_dir()
        raise KeyboardInterrupt
    return there


def test_folders_made_for_a_run_that_fails_are_gone_again_and_others_are_left(tmp_path: Path) -> None:
    (tmp_path / "mine").mkdir()
    for out in (tmp_path / "mine" / "a" / "b", tmp_path / "mine"):
        assert interrupted_in(out)
        assert list(tmp_path.rglob("*")) == [tmp_path / "mine"]


def test_predictions_of_an_earlier_run_alone_are_removed(tmp_path: Path) -> None:
    names = ("prediction-new.csv", "prediction-old.csv", "prediction-log.csv", "prediction-log.toml", "other.csv")
    for name in names:
        (tmp_path / name).write_text("")
    assert earlier_predictions(tmp_path, {"prediction-new.csv"}) == [tmp_path / "prediction-old.csv"]
