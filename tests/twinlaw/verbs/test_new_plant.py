"""`twinlaw new-plant`: what it writes is a plant that works as it is."""

import importlib.util
import json
import sys
from pathlib import Path

import numpy as np
import pytest

from records.plant import load_plant
from sim.added_effects import library
from sim.bind import BoundPlant, bind
from sim.plants import MODELS
from sim.simulate import simulate
from twinlaw.command import main

REGISTER = "sim/plants/__init__.py"


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """A folder that looks like a checkout."""
    (tmp_path / "sim" / "plants").mkdir(parents=True)
    (tmp_path / "plants").mkdir()
    (tmp_path / REGISTER).write_text("MODELS = {}\n", encoding="utf-8")
    return tmp_path


@pytest.fixture
def arm(project: Path, monkeypatch: pytest.MonkeyPatch) -> BoundPlant:
    """The plant that the two files make once the register knows it."""
    assert main(["new-plant", "my_arm", "--project", str(project)]) == 0
    spec = importlib.util.spec_from_file_location("my_arm", project / "sim" / "plants" / "my_arm.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    monkeypatch.setitem(sys.modules, "my_arm", module)
    spec.loader.exec_module(module)
    monkeypatch.setitem(MODELS, "my_arm", module.model)  # type: ignore[arg-type]
    return bind(load_plant(project / "plants" / "my_arm.toml"))


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


def test_the_library_has_effects_for_it(arm: BoundPlant) -> None:
    assert {"arm.coulomb", "input.deadzone", "theta_sensor.backlash"} <= set(library(arm))


def test_a_program_is_told_files_and_rows(project: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["new-plant", "crane", "--project", str(project), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert [Path(path).is_file() for path in told["files"]] == [True, True]
    assert told["rows"] == ["    crane,", '    "crane": crane.model,']


@pytest.mark.parametrize("name", ["My arm", "2arm", "class", "", "..", "../x", "arm\n", "a" * 65, "a" * 300 + "!"])
def test_a_name_that_no_module_can_have_is_refused(
    name: str, project: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["new-plant", name, "--project", str(project)]) == 2
    assert "name of a plant" in capsys.readouterr().err
    assert list((project / "plants").iterdir()) == []


@pytest.mark.parametrize("name", ["numpy", "sympy", "sim", "records", "test", "math", "list", "match"])
def test_a_name_that_hides_a_module_or_a_word_of_python_is_refused(
    name: str, project: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    # A file begun in its own folder, as editors do, would import sim/plants/numpy.py where it asks for NumPy.
    assert main(["new-plant", name, "--project", str(project)]) == 2
    assert f"write my_{name}" in capsys.readouterr().err
    assert list((project / "plants").iterdir()) == []


@pytest.mark.parametrize("name", ["con", "nul", "aux", "prn", "com1", "lpt9"])
def test_a_name_that_no_file_can_have_on_windows_is_refused(
    name: str, project: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    # con.toml is the console there, whatever its ending: a checkout with such a file cannot be cloned.
    assert main(["new-plant", name, "--project", str(project)]) == 2
    assert f"write my_{name}" in capsys.readouterr().err
    assert list((project / "plants").iterdir()) == []


def test_a_second_file_that_cannot_be_written_leaves_none(project: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (project / "plants").rmdir()
    (project / "plants").write_text("a file where the folder should be", encoding="utf-8")
    assert main(["new-plant", "crane", "--project", str(project)]) == 2
    assert "crane.toml" in capsys.readouterr().err
    assert not (project / "sim" / "plants" / "crane.py").exists()


def test_what_is_there_is_not_touched(project: Path, capsys: pytest.CaptureFixture[str]) -> None:
    mine = project / "plants" / "crane.toml"
    mine.write_text("mine", encoding="utf-8")
    assert main(["new-plant", "crane", "--project", str(project)]) == 2
    assert mine.read_text(encoding="utf-8") == "mine"
    assert not (project / "sim" / "plants" / "crane.py").exists()


def test_a_folder_that_is_no_checkout_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["new-plant", "crane", "--project", str(tmp_path)]) == 2
    assert "checkout" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []
