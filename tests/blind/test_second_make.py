"""A benchmark of the second rig: files that the contract's readers accept, truths that say what flew, the same bytes
for a seed."""

import re
from pathlib import Path

import numpy as np
import pytest

import blind
from blind import Benchmark, make
from blind.cases.sealed import open_seal
from records.errors import BadInput
from records.log import RunLog, load_log
from records.plant import load_plant
from sim.bind import bind
from sim.columns import log_columns
from sim.plants import MODELS
from tests.blind.conftest import PLANT, SECOND_SEED, comes_out_the_same
from tests.blind.conftest import SECOND_KINDS as MIX
from tests.soak import SOAK
from twinlaw.command import main

LENGTHS_S = (45.0, 76.0) if SOAK else (12.0, 15.0)
COLUMNS = log_columns(MODELS["ce150"]())


def logs(case: Path) -> list[RunLog]:
    return [load_log(path, COLUMNS) for path in sorted(case.glob("*.csv"))]


def test_every_case_is_logs_and_a_plant_that_the_records_read(second_folder: Path) -> None:
    """Counts of the stated encoders, commands within the controller's limits, lengths of 45 to 75 s, off the stops."""
    cases = sorted(second_folder.glob("case-*"))
    assert len(cases) == len(MIX)
    for case in cases:
        plant = load_plant(case / "plant.toml")
        bind(plant)
        runs = logs(case)
        assert {path.stem for path in case.glob("*.csv")} == {
            "hold-1",
            *(f"train-{n}" for n in range(1, len(runs))),
        }
        for log in runs:
            assert log.sample_period_s in (0.005, 0.01, 0.02)
            assert np.median(np.diff(log.t_s)) == pytest.approx(log.sample_period_s, rel=0.1)
            assert LENGTHS_S[0] - 1.0 < log.t_s[-1] - log.t_s[0] < LENGTHS_S[1]
            assert 0.0 <= log.u[:, 0].min() <= log.u[:, 0].max() <= 10.0
            assert np.abs(log.u[:, 1]).max() <= 10.0
            assert np.mean(np.abs(log.y[:, 0]) > np.pi / 4 - 7e-3) <= 0.1
            for index, name in enumerate(("psi_rad", "phi_rad")):
                counts = log.y[:, index] / plant.sensors[name]
                counts = counts[np.isfinite(counts)]
                np.testing.assert_allclose(counts, np.round(counts), atol=1e-6)


def test_the_plant_file_differs_in_spreads_encoders_and_absent_friction_alone(second_folder: Path) -> None:
    stated = PLANT.read_text().split("\n")
    for case in second_folder.glob("case-*"):
        lines = (case / "plant.toml").read_text().split("\n")
        assert len(lines) == len(stated)
        for new, old in zip(lines, stated, strict=True):
            assert new == old or re.match(r"(sd|resolution_rad|value) = ", new)
        given, known = load_plant(case / "plant.toml").parameters, load_plant(PLANT).parameters
        factors = {name: given[name].sd / known[name].sd for name in ("J_E", "K_M", "b_vA")}
        assert np.ptp(list(factors.values())) < 1e-3 * factors["J_E"]
        assert 0.5 <= factors["J_E"] <= 2.0
        assert {name for name in known if given[name].value != known[name].value} <= {"b_cE", "b_cA"}


def test_the_note_names_the_runs_that_are_there(second_folder: Path) -> None:
    for case in second_folder.glob("case-*"):
        named = set(re.findall(r"\w+-\d\.csv", (case / "README.md").read_text()))
        assert named == {path.name for path in case.glob("*.csv")}


def test_truths_hold_what_was_asked_for_and_no_case_tells_its_own(second_folder: Path) -> None:
    truths = open_seal(second_folder)
    assert {truth.kind for truth in truths.values()} == set(MIX)
    for truth in truths.values():
        assert (truth.severity > 0.0) == bool(truth.effects)
        for name, floor in truth.floor_rad.items():
            assert 2.0 * np.pi / 8192 / np.sqrt(12.0) < floor < 2e-2
            assert 0.0 < truth.hold.rms_true[name] < 0.2
    names = {effect.name for truth in truths.values() for effect in truth.effects}
    public = [path for path in second_folder.rglob("*") if path.is_file() and "sealed" not in path.parts]
    assert not [path for path in public if any(name in path.read_text() for name in (*names, "severity", "salt"))]


def test_a_case_comes_out_the_same_when_it_is_made_again(second_folder: Path) -> None:
    assert comes_out_the_same(second_folder, "second", MIX, SECOND_SEED)


def test_an_unknown_kind_of_rig_is_refused_and_nothing_stays_behind(tmp_path: Path) -> None:
    with pytest.raises(BadInput, match=r"--rig.*'third'.*first, second, real"):
        make(Benchmark(1, 5, rig="third"), tmp_path / "x")
    assert not list(tmp_path.iterdir())


def test_the_command_line_hands_on_which_kind_of_rig_is_asked_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["blind", "make", "--seed", "2", "--workers", "1", "--out", str(tmp_path / "x")]
    assert main([*words, "--rig", "third"]) == 2
    assert "first, second, real" in capsys.readouterr().err
    asked = []
    monkeypatch.setattr(blind, "make", lambda given, *_: asked.append(given.rig))
    for rig in ([], ["--rig", "first"], ["--rig", "second"], ["--rig", "real"]):
        assert main([*words, *rig]) == 0
    assert asked == ["first", "first", "second", "real"]
