"""`twinlaw new-plant`: what it writes is a plant that works as it is, in a folder anywhere."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from records.plant import load_plant
from records.table import ControllerTable, Schedule, load_table
from sim.added_effects import library
from sim.bind import BoundPlant, bind
from sim.simulate import Conditions, simulate
from tests.soak import sampled
from tests.test_project import ROOT
from twinlaw import design, load
from twinlaw.command import main
from twinlaw.workflows.new_plant import BEGINNINGS

# What each closes: the loop's name, its output and its input.
LOOPS = {
    "arm": ("arm", "theta_rad", "u_V"),
    "motor": ("shaft", "omega_rad_s", "u_V"),
    "heater": ("body", "T_K", "heat_W"),
    "tank": ("tank", "h_m", "u_V"),
}

SCHEDULE = (
    'schedule = "theta_rad"\ntheta_min_rad = -0.8\ntheta_max_rad = 0.8\noperating_points = 9\ncoefficient_degree = 2\n'
)
LEVELS = (
    SCHEDULE.replace("theta_rad", "h_m")
    .replace("theta_min_rad = -0.8", "h_min_m = 0.05")
    .replace("theta_max_rad = 0.8", "h_max_m = 0.4")
)
# A cart beside the arm, pushed by a force of its own: what each line of the files becomes.
CART_EQUATIONS = {
    'U = symbol("u_V")': 'U = symbol("u_V")\nQ, V, PUSH = symbol("q_m"), symbol("q_dot_m_s"), symbol("push_N")',
    "PARAMETERS = (": 'PARAMETERS = (\n    ParameterSpec("m", 1, "kg", "positive"),',
    "states=(THETA, OMEGA)": "states=(THETA, OMEGA, Q, V)",
    "inputs=(U,)": "inputs=(U, PUSH)",
    'outputs={"theta_rad": THETA}': 'outputs={"theta_rad": THETA, "q_m": Q}',
    "rates={THETA: OMEGA}": "rates={THETA: OMEGA, Q: V}",
    "axes=(Axis(": 'axes=(Axis("cart", Q, V, p["m"], PUSH, 0, None, None), Axis(',
    'input_limits={U: (-p["u_max"], p["u_max"])}': 'input_limits={U: (-p["u_max"], p["u_max"]), PUSH: (-5, 5)}',
    'inputs={"input"': 'inputs={"push": InputPlace(PUSH, "N", 5.0), "input"',
    'axes={"arm"': 'axes={"cart": AxisPlace("q_m", "N", 1.0, length_unit="m"), "arm"',
    'sensors={"theta_sensor"': 'sensors={"q_sensor": SensorPlace("q_m", "m", 0.5), "theta_sensor"',
}
CART_FILE = {
    "[sensors.theta_rad]": """[parameters.m]
value = 1.0
sd = 0.1
unit = "kg"
source = "a test"

[sensors.q_m]
resolution_m = 1e-4

[sensors.theta_rad]""",
    "[design.arm]\npoles_rad_s": """[design.cart]
output = "q_m"
input = "push_N"
poles_rad_s = [-2.0, -3.0, -4.0, -5.0]
reference_min_m = -0.3
reference_max_m = 0.3

[design.arm]
output = "theta_rad"
input = "u_V"
poles_rad_s""",
}


def begun(like: str, folder: Path) -> Path:
    """The plant file of a plant that begins so."""
    assert main(["new-plant", "mine", "--like", like, "--out", str(folder)]) == 0
    return folder / "plant.toml"


def change(path: Path, old: str, new: str) -> None:
    """Change the one place of a file."""
    text = path.read_text(encoding="utf-8")
    assert text.count(old) == 1, old
    path.write_text(text.replace(old, new), encoding="utf-8")


def designed(plant: Path) -> ControllerTable:
    """The table that `design` makes for it."""
    assert main(["design", "--plant", str(plant), "--out", str(plant.parent)]) == 0
    return load_table(plant.parent / "controller.json")


def schedule_of(plant: Path) -> Schedule | None:
    """What its table's coefficients go by; no page is drawn."""
    return design(load(plant)).table.schedule


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
    run = simulate(arm, t_s, x0=[1e-3, 0.0], drive=np.zeros((t_s.size, 1)), under=Conditions(resolution=[0.0]))
    assert run.y is not None
    expected = 1e-3 * np.exp(-decay * t_s) * (np.cos(omega * t_s) + decay / omega * np.sin(omega * t_s))
    np.testing.assert_allclose(run.y[:, 0], expected, rtol=0, atol=1e-8)


