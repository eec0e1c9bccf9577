"""`twinlaw experiments` and `identify --search genetic` on the plant of seed 001: files, pictures, what an interrupt leaves."""

import json
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from identification.experiments.velagic import figures
from identification.experiments.velagic.rig import PERIOD_S
from identification.search import genetic, methods
from records.log import RunLog, save_log
from records.plant import load_plant
from sim.bind import bind
from sim.columns import log_columns
from sim.simulate import Conditions, simulate
from tests.page_units import without_unit
from tests.twinlaw.verbs.interrupts import stops_when_told
from twinlaw.command import main

PLANT = ["--plant", "plants/ce150_velagic.toml"]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """The four experiments on a rig with the paper's own set."""
    path = tmp_path_factory.mktemp("velagic")
    assert main(["experiments", *PLANT, "--as-stated", "--out", str(path)]) == 0
    return path


@pytest.mark.soak
def test_a_rig_as_stated_has_the_plant_file_s_numbers(folder):
    assert load_plant(folder / "truth.toml").parameters == load_plant(Path(PLANT[1])).parameters
    assert sorted(path.name for path in folder.glob("0*.toml")) == [
        "01-main_motor.toml", "02-tail_motor.toml", "03-cross_coupling.toml", "04-gyroscopic.toml"
    ]  # fmt: skip


@pytest.mark.soak
def test_the_report_lays_both_methods_side_by_side_and_redraws_the_figures(folder, tmp_path, capsys, monkeypatch):
    """Truth: the rig's own numbers, to 2 or 6 parts in 1000. Of the paper's 150 generations 15, as the fit goes on from where they end;
    of each figure a tenth of its time, as its rig is computed in Python."""
    monkeypatch.setattr(methods, "evolve", partial(genetic.evolve, settings=genetic.Settings(generations=15)))
    monkeypatch.setattr(figures, "_rows", lambda duration_s: round(0.1 * duration_s / PERIOD_S))
    options = ["--search", "genetic", "--truth", str(folder / "truth.toml"), "--json"]
    assert main(["identify", *PLANT, *options, "--out", str(tmp_path), str(folder)]) == 0
    told = json.loads(capsys.readouterr().out)
    for stage in told["stages"]:
        ours, beside = stage["searches"]
        assert (ours["method"], beside["method"]) == ("genetic", "gradient")
        assert len(ours["best_by_generation"]) == 15
        assert set(ours["bits"]) == set(ours["values"]) == set(beside["values"])
        assert ours["cpu_s"] > 0.0
    page = (tmp_path / "report.html").read_text()
    assert without_unit(page) == []
    for words in (
        "Search over the whole range",
        "Evolution (Fig. 6",
        "Figs. 12 to 14",
        "genetic",
        "gradient",
        "main_motor",
    ):
        assert words in page
    for number in ("6", "12", "13", "14"):
        picture = (tmp_path / f"fig-{number}.svg").read_text()
        assert picture.startswith("<svg")
        assert picture in page
    found = {entry["name"]: entry["value"] for entry in told["estimates"]}
    assert found["a_1"] == pytest.approx(0.1165, rel=2e-3)
    truth = bind(load_plant(folder / "truth.toml"))
    for name in ("b_1", "B_psi", "I_inv", "a_2", "b_2", "Ic_inv", "a_3", "b_3", "k_G"):
        assert found[name] == pytest.approx(truth.parameter(name), rel=6e-3 if name.endswith("_inv") else 2e-3), name


@pytest.mark.soak
def test_an_interrupted_search_leaves_the_best_so_far(monkeypatch, folder, tmp_path):
    """Ctrl-C in the tenth generation of the first stage: plant.toml has what was best until then, and says so."""
    turns, original = [], genetic._next

    def stops_in_the_tenth(*given):
        turns.append(given)
        if len(turns) == 10:
            raise KeyboardInterrupt
        return original(*given)

    monkeypatch.setattr(genetic, "_next", stops_in_the_tenth)
    arguments = ["identify", *PLANT, "--search", "genetic", "--out", str(tmp_path), str(folder)]
    assert main(arguments) == 130
    left = load_plant(tmp_path / "plant.toml").parameters
    stated = load_plant(Path(PLANT[1])).parameters
    for name in ("a_1", "b_1", "B_psi", "I_inv"):
        assert "interrupted" in left[name].source
        assert left[name].value != stated[name].value
        assert left[name].sd == stated[name].sd
    assert left["a_2"] == stated["a_2"]


@pytest.mark.soak
def test_an_interrupted_evolution_over_a_log_leaves_the_best_so_far(monkeypatch, tmp_path):
    """Ctrl-C behind the third generation of `--search evolution` on a run log."""
    bound = bind(load_plant(Path(PLANT[1])))
    t_s = np.linspace(0.0, 4.99, 500)
    u = np.column_stack([np.where(t_s < 2.5, 5.3, 5.0), np.zeros(500)])
    x0 = np.zeros(8)
    x0[2] = -np.pi / 4
    y = simulate(bound, t_s, x0, u, Conditions(locked=("azimuth",))).y
    save_log(tmp_path / "log.csv", RunLog(log_columns(bound.model), 0.01, "open", t_s, u, y, locked=("azimuth",)))
    told = stops_when_told(monkeypatch, 3)
    arguments = [
        "--search",
        "evolution",
        "--free",
        "a_1,I_inv",
        "--out",
        str(tmp_path / "out"),
        str(tmp_path / "log.csv"),
    ]
    assert main(["identify", *PLANT, *arguments]) == 130
    left = load_plant(tmp_path / "out" / "plant.toml").parameters
    assert {name: left[name].value for name in ("a_1", "I_inv")} == pytest.approx(told[-1])
    assert "interrupted" in left["a_1"].source


@pytest.mark.soak
def test_only_what_is_named_is_estimated(folder, tmp_path, capsys):
    record = str(folder / "01-main_motor.toml")
    assert main(["identify", *PLANT, "--free", "I_inv", "--json", "--out", str(tmp_path), record]) == 0
    assert [entry["name"] for entry in json.loads(capsys.readouterr().out)["estimates"]] == ["I_inv"]


def test_other_plants_have_no_experiments(tmp_path, capsys):
    assert main(["experiments", "--plant", "plants/emps.toml", "--out", str(tmp_path / "out")]) == 2
    assert "expected one of ce150, ce150_velagic" in capsys.readouterr().err
