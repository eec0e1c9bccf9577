"""`twinlaw compare`: what it leaves behind, that it is the same twice, and that its figures are those of an independent flight."""

import json
import re
from pathlib import Path

import pytest

from controllers.table import CONTROLLERS
from design.settings import read_settings
from sim.loop import fly
from tests.controllers.rows import ce150, designed
from tests.plants import bound
from tests.soak import SOAK
from tests.test_project import ROOT
from tests.twinlaw.verbs.crews import works_here
from twinlaw.command import main
from verification.comparison.manoeuvres import FIGURES, figures
from verification.comparison.measures import merit

DRAWN = {"fig-19", "fig-23"}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The PID alone; but in a soak, drawn are the figure that is flown anew here and one other, as each takes a fifth of a second."""
    out = tmp_path_factory.mktemp("compare")
    words = ["compare", "--plant", str(ROOT / "plants" / "ce150.toml"), "--out", str(out), "--controllers", "pid"]
    with pytest.MonkeyPatch.context() as patch:
        works_here(patch)
        if not SOAK:
            for name in set(FIGURES) - DRAWN:
                patch.delitem(FIGURES, name)  # type: ignore[arg-type]
        assert main([*words, "--runs", "2", "--effects", "azimuth.cable_spring", "--steps", "1000"]) == 0
    return out


def test_it_leaves_table_c_and_image_of_each_and_a_plot_of_each_figure(folder: Path) -> None:
    content = json.loads((folder / "compare.json").read_text())
    row = content["controllers"][0]
    assert json.loads((folder / "pid" / "controller.json").read_text())["digest"] == row["table_digest"]
    assert row["table_digest"] in (folder / "pid" / "generated" / "law.c").read_text()
    assert bytes.fromhex(row["table_digest"]) in (folder / "pid" / "firmware.bin").read_bytes()
    assert {entry["mismatches"] for entry in row["equality"]} == {0}
    assert set(content["figures"]) == (set(FIGURES) if SOAK else DRAWN)
    for name in content["figures"]:
        labels = re.findall(r"<text[^>]*>([^<]*)<", (folder / f"controllers-{name}.svg").read_text())
        assert {"time [s]", "elevation [deg]", "azimuth [deg]", "u_M [V]", "u_T [V]", "pid", "reference"} <= set(labels)


@pytest.mark.soak
def test_its_figures_are_those_of_the_twin_flown_sample_by_sample(folder: Path) -> None:
    row, table = designed("pid")
    plan = FIGURES["fig-19"].manoeuvre(ce150(), 0.01)
    log = fly(ce150(), row.twin(table), plan)
    own = merit(log.t_s, plan.reference_rad, log.y, log.u, 0)
    told = json.loads((folder / "compare.json").read_text())["controllers"][0]["figures"]["fig-19"]["elevation"]
    assert told["iae_rad_s"] == pytest.approx(own.iae_rad_s, rel=1e-9)
    assert told["settling_s"] == pytest.approx(own.settling_s)


@pytest.fixture(scope="module")
def other(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A plant that is no helicopter, with the controllers that it can have."""
    out = tmp_path_factory.mktemp("other")
    words = ["compare", "--plant", str(ROOT / "plants" / "quanser_aero.toml"), "--out", str(out)]
    with pytest.MonkeyPatch.context() as patch:
        works_here(patch)
        assert main([*words, "--runs", "2", "--effects", "yaw.coulomb", "--steps", "1000"]) == 0
    return out


@pytest.mark.soak
def test_another_plant_s_controllers_fly_its_own_steps(other: Path) -> None:
    content = json.loads((other / "compare.json").read_text())
    assert [row["name"] for row in content["controllers"]] == ["scheduled", "lqg"]
    assert set(content["refused"]) == {"instantaneous", "fuzzy", "pid"}
    assert list(content["figures"]) == ["steps"]
    for row in content["controllers"]:
        assert {entry["mismatches"] for entry in row["equality"]} == {0}
        assert set(row["figures"]["steps"]) == set(row["effects"]["yaw.coulomb"]) == {"pitch", "yaw"}
    labels = re.findall(r"<text[^>]*>([^<]*)<", (other / "controllers-quanser_aero-steps.svg").read_text())
    assert {"pitch [deg]", "yaw [deg]", "u_M [V]", "u_T [V]", "lqg", "reference"} <= set(labels)
    page = (other / "controllers-quanser_aero.md").read_text()
    assert "IAE of pitch in deg s / yaw in deg s" in page
    assert "Fig. 23" not in page
    assert "eq (28)" not in page
    assert "are that plant's. Here the loops are\npitch (theta_rad, by u_M_V) and yaw (psi_rad, by u_T_V)." in page
    # What it says of the laws that this plant has is of any plant; those that it cannot have are said to be a helicopter's.
    said, _, refused = page.partition("Not designed for this plant")
    assert not re.search(r"elevation|azimuth|\bphi|\barm\b", said)
    assert "azimuth" in refused


@pytest.mark.soak
def test_another_plant_s_figures_are_those_of_the_twin_flown_sample_by_sample(other: Path) -> None:
    # Truth: the twin in Python, wired by hand: pitch and yaw are the plant's outputs and inputs in their order.
    quanser = bound("quanser_aero")
    row = CONTROLLERS["lqg"]
    table = row.design(quanser, read_settings(quanser))
    plan = figures(quanser)["steps"].manoeuvre(quanser, table.sample_period_s)
    log = fly(quanser, row.twin(table), plan)
    told = json.loads((other / "compare.json").read_text())["controllers"][1]["figures"]["steps"]
    for index, axis in enumerate(("pitch", "yaw")):
        own = merit(log.t_s, plan.reference_rad, log.y, log.u, index)
        assert told[axis]["iae_rad_s"] == pytest.approx(own.iae_rad_s, rel=1e-9)


def test_an_effect_that_the_plant_cannot_have_is_refused_in_one_line(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    plant = str(ROOT / "plants" / "aeroshield.toml")
    assert main(["compare", "--plant", plant, "--effects", "azimuth.tilt", "--out", str(tmp_path)]) == 2
    said = capsys.readouterr().err
    assert "azimuth.tilt" in said
    assert "arm.coulomb" in said
    assert list(tmp_path.iterdir()) == []


def test_an_unknown_controller_is_refused_in_one_line(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    with pytest.raises(SystemExit) as left:
        main(["compare", "--controllers", "pld", "--out", str(tmp_path)])
    assert left.value.code == 2
    said = capsys.readouterr().err
    assert "pld" in said
    assert all(name in said for name in CONTROLLERS)
    assert not list(tmp_path.iterdir())


def test_a_cluster_that_is_not_there_is_told_before_anything_is_built(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    # With the extra `cluster` or without it: no scheduler has such an address.
    assert main(["compare", "--controllers", "pid", "--cluster", "nonsense://nowhere", "--out", str(tmp_path)]) == 2
    assert "Dask" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.soak
def test_the_page_is_of_today_s_tables() -> None:
    """To write it anew, the page itself names the command."""
    page = (ROOT / "docs" / "controllers.md").read_text(encoding="utf-8")
    for name in CONTROLLERS:
        assert f"`{name}`" in page
        assert f"`{designed(name)[1].digest[:16]}`" in page, name
    for link in re.findall(r"\]\(([^)#]+)\)", page):
        assert (ROOT / "docs" / link).is_file(), link


def test_the_page_of_seed_001_s_own_model_is_of_today_s_tables() -> None:
    page = (ROOT / "docs" / "controllers-ce150_velagic.md").read_text(encoding="utf-8")
    velagic = bound("ce150_velagic")
    for name in ("pid", "fuzzy"):
        digest = CONTROLLERS[name].design(velagic, read_settings(velagic)).digest
        assert f"`{digest[:16]}`" in page, name
    assert all((ROOT / "docs" / f"controllers-ce150_velagic-{figure}.svg").is_file() for figure in figures(velagic))
    for link in re.findall(r"\]\(([^)#]+)\)", page):
        assert (ROOT / "docs" / link).is_file(), link