def test_the_motor_runs_as_fast_as_its_equations_say(tmp_path: Path) -> None:
    # At rest of both: u = R i + K omega and K i = b omega. The slowest pole is at -11 rad/s: after 3 s nothing is left of the start.
    motor = bind(load_plant(begun("motor", tmp_path)))
    R, K, b = (motor.parameter(name) for name in ("R", "K", "b"))
    run = simulate(motor, np.arange(601) * 0.005, x0=[0.0, 0.0], drive=np.full((601, 1), 6.0))
    assert run.x is not None
    assert run.x[-1, 1] == pytest.approx(6.0 * K / (R * b + K**2), rel=1e-6)


def test_the_heater_warms_as_its_equation_says(tmp_path: Path) -> None:
    # T = heat / G (1 - exp(-G t / C)) from the room's temperature on.
    heater = bind(load_plant(begun("heater", tmp_path)))
    C, G = (heater.parameter(name) for name in ("C", "G"))
    t_s = np.arange(601) * 0.1
    run = simulate(heater, t_s, x0=[0.0], drive=np.full((601, 1), 30.0))
    assert run.x is not None
    np.testing.assert_allclose(run.x[:, 0], 30.0 / G * (1.0 - np.exp(-G * t_s / C)), rtol=0, atol=1e-6)


def test_the_tank_runs_out_as_its_equation_says(tmp_path: Path) -> None:
    # sqrt(h) falls evenly, by a/A sqrt(g/2) a second, until the tank is empty, and stays there.
    tank = bind(load_plant(begun("tank", tmp_path)))
    A, a, g = (tank.parameter(name) for name in ("A", "a", "g"))
    t_s = np.arange(801) * 0.1
    run = simulate(tank, t_s, x0=[0.3], drive=np.zeros((801, 1)))
    assert run.x is not None
    root = np.maximum(np.sqrt(0.3) - a / A * np.sqrt(g / 2.0) * t_s, 0.0)
    np.testing.assert_allclose(run.x[:, 0], root**2, rtol=0, atol=1e-6)


def test_it_begins_as_an_arm_unless_told_otherwise(tmp_path: Path) -> None:
    assert set(LOOPS) == set(BEGINNINGS)
    begun("arm", tmp_path / "told")
    assert main(["new-plant", "mine", "--out", str(tmp_path / "untold")]) == 0
    for file in ("mine.py", "plant.toml"):
        assert (tmp_path / "untold" / file).read_bytes() == (tmp_path / "told" / file).read_bytes()


@pytest.mark.usefixtures("undrawn")
@pytest.mark.parametrize("like", sampled(BEGINNINGS, keep=["arm", "tank"]))
def test_a_controller_is_designed_and_generated_for_it_at_once(like: str, tmp_path: Path) -> None:
    table = designed(begun(like, tmp_path))
    assert [(loop.axis, loop.output, loop.input) for loop in table.loops] == [LOOPS[like]]
    assert main(["generate", "--table", str(tmp_path / "controller.json"), "--out", str(tmp_path)]) == 0
    assert table.digest in (tmp_path / "generated" / "law.h").read_text(encoding="utf-8")


@pytest.mark.soak
@pytest.mark.parametrize("like", BEGINNINGS)
def test_it_flies_at_once(like: str, tmp_path: Path) -> None:
    assert main(["run", "--plant", str(begun(like, tmp_path / "mine")), "--out", str(tmp_path)]) == 0
    assert (tmp_path / "run.csv").exists()


