"""What `design` and `simulate` tell of a table and of a flight, as text and as JSON."""

import json
import tomllib
from functools import cache
from pathlib import Path

import pytest

from twinlaw.command import main
from twinlaw.verbs import design, simulate
from twinlaw.workflows.chain.designing import design_controller


@pytest.fixture(scope="module", autouse=True)
def designed_once():
    """The controller of the one plant file here is designed for the first test that asks for it."""
    with pytest.MonkeyPatch.context() as patch:
        once = cache(design_controller)
        for verb in (design, simulate):
            patch.setattr(verb, "design_controller", once)
        yield


@pytest.mark.usefixtures("undrawn")
def test_design_tells_poles_as_designed_fitted_and_rounded_and_of_both_loops_coupled(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["design", "--out", str(tmp_path)]) == 0
    heading, _, elevation, azimuth, coupled, *_ = capsys.readouterr().out.splitlines()
    for words in (
        "designed",
        "after fit",
        "as float32",
        "at elevation",
        "Ms",
        "phase",
        "gain up / down",
        "delay",
        "fit error q",
    ):
        assert words in heading
    assert elevation.startswith("elevation")
    assert elevation.count("rad/s") == azimuth.count("rad/s") == 3
    assert coupled.startswith("both, coupled")
    assert coupled.count("rad/s") == 1


@pytest.mark.soak
def test_design_says_the_same_to_a_program(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["design", "--json", "--out", str(tmp_path)]) == 0
    said = json.loads(capsys.readouterr().out)
    assert said["coupled"]["worst_slowest_rad_s"] < 0.0
    for entry in said["poles"]:
        axis = entry["axis"]
        assert said["after_fit"][axis]["worst_slowest_rad_s"] == pytest.approx(entry["worst_slowest_rad_s"], abs=1e-3)
        assert 0.0 < said["fit_error"][axis]["q"] < 0.02
        assert said["worst_margins"][axis]["sensitivity"] > 1.0


def test_simulate_flies_and_tells_the_error_of_its_integration(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["simulate", "--json", "--out", str(tmp_path)]) == 0
    said = json.loads(capsys.readouterr().out)
    assert set(said["step_error_rad"]) == {"psi_rad", "phi_rad"}
    assert 0.0 < max(said["step_error_rad"].values()) < 1e-7
    assert tomllib.loads((tmp_path / "simulation.toml").read_text())["plant"] == "ce150"


@pytest.mark.soak
def test_simulate_says_the_same_to_a_person(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["simulate", "--out", str(tmp_path)]) == 0
    assert "error of one integration step a sample, by halving: psi_rad" in capsys.readouterr().out
