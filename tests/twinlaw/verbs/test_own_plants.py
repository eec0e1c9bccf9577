"""Every verb on plants of one's own: what two files can express works, or is refused in words."""

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from identification.runs.rows import trimmed
from records.errors import BadInput
from records.log import RunLog, load_log
from records.plant import load_plant, save_plant
from sim.added_effects import library, with_effects
from sim.bind import bind
from sim.columns import log_columns
from sim.manoeuvres import at_rest
from sim.simulate import Conditions, simulate
from tests.own_plants import PLAIN, REFUSED, WORKING, OwnPlant
from tests.soak import sampled
from twinlaw import diagnose, fly, identify
from twinlaw.command import main

# What each rig has and its plant file has not; where nothing is said, the arm rubs.
RIGS = {"coil": "input.deadzone", "two_axes": "post.coulomb", "no_rotors": "post.coulomb", "elastic": "motor.coulomb"}
ENDS = "reference_min_rad = -0.5\nreference_max_rad = 0.5\n"
SIZES = {"deadzone": 1.0, "coulomb": 0.03}  # V and N m


def simulated(name: str, folder: Path) -> Path:
    """A log of the plant as `simulate` runs it, without a loop; the plant's files lie in `folder`."""
    plant = WORKING[name].write(folder, f"my_{name}")
    assert main(["simulate", "--plant", str(plant), "--out", str(folder / "run")]) == 0
    return folder / "run" / "simulation.csv"