@pytest.mark.parametrize("like", BEGINNINGS)
def test_its_equations_keep_the_project_s_style(like: str, tmp_path: Path) -> None:
    begun(like, tmp_path / "sim" / "plants")  # where Ruff takes `sim` for one package with the file
    for words in (["check"], ["format", "--check"]):
        command = [str(Path(sys.executable).parent / "ruff"), *words, "--config", str(ROOT / "pyproject.toml")]
        done = subprocess.run([*command, str(tmp_path)], cwd=ROOT, capture_output=True, text=True)
        assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize(
    ("like", "schedule", "references"),
    [
        ("arm", SCHEDULE, "reference_min_rad = -0.5\nreference_max_rad = 0.5\n"),
        ("tank", LEVELS, "reference_min_m = 0.05\nreference_max_m = 0.4\n"),
    ],
)
def test_a_schedule_is_left_out_as_the_file_says(like: str, schedule: str, references: str, tmp_path: Path) -> None:
    plant = begun(like, tmp_path)
    change(plant, schedule, "")
    change(plant, f"[design.{like}]\n", f"[design.{like}]\n{references}")
    assert schedule_of(plant) is None


@pytest.mark.parametrize("like", ["motor", "heater"])
def test_a_schedule_is_put_in_as_the_file_says(like: str, tmp_path: Path) -> None:
    plant = begun(like, tmp_path)
    lines = plant.read_text(encoding="utf-8").splitlines(keepends=True)
    first = next(index for index, line in enumerate(lines) if line.startswith("# schedule"))
    lines[first : first + 5] = [line.removeprefix("# ") for line in lines[first : first + 5]]
    plant.write_text("".join(lines), encoding="utf-8")
    assert schedule_of(plant) is not None


@pytest.mark.soak
def test_another_axis_input_and_output_are_added_where_the_equations_say(tmp_path: Path) -> None:
    """Truth: a cart beside the arm takes these lines and no others; either is designed for, and the library knows both."""
    plant = begun("arm", tmp_path)
    for old, new in CART_EQUATIONS.items():
        change(tmp_path / "mine.py", old, new)
    for old, new in CART_FILE.items():
        change(plant, old, new)
    loops = [(loop.axis, loop.output, loop.input) for loop in designed(plant).loops]
    assert loops == [("cart", "q_m", "push_N"), LOOPS["arm"]]
    assert {"arm.coulomb", "cart.coulomb", "push.deadzone", "q_sensor.backlash"} <= set(
        library(bind(load_plant(plant)))
    )


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


def test_a_state_that_is_faster_than_a_sample_is_followed_and_told(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    # Truth: a winding of 0.5 ms, of which a sample of 10 ms is twenty; RK4 follows it to its rate in quarters of it, eighty a sample.
    assert main(["new-plant", "quick", "--like", "motor", "--out", str(tmp_path)]) == 0
    text = (tmp_path / "plant.toml").read_text(encoding="utf-8")
    text = text[: text.index("[design]")].replace("value = 0.01\nsd = 0.002", "value = 0.0005\nsd = 0.0001")
    (tmp_path / "plant.toml").write_text(text, encoding="utf-8")
    assert main(["simulate", "--plant", str(tmp_path / "plant.toml"), "--out", str(tmp_path)]) == 0
    assert "error of 80 integration steps a sample" in capsys.readouterr().out
    omega_rad_s = np.genfromtxt(tmp_path / "simulation.csv", delimiter=",", names=True)["omega_rad_s"]
    assert np.isfinite(omega_rad_s).all()
    assert np.ptp(omega_rad_s) > 10.0


def test_a_plant_that_is_known_is_flown_beside_what_was_identified_of_it(tmp_path: Path) -> None:
    """Truth: the heater's own log; the controller of the identified one flies both alike, to a tenth of a degree and a watt."""
    assert main(["new-plant", "heated", "--like", "heater", "--out", str(tmp_path)]) == 0
    plant, out = str(tmp_path / "plant.toml"), tmp_path / "out"
    assert main(["simulate", "--plant", plant, "--out", str(out)]) == 0
    assert main(["identify", "--plant", plant, "--truth", plant, "--out", str(out), str(out / "simulation.csv")]) == 0
    flown = json.loads((out / "identification.json").read_text())["flight_rms"]
    assert set(flown) == {"T_K", "heat_W"}
    assert 0.0 <= flown["T_K"] < 0.1
    assert flown["heat_W"] < 1.0
    report = (out / "report.html").read_text()
    assert not [word for word in ("elevation", "azimuth", "psi", "u_M") if word in report]
