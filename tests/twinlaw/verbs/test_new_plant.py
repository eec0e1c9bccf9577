"""`twinlaw new-plant`: what it writes is a plant that works as it is, in a folder anywhere."""

import json
from pathlib import Path

import numpy as np
import pytest

from records.plant import load_plant
from records.table import load_table
from sim.added_effects import library
from sim.bind import BoundPlant, bind
from sim.simulate import simulate
from twinlaw.command import main


@pytest.fixture
def arm(tmp_path: Path) -> BoundPlant:
    """The plant that the two files make."""
    assert main(["new-plant", "my_arm", "--out", str(tmp_path / "arm")]) == 0
    return bind(load_plant(tmp_path / "arm" / "plant.toml"))


def test_the_arm_swings_as_its_equation_says(arm: BoundPlant) -> None:
    # J theta'' = -tau_g theta - b theta' for small angles: omega^2 = tau_g / J - (b / 2 J)^2, decay b / 2 J.
    J, tau_g, b = (arm.parameter(name) for name in ("J", "tau_g", "b"))
    decay = b / (2.0 * J)
    omega = np.sqrt(tau_g / J - decay**2)
    t_s = np.arange(0.0, 2.0, 0.01)
    run = simulate(arm, t_s, x0=[1e-3, 0.0], drive=np.zeros((t_s.size, 1)), resolution=[0.0])
    assert run.y is not None
    expected = 1e-3 * np.exp(-decay * t_s) * (np.cos(omega * t_s) + decay / omega * np.sin(omega * t_s))
    np.testing.assert_allclose(run.y[:, 0], expected, rtol=0, atol=1e-8)


def test_a_controller_is_designed_for_it_at_once(tmp_path: Path) -> None:
    assert main(["new-plant", "my_arm", "--out", str(tmp_path / "arm")]) == 0
    assert main(["design", "--plant", str(tmp_path / "arm" / "plant.toml"), "--out", str(tmp_path)]) == 0
    assert [loop.axis for loop in load_table(tmp_path / "controller.json").loops] == ["arm"]


@pytest.mark.soak
def test_it_flies_at_once(tmp_path: Path) -> None:
    assert main(["new-plant", "my_arm", "--out", str(tmp_path / "arm")]) == 0
    assert main(["run", "--plant", str(tmp_path / "arm" / "plant.toml"), "--out", str(tmp_path)]) == 0
    assert (tmp_path / "run.csv").exists()


def test_the_library_has_effects_for_it(arm: BoundPlant) -> None:
    assert {"arm.coulomb", "input.deadzone", "theta_sensor.backlash"} <= set(library(arm))


def test_a_program_is_told_the_files(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)  # without --out: a folder of the plant's name
    assert main(["new-plant", "crane", "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == {"files": ["crane/crane.py", "crane/plant.toml"]}
    assert sorted(path.name for path in (tmp_path / "crane").iterdir()) == ["crane.py", "plant.toml"]


def refused(name: str, folder: Path, capsys: pytest.CaptureFixture[str]) -> str:
    """The line of the error; nothing is left behind."""
    assert main(["new-plant", name, "--out", str(folder / "out")]) == 2
    assert list(folder.iterdir()) == []
    return capsys.readouterr().err


@pytest.mark.parametrize("name", ["My arm", "2arm", "", "..", "../x", "arm\n", "a" * 65, "a" * 300 + "!"])
def test_a_name_that_no_module_can_have_is_refused(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert "name of a plant" in refused(name, tmp_path, capsys)


@pytest.mark.parametrize(
    "name", ["numpy", "sympy", "sim", "records", "test", "math", "list", "match", "class", "ce150"]
)
def test_a_name_that_hides_a_module_a_word_or_a_plant_is_refused(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    # A file begun in its own folder, as editors do, would import numpy.py where it asks for NumPy.
    assert f"write my_{name}" in refused(name, tmp_path, capsys)


@pytest.mark.parametrize("name", ["con", "nul", "aux", "prn", "com1", "lpt9"])
def test_a_name_that_no_file_can_have_on_windows_is_refused(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    # con.toml is the console there, whatever its ending: a checkout with such a file cannot be cloned.
    assert f"write my_{name}" in refused(name, tmp_path, capsys)


@pytest.mark.parametrize("mine", ["crane.py", "plant.toml"])
def test_what_is_there_is_not_touched(mine: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / mine).write_text("mine", encoding="utf-8")
    assert main(["new-plant", "crane", "--out", str(tmp_path)]) == 2
    assert mine in capsys.readouterr().err
    assert [path.read_text(encoding="utf-8") for path in tmp_path.iterdir()] == ["mine"]


def test_a_folder_that_cannot_be_written_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "out").write_text("a file where the folder should be", encoding="utf-8")
    assert main(["new-plant", "crane", "--out", str(tmp_path / "out")]) == 2
    assert "crane.py" in capsys.readouterr().err