@pytest.mark.soak
@pytest.mark.parametrize("name", sampled(list(WORKING), {"coil"}))
def test_a_plant_runs_and_its_parameters_come_back(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log = simulated(name, tmp_path)
    assert capsys.readouterr().out.startswith(f"no controller: the plant of my_{name} names no loops in [design]")
    bound = bind(load_plant(tmp_path / "plant.toml"))
    read = load_log(log, log_columns(bound.model))
    assert read.loop == "open"
    assert read.y.shape == (2001, len(bound.model.outputs))
    # Truth: the log is of the plant as it is stated, so every estimate is its parameter within 5 of its own sd.
    assert main(["identify", "--plant", str(tmp_path / "plant.toml"), "--out", str(tmp_path / "id"), str(log)]) == 0
    found = load_plant(tmp_path / "id" / "plant.toml")
    assert found.equations == bound.plant.equations
    for key, entry in found.parameters.items():
        stated = bound.plant.parameters[key]
        assert abs(entry.values[0] - stated.values[0]) <= 5.0 * max(*entry.sds, 1e-3 * stated.values[0]), key


@pytest.mark.soak
@pytest.mark.parametrize("name", WORKING)
def test_what_a_rig_has_and_its_plant_has_not_is_a_gap(name: str, tmp_path: Path) -> None:
    plant = WORKING[name].write(tmp_path, f"my_{name}")
    bound = bind(load_plant(plant))
    effect = RIGS.get(name, "arm.coulomb")
    found = library(bound)[effect]
    given = {entry.symbol: SIZES[found.kind] if entry.is_size else entry.reference for entry in found.parameters}
    save_plant(tmp_path / "rig" / "plant.toml", with_effects(bound, {effect: given}).plant)
    assert main(["simulate", "--plant", str(tmp_path / "rig" / "plant.toml"), "--out", str(tmp_path / "run")]) == 0
    log = str(tmp_path / "run" / "simulation.csv")
    assert main(["diagnose", "--plant", str(plant), "--out", str(tmp_path / "found"), log]) == 0
    answer = json.loads((tmp_path / "found" / "diagnosis.json").read_text(encoding="utf-8"))
    assert answer["verdict"] == "gap"
    # The improved plant is a folder of its own, which every verb takes.
    assert (
        main(["diagnose", "--plant", str(tmp_path / "found" / "plant.toml"), "--out", str(tmp_path / "again"), log])
        == 0
    )
    again = json.loads((tmp_path / "again" / "diagnosis.json").read_text(encoding="utf-8"))
    assert again["verdict"] != "gap"


@pytest.mark.parametrize(
    "verb",
    sampled(
        ["diagnose", "diagnose --each", "identify", "splits", "watch --port"], {"diagnose", "identify", "watch --port"}
    ),
)
def test_a_refusal_is_one_line_with_the_line_of_the_equations(
    verb: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    plant, told = REFUSED["no_moment"]
    path = plant.write(tmp_path, "my_arm")
    (tmp_path / "log.csv").write_text("t_s,u_V,theta_rad\n0.0,0.0,0.0\n", encoding="utf-8")
    (tmp_path / "log.toml").write_text('schema = "run-log/1"\nplant = "my_arm"\n', encoding="utf-8")
    words = verb.split()
    asked = [words[0], "--plant", str(path), "--out", str(tmp_path / "out"), *words[1:], str(tmp_path / "log.csv")]
    assert main(asked) == 2
    error = capsys.readouterr().err
    assert told in error
    assert "my_arm.py, line " in error
    assert error.count("\n") == 1


@pytest.mark.parametrize(
    "verb", ["run", "design", "design --controller lqg", "sweep", "compare", "bench", "experiments"]
)
def test_what_cannot_be_flown_yet_says_so(verb: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = WORKING["plain"].write(tmp_path / "arm", "my_plain")
    words = verb.split()
    asked = [*words, "--plant", str(path)] + ([] if verb == "bench" else ["--out", str(tmp_path / "out")])
    assert main(asked) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert "fault of twinlaw" not in error
    assert not (tmp_path / "out").exists()


def test_equations_without_a_slope_at_rest_are_told_as_such(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    # Truth: the root of an angle has no slope at 0, where the arm is put to rest; no parameter is wrong.
    root = OwnPlant(PLAIN.parameters, PLAIN.sensors, PLAIN.body.replace("sympy.sin(theta)", "sympy.sqrt(theta)"))
    path = root.write(tmp_path, "my_root")
    path.write_text(f"{path.read_text()}\n[design.arm]\npoles_rad_s = [-3, -4, -8, -10]\n{ENDS}")
    assert main(["design", "--plant", str(path), "--out", str(tmp_path / "out")]) == 2
    assert "a root or a quotient without a slope at rest" in capsys.readouterr().err


def test_an_import_of_a_table_takes_the_plant(tmp_path: Path) -> None:
    path = WORKING["plain"].write(tmp_path, "my_plain")
    rows = "".join(f"{0.01 * k:.2f},{k % 7},{0.001 * k}\n" for k in range(200))
    (tmp_path / "other.csv").write_text("time [s],u_V,theta_rad\n" + rows, encoding="utf-8")
    asked = [
        "import",
        str(tmp_path / "other.csv"),
        "--plant",
        str(path),
        "--column",
        "t_s=time",
        "--out",
        str(tmp_path / "log.csv"),
    ]
    assert main(asked) == 0
    log = load_log(tmp_path / "log.csv", log_columns(bind(load_plant(path)).model))
    assert log.columns.plant == "my_plain"
    assert log.y.shape == (200, 1)


@pytest.mark.soak
def test_a_helicopter_s_equations_elsewhere_are_designed_for(tmp_path: Path) -> None:
    # Truth: the same equations under another name give the same law; the table says which text it is of.
    (tmp_path / "my_heli.py").write_text(
        "from dataclasses import replace\n\nfrom sim.model import Model\nfrom sim.plants import ce150\n\n\n"
        'def model() -> Model:\n    return replace(ce150.model(), name="my_heli")\n',
        encoding="utf-8",
    )
    text = Path("plants/ce150.toml").read_text(encoding="utf-8").replace('model = "ce150"', 'equations = "my_heli.py"')
    (tmp_path / "plant.toml").write_text(text, encoding="utf-8")
    assert main(["design", "--plant", str(tmp_path / "plant.toml"), "--out", str(tmp_path / "mine")]) == 0
    assert main(["design", "--plant", "plants/ce150.toml", "--out", str(tmp_path / "own")]) == 0
    mine, own = (
        json.loads((tmp_path / out / "controller.json").read_text(encoding="utf-8")) for out in ("mine", "own")
    )
    assert mine["elevation"] == own["elevation"]
    assert mine["azimuth"] == own["azimuth"]
    assert mine["origin"]["plant_digest"] != own["origin"]["plant_digest"]


@pytest.mark.soak
def test_a_third_of_a_second_of_a_fast_motor_names_its_dry_friction(tmp_path: Path) -> None:
    """Truth: 0.05 N m of Coulomb friction; a step of 6 rad/s shows in ten of the 300 rows."""
    assert main(["new-plant", "motor", "--like", "motor", "--out", str(tmp_path)]) == 0
    motor = bind(load_plant(tmp_path / "plant.toml"))
    friction = replace(motor.plant.parameters["tau_c"], value=0.05)
    rig = bind(replace(motor.plant, parameters={**motor.plant.parameters, "tau_c": friction}))
    t_s = 1e-3 * np.arange(300)
    u_V = np.array([6.0, -4.0, 9.0, 2.0, -8.0])[(t_s / 0.06).astype(int)][:, None]
    y = simulate(rig, t_s, at_rest(rig), u_V, Conditions(substeps=4)).y
    log = RunLog(log_columns(motor.model), 1e-3, "open", t_s, u_V, np.asarray(y).reshape(len(t_s), -1))
    found = diagnose(motor, {"short": log}).diagnosis
    assert (found.verdict, *found.found) == ("gap", "shaft.coulomb")


# Of what both ask, tests/diagnosis/decide/test_rows.py and tests/twinlaw/workflows/test_columns.py, in every suite.
@pytest.mark.soak
@pytest.mark.parametrize("verb", [identify, diagnose])
def test_commands_that_a_motor_s_log_has_a_row_late_are_named_and_made_no_physics(
    verb: Callable[..., object], tmp_path: Path
) -> None:
    """Its current follows within a row of 10 ms: another inductance, or inputs that move between rows, make up for a part of it."""
    assert main(["new-plant", "motor", "--like", "motor", "--out", str(tmp_path)]) == 0
    motor = bind(load_plant(tmp_path / "plant.toml"))
    log = trimmed(fly(motor), 0.0, 10.0)
    late = replace(log, u=np.concatenate([log.u[:1], log.u[:-1]]))
    with pytest.raises(BadInput, match=r"u_V stands one row late in the log.*move u_V up by one row"):
        verb(motor, {"late": late})
