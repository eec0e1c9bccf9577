"""The forward chain on plants that are no helicopter: design, generate, verify, simulate, and `run` all the way to the board."""

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from records.log import load_log
from records.plant import load_plant
from sim.columns import log_columns
from tests.other_plants import WISHES, plant_file
from tests.soak import SOAK, sampled
from tests.twinlaw.verbs.test_other_units import written
from twinlaw.command import main
from twinlaw.workflows.reading import load_bound

STEPS = 100_000 if SOAK else 2_000
# The coil's image and its bounds are those that its run leaves in the cache, see test_other_units.py.
COIL = ("coil", "float32")
EACH = [COIL, *((name, arithmetic) for name in WISHES for arithmetic in ("float32", "fixed"))]


@pytest.mark.parametrize(("name", "arithmetic"), sampled(EACH, keep=[]))
def test_from_the_plant_s_file_to_a_verified_law_and_a_flight_of_its_c(
    name: str, arithmetic: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Truth: no bit differs; each output rests at its reference, and overshoots by 5 % at most (records.quality)."""
    path = written(name, tmp_path) if name == "coil" else plant_file(name, tmp_path)
    plant, table, wishes = str(path), str(tmp_path / "controller.json"), load_plant(path).design
    chosen = ["--arithmetic", arithmetic, "--out", str(tmp_path), "--json"]
    assert main(["design", "--plant", plant, *chosen]) == 0
    assert main(["generate", "--table", table, *chosen]) == 0
    assert main(["verify", "--plant", plant, "--table", table, "--steps", str(STEPS), *chosen]) == 0
    assert main(["simulate", "--plant", plant, "--table", table, *chosen]) == 0
    found: dict[str, Any] = json.loads((tmp_path / "verification.json").read_text())
    assert found["passed"]
    assert [row["mismatches"] for row in found["equality"]] == [0, 0, 0, 0]
    assert min(row["steps"] for row in found["equality"]) >= STEPS
    assert [row["cycles_max"] <= row["cycles_bound"] for row in found["target"]] == [True, True]
    assert {row["axis"] for row in found["poles"]} == {key for key, entry in wishes.items() if isinstance(entry, dict)}
    schedule = wishes.get("schedule")
    stated = {key for row in found["poles"] for key in row if key.startswith("at_")}
    assert stated == ({f"at_{schedule}"} if schedule else set())
    assert sorted(path.name for path in (tmp_path / "generated").iterdir()) == [
        "law.c", "law.h", "law_self_test.c", "protocol.c", "protocol.h",
    ]  # fmt: skip
    flown = json.loads(capsys.readouterr().out.splitlines()[-1])
    assert flown["left"] == []
    assert flown["quality"]["colour"] == "green"
    log = load_log(tmp_path / "simulation.csv", log_columns(load_bound(Path(plant)).model))
    assert np.isfinite(log.y).all()
    assert log.table_digest == found["table_digest"]


@pytest.mark.soak
@pytest.mark.parametrize("arithmetic", ["float32", "fixed"])
def test_the_law_of_axes_with_two_rotor_lags_is_one_in_twin_host_and_target(arithmetic: str, tmp_path: Path) -> None:
    """Truth: no bit of 100 000 steps differs. The flight of this plant is red, whatever flies it: see docs/controllers-ce150_velagic.md."""
    plant, table = "plants/ce150_velagic.toml", str(tmp_path / "controller.json")
    chosen = ["--arithmetic", arithmetic, "--out", str(tmp_path)]
    assert main(["design", "--plant", plant, *chosen]) == 0
    assert main(["verify", "--plant", plant, "--table", table, "--steps", str(STEPS), *chosen]) == 0
    found: dict[str, Any] = json.loads((tmp_path / "verification.json").read_text())
    assert [(row["steps"] >= STEPS, row["mismatches"]) for row in found["equality"]] == [(True, 0)] * 4


@pytest.mark.usefixtures("undrawn")
def test_an_output_that_no_loop_closes_has_no_reference_and_is_not_judged(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Truth: two outputs, one input; the law closes the second output alone, which holds four references."""
    plant = plant_file("motor", tmp_path)
    equations = tmp_path / "dc_motor.py"
    measured = equations.read_text().replace('outputs={"theta', 'outputs={"omega_rad_s": OMEGA, "theta')
    speed = '"speed_sensor": SensorPlace("omega_rad_s", "rad s^-1", 50.0), "theta_sensor"'
    equations.write_text(measured.replace('"theta_sensor"', speed))
    named = plant.read_text().replace("[design.shaft]", '[design.shaft]\noutput = "theta_rad"')
    plant.write_text(f"{named}\n[sensors.omega_rad_s]\nresolution_rad_s = 0.1\n")
    assert main(["simulate", "--plant", str(plant), "--out", str(tmp_path), "--json"]) == 0
    ((output, found),) = json.loads(capsys.readouterr().out)["tracking"].items()
    assert (output, found["input"], found["holds"]) == ("theta_rad", "u_V", 4)
    log = load_log(tmp_path / "simulation.csv", log_columns(load_bound(plant).model))
    assert set(log.extra) == {"theta_ref_rad"}


@pytest.mark.soak
def test_a_table_of_other_loops_has_an_image_and_a_library(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    plant, table = str(plant_file("aeroshield", tmp_path)), str(tmp_path / "controller.json")
    assert main(["design", "--plant", plant, "--out", str(tmp_path)]) == 0
    assert main(["build", "--table", table, "--out", str(tmp_path / "image")]) == 0
    assert "MEASUREMENT input.theta_rad" in (tmp_path / "image" / "firmware.a2l").read_text()
    assert main(["generate", "--as", "arduino", "--table", table, "--out", str(tmp_path)]) == 0
    example = next((tmp_path / "arduino" / "examples").rglob("*.ino")).read_text()
    assert "law_reset(&law, 0);" in example
    assert "law_duty_arm(output.u_V)" in example
    assert main(["simulate", "--plant", "plants/emps.toml", "--table", table, "--out", str(tmp_path)]) == 2
    assert "a plant without the output theta_rad" in capsys.readouterr().err


@pytest.mark.soak
def test_the_plant_that_new_plant_writes_is_flown_at_once(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Truth: 100 000 steps, no bit differs; the image has flown, a frame a sample and one to begin with."""
    assert main(["new-plant", "my_arm", "--out", str(tmp_path)]) == 0
    capsys.readouterr()
    assert main(["run", "--plant", str(tmp_path / "plant.toml"), "--out", str(tmp_path / "b"), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["passed"]
    found = json.loads((tmp_path / "b" / "verification.json").read_text())
    assert all(row["steps"] >= 100_000 and row["mismatches"] == 0 for row in found["equality"])
    assert len(found["equality"]) == 4
    assert (tmp_path / "b" / "firmware.bin").is_file()


def test_what_is_the_helicopter_s_alone_says_so(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["bench", "--plant", str(plant_file("inverted_arm", tmp_path))]) == 2
    said = capsys.readouterr().err
    assert "elevation and azimuth" in said
    assert said.count("\n") == 1


@pytest.mark.usefixtures("undrawn")
def test_any_loop_is_swept_and_its_page_names_no_paper(tmp_path: Path) -> None:
    # Truth: the first loop alone is there, and moves by the amplitude about the middle of its references. No paper has this plant.
    plant = str(plant_file("inverted_arm", tmp_path))
    words = ["--amplitudes", "0.05", "--band-rad-s", "2", "8", "--out", str(tmp_path / "swept")]
    assert main(["sweep", "--plant", plant, *words]) == 0
    assert main(["sweep", "--plant", plant, *words[:1], "0.05", "0.1", *words[2:]]) == 2
    (path,) = (tmp_path / "swept").glob("*.csv")
    reference = load_log(path, log_columns(load_bound(Path(plant)).model)).column("theta_ref_rad")
    assert path.name == "sweep_arm.csv"
    assert np.abs(reference).max() == pytest.approx(0.05, rel=0.05)
    matched = ["identify", "--method", "frequency", "--plant", plant, "--out", str(tmp_path / "found")]
    assert main([*matched, "--band-rad-s", "2", "8", "--free", "J", str(path)]) == 0
    headings = re.findall(r"<h2>(.*?)</h2>", (tmp_path / "found" / "report.html").read_text())
    assert {"The identified A and B", "Frequency responses"} <= set(headings)
    assert not [heading for heading in headings if "Fig." in heading or "eq (" in heading]
