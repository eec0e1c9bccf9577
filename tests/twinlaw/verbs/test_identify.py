"""The verbs `experiments` and `identify`: files in, files out, one line for what is wrong."""

import json
import re
import shutil
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from identification.experiments.table import kinds_of
from identification.proof import monte_carlo
from identification.proof.bench import task
from identification.search import genetic, methods
from identification.search.methods import METHODS
from records.log import RunLog, load_log, save_log
from records.plant import load_plant
from sim.bind import bind
from sim.columns import log_columns
from sim.manoeuvres import stir
from sim.simulate import Conditions, simulate
from tests.diagnosis.arm import arm_log
from tests.page_units import without_unit
from tests.soak import SOAK, sampled
from tests.twinlaw.verbs.crews import works_here
from tests.twinlaw.verbs.interrupts import stops_when_told
from twinlaw.command import main
from twinlaw.workflows.identify import by_time
from twinlaw.workflows.identify.progress import Progress

AEROSHIELD = ("--plant", "plants/aeroshield.toml")
ROTORS = ("01-main_rotor", "03-gravity", "04-elevation_swing")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """The nine experiments of one rig."""
    path = tmp_path_factory.mktemp("experiments")
    assert main(["experiments", "--seed", "5", "--out", str(path)]) == 0
    return path


def some(folder: Path, names=ROTORS):
    return [str(folder / f"{name}.toml") for name in names]


@pytest.mark.soak
def test_nine_experiments_give_a_plant_file_a_report_and_json(folder, monkeypatch, tmp_path, capsys):
    assert main(["identify", "--out", str(tmp_path), "--truth", str(folder / "truth.toml"), "--json", str(folder)]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told == json.loads((tmp_path / "identification.json").read_text())
    assert told["schema"] == "identification/1"
    assert len(told["estimates"]) == 27
    assert all(entry["lower"] < entry["value"] < entry["upper"] for entry in told["estimates"])
    plant, truth = load_plant(tmp_path / "plant.toml"), load_plant(folder / "truth.toml")
    assert plant.correlation is not None
    np.testing.assert_allclose(plant.parameters["J_E"].value, truth.parameters["J_E"].value, rtol=5e-3)
    assert plant.design == load_plant(Path("plants/ce150.toml")).design
    page = (tmp_path / "report.html").read_text()
    assert without_unit(page) == []
    for words in ("Fig. 7", "Fig. 8", "Fig. 10", "Fig. 13", "linear fit", "Correlation"):
        assert words in page


@pytest.mark.soak
def test_a_few_experiments_name_what_they_cannot_tell(folder, tmp_path, capsys):
    assert main(["identify", "--out", str(tmp_path), *some(folder)]) == 0
    said = capsys.readouterr().out
    assert "95 % interval" in said
    assert "J_E" in said
    assert "J_A" not in said


def test_the_rigs_own_parameters_are_no_experiment(folder, tmp_path, capsys):
    # What a shell makes of DIR/*.toml: the nine experiments and truth.toml.
    assert main(["identify", "--out", str(tmp_path), *map(str, sorted(folder.glob("*.toml")))]) == 2
    said = capsys.readouterr().err
    assert "truth.toml" in said
    assert "a plant file" in said
    assert "give its folder" in said
    assert not list(tmp_path.iterdir())


def test_an_interrupted_run_leaves_what_was_found_so_far(monkeypatch, folder, tmp_path):
    original, calls = by_time.identify_stage, []

    def stops_at_the_third(*given):
        calls.append(given)
        if len(calls) == 3:
            raise KeyboardInterrupt
        return original(*given)

    monkeypatch.setattr(by_time, "identify_stage", stops_at_the_third)
    assert main(["identify", "--out", str(tmp_path), *some(folder)]) == 130
    found = json.loads((tmp_path / "identification.json").read_text())
    assert {entry["name"] for entry in found["estimates"]} >= {"K_M", "tau_gE"}
    assert load_plant(tmp_path / "plant.toml").correlation is not None


@pytest.mark.parametrize("method", sampled(METHODS, keep=["genetic"]))
def test_a_search_over_experiments_ends_with_the_truth_beside_it(method, folder, monkeypatch, tmp_path, capsys):
    """Truth: the weight's torque within its interval, by each method; what the experiment needs besides, Psi_m, has no known truth."""
    monkeypatch.setattr(methods, "evolve", partial(genetic.evolve, settings=genetic.Settings(generations=5)))
    truth = ["--truth", str(folder / "truth.toml")]
    experiments = [str(folder / "03-gravity.toml")]
    assert main(["identify", "--search", method, *truth, "--out", str(tmp_path), "--json", *experiments]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["quality"]["colour"] == "green"
    (estimate,) = told["estimates"]
    assert abs(estimate["value"] - told["truth"]["tau_gE"]) < 3.5 * estimate["sd"]
    assert estimate["start"] == told["stages"][0]["searches"][0]["values"]["tau_gE"]
    page = (tmp_path / "report.html").read_text()
    assert "Psi_m" in page
    assert "Readings and residuals: " in page
    assert ('<th scope="col">bits</th>' in page) == (method == "genetic")
    assert re.search(
        rf'>{method}</td><td class="whole">[\d.e+-]+\stenths</td>', page
    )  # a torque's sum is not in degrees


@pytest.fixture(scope="module")
def flown(tmp_path_factory):
    """Ten seconds of flight, and the two coefficients to estimate from it."""
    path = tmp_path_factory.mktemp("flown") / "flight.csv"
    log = task(bind(load_plant(Path("plants/ce150.toml")))).log
    save_log(path, replace(log, t_s=log.t_s[:1000], u=log.u[:1000], y=log.y[:1000]))
    return ["--free", "J_A,b_vA", str(path)]


@pytest.fixture(scope="module")
def swung() -> RunLog:
    """A run of the AeroShield with the plant file's own numbers, without noise."""
    rig = bind(load_plant(Path(AEROSHIELD[1])))
    moved = stir(rig)
    y = simulate(rig, moved.t_s, moved.x0, moved.u, Conditions(keep="y")).y
    return RunLog(log_columns(rig.model), 0.01, "open", moved.t_s, moved.u, y)


@pytest.fixture(scope="module")
def arm(swung, tmp_path_factory):
    """The same as a file, and the two coefficients to estimate from it."""
    path = tmp_path_factory.mktemp("swung") / "run.csv"
    save_log(path, swung)
    return [*AEROSHIELD, "--free", "K,c", str(path)]


@pytest.mark.parametrize(
    ("spoilt", "words"),
    [
        (lambda log: replace(log, y=np.degrees(log.y)), "'psi_rad': unit slip: got psi_rad is in degrees"),
        (lambda log: replace(log, u=1000.0 * log.u), "u_M_V is in another unit, up to"),
        (lambda log: replace(log, t_s=1000.0 * log.t_s), "time unit: got rows 10 s apart"),
        (lambda log: replace(log, u=0.0 * log.u, y=0.0 * log.y), "every input and every output is one constant"),
        (lambda log: replace(log, y=np.nan * log.y), "no output was ever measured"),
    ],
)
def test_a_log_that_cannot_be_one_of_this_rig_is_refused(flown, tmp_path, capsys, spoilt, words):
    log = load_log(Path(flown[-1]), log_columns(bind(load_plant(Path("plants/ce150.toml"))).model))
    save_log(tmp_path / "spoilt.csv", spoilt(log))
    assert main(["identify", "--out", str(tmp_path / "out"), str(tmp_path / "spoilt.csv")]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert words in line
    assert not (tmp_path / "out").exists()


@pytest.mark.soak
def test_a_turned_angle_is_refused_by_the_frequency_method_too(flown, tmp_path, capsys):
    log = load_log(Path(flown[-1]), log_columns(bind(load_plant(Path("plants/ce150.toml"))).model))
    save_log(tmp_path / "turned.csv", replace(log, y=log.y * [1.0, -1.0]))
    told = ["--method", "frequency", *flown[:-1], "--out", str(tmp_path / "out"), str(tmp_path / "turned.csv")]
    assert main(["identify", *told]) == 2
    assert "phi_rad has the wrong sign" in capsys.readouterr().err


@pytest.mark.soak
def test_of_an_axis_that_was_never_read_what_shows_there_is_held_and_named_and_the_other_is_identified(
    flown, tmp_path, capsys
):
    """Truth: the plant file's J_A, to 5 %, from the azimuth alone."""
    bound = bind(load_plant(Path("plants/ce150.toml")))
    log = load_log(Path(flown[-1]), log_columns(bound.model))
    save_log(tmp_path / "half.csv", replace(log, y=np.column_stack([np.full(len(log.t_s), np.nan), log.y[:, 1]])))
    out, record = tmp_path / "out", str(tmp_path / "half.csv")
    assert main(["identify", "--free", "J_E,J_A,tau_gE", "--window", "2", "--json", "--out", str(out), record]) == 0
    told = json.loads(capsys.readouterr().out)
    assert "half: psi_rad was not recorded: NaN in every row" in told["notes"]
    assert [entry["name"] for entry in told["estimates"]] == ["J_A"]
    assert told["estimates"][0]["value"] == pytest.approx(bound.parameter("J_A"), rel=0.05)
    assert (
        "J_E, tau_gE: shows only in psi_rad, which no log has a reading of; the plant file's value is kept"
        in told["notes"]
    )
    assert main(["identify", "--free", "J_E", "--out", str(tmp_path / "none"), record]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "got J_E, which show only in what was not recorded, expected a reading of psi_rad" in line
    assert not (tmp_path / "none").exists()


@pytest.mark.soak
def test_what_the_data_are_too_poor_for_is_one_sentence_by_parameter(flown, tmp_path, capsys):
    """Inertia, damping, friction, thrust and reaction of one axis have a common factor that motion does not tell."""
    free = "J_A,b_vA,b_cA,p_FT,K_A"
    assert main(["identify", "--free", free, "--window", "5", "--json", "--out", str(tmp_path), flown[-1]]) == 0
    told = json.loads(capsys.readouterr().out)
    (poor,) = (note for note in told["notes"] if note.startswith("these data are too poor for"))
    lost = [entry for entry in told["estimates"] if not entry["identified"]]
    assert "J_A" in {entry["name"] for entry in lost}
    assert all(f"{entry['name']} (sd " in poor for entry in lost)
    assert sum("not identifiable alone" in note for note in told["notes"]) <= 3


@pytest.mark.soak
def test_rows_that_the_look_leaves_out_do_not_reach_the_fit(flown, tmp_path, capsys):
    """Truth: three readings off by 1.5 rad, which are named, change the estimates by nothing more than three that were never made."""
    log = load_log(Path(flown[-1]), log_columns(bind(load_plant(Path("plants/ce150.toml"))).model))
    found = {}
    for name, amount in (("leaps", 1.5), ("unread", np.nan)):
        y = log.y.copy()
        y[[200, 400, 600], 1] += amount
        save_log(tmp_path / f"{name}.csv", replace(log, y=y))
        options = ["--free", "J_A,b_vA", "--window", "2", "--json", "--out", str(tmp_path / "out")]
        assert main(["identify", *options, str(tmp_path / f"{name}.csv")]) == 0
        found[name] = json.loads(capsys.readouterr().out)
    assert "leaps: phi_rad leaps away and back in 3 rows, first at 2 s; left out" in found["leaps"]["notes"]
    for one, other in zip(found["leaps"]["estimates"], found["unread"]["estimates"], strict=True):
        # What the look leaves out is a row, and with it the three sound readings of the other axis.
        assert one["value"] == pytest.approx(other["value"], abs=0.1 * other["sd"])
        assert one["sd"] == pytest.approx(other["sd"], rel=0.01)


def test_a_log_given_twice_under_two_names_is_refused(flown, tmp_path, capsys):
    for suffix in (".csv", ".toml"):
        shutil.copy(Path(flown[-1]).with_suffix(suffix), tmp_path / f"copy{suffix}")
    assert main(["identify", "--out", str(tmp_path / "out"), *flown, str(tmp_path / "copy.csv")]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "copy: log: got 1000 rows stand in flight too; left out here, expected a row that can be used" in line
    assert not (tmp_path / "out").exists()


def test_a_parameter_on_which_no_experiment_bears_is_named(folder, tmp_path, capsys):
    record = next(str(path) for path in folder.glob("03-*.toml"))
    assert main(["identify", "--free", "J_A,tau_gE", "--out", str(tmp_path), record]) == 0
    assert "J_A: no data given here bear on it" in capsys.readouterr().out


def test_an_interrupted_fit_to_a_log_leaves_the_best_so_far(monkeypatch, arm, tmp_path, capsys):
    told = stops_when_told(monkeypatch, 2)
    assert main(["identify", "--out", str(tmp_path), *arm]) == 130
    (line,) = capsys.readouterr().err.splitlines()
    assert line.endswith("identification.json hold the best values so far of K, c, without intervals")
    left, stated = (load_plant(path).parameters for path in (tmp_path / "plant.toml", Path(AEROSHIELD[1])))
    assert left["K"].value == told[-1]["K"]
    assert left["K"].sd == stated["K"].sd
    assert left["l"] == stated["l"]
    notes = json.loads((tmp_path / "identification.json").read_text())["notes"]
    assert notes == ["K, c: the best so far of a fit that was interrupted, without interval"]


def test_a_run_interrupted_between_two_lengths_of_windows_leaves_the_fit_that_is_done(
    monkeypatch, arm, tmp_path, capsys
):
    original = Progress.finished

    def stops(self, done):
        original(self, done)
        raise KeyboardInterrupt

    monkeypatch.setattr(Progress, "finished", stops)
    assert main(["identify", "--out", str(tmp_path), *arm]) == 130
    assert "hold 1 finished fit\n" in capsys.readouterr().err
    plant = load_plant(tmp_path / "plant.toml")
    assert plant.correlation is not None
    assert set(plant.correlation.names) == {"c", "K"}


@pytest.mark.soak
def test_repetitions_tell_how_often_the_truth_lies_inside(monkeypatch, tmp_path, capsys):
    """One repetition of the first of the plant's experiments, in a soak of all."""
    works_here(monkeypatch)
    if not SOAK:
        monkeypatch.setattr(monte_carlo, "kinds_of", lambda model: dict(list(kinds_of(model).items())[:1]))
    plant = ["--plant", "plants/ce150_velagic.toml"]  # with four experiments, where the other has nine
    assert main(["experiments", *plant, "--seed", "7", "--repetitions", "1", "--out", str(tmp_path), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert len(told["coverage"]) == 10 if SOAK else set(told["coverage"]) == {"a_1", "b_1", "B_psi", "I_inv"}
    assert told["mean"] > 0.7
    assert len(json.loads((tmp_path / "repetitions.json").read_text())["repetitions"]) == 1


def bounded(tmp_path, text):
    (tmp_path / "bounds.toml").write_text(text)
    return ["--bounds", str(tmp_path / "bounds.toml")]


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (lambda tmp_path: bounded(tmp_path, "K_M = [1.0, 2.0]"), "start of K_M: got 363, expected a value between its bounds 1 and 2"),
        (lambda tmp_path: bounded(tmp_path, "K_M = [2.0, 1.0]"), "bounds of K_M: got [2, 1], expected lowest < highest"),
        (lambda tmp_path: bounded(tmp_path, "K_M = 3"), "bounds.toml: K_M"),
        (lambda tmp_path: bounded(tmp_path, "K_X = [1.0, 2.0]"), "bounds of 'K_X'"),
        (lambda tmp_path: ["--free", "K_X"], "parameter 'K_X'"),
        (lambda tmp_path: ["--window", "-1"], "--window"),
        (lambda tmp_path: ["--plant", "plants/emps.toml"], "plant: got 'ce150', expected 'emps'"),
        (lambda tmp_path: [str(tmp_path)], "none in this folder"),
        (lambda tmp_path: [str(tmp_path / "nothing.csv")], "nothing.csv: experiment or run log: got No such file"),
    ],
)  # fmt: skip
def test_what_cannot_be_used_is_one_line_and_leaves_nothing(folder, tmp_path, capsys, options, words):
    out = tmp_path / "out"
    assert main(["identify", "--out", str(out), *options(tmp_path), *some(folder, ROTORS[:1])]) == 2
    said = capsys.readouterr().err
    assert words in said
    assert said.count("\n") == 1
    assert not out.exists()


def test_the_same_experiment_twice_or_on_the_wrong_mount_is_refused(folder, tmp_path, capsys):
    for path in folder.glob("04-*"):
        shutil.copy(path, tmp_path / path.name)
    copy = tmp_path / "04-elevation_swing.toml"
    assert main(["identify", "--out", str(tmp_path / "out"), *some(folder, ROTORS[2:]), str(copy)]) == 2
    assert "given twice" in capsys.readouterr().err
    copy.write_text(copy.read_text().replace('"turned"', '"upright"'))
    assert main(["identify", "--out", str(tmp_path / "out"), str(copy)]) == 2
    assert "mount: got 'upright', expected 'turned'" in capsys.readouterr().err
    together = [str(folder / "03-gravity.toml"), str(copy)]  # the first of which could be done
    assert main(["identify", "--out", str(tmp_path / "out"), *together]) == 2
    assert not (tmp_path / "out").exists()


def test_a_log_with_a_trim_of_its_inputs_is_fitted_and_another_predicted(tmp_path, capsys):
    """The rig adds 0.1 V to its rotor: the offset is told to 0.02 V, and the log held out is predicted by it."""
    for seed, name in enumerate(("fitted", "other")):
        log = arm_log(seed=seed, seconds=10.0)
        save_log(tmp_path / f"{name}.csv", replace(log, u=log.u - 0.1))
    options = [*AEROSHIELD, "--free", "K,c", "--offsets", "--trim", "1", "9", "--window", "2"]
    files = [str(tmp_path / "fitted.csv"), "--holdout", str(tmp_path / "other.csv")]
    assert main(["identify", "--out", str(tmp_path / "out"), "--json", *options, *files]) == 0
    told = json.loads(capsys.readouterr().out)
    offsets = {entry["name"]: entry["value"] for entry in told["aids"]}
    assert offsets["offset.u_V"] == pytest.approx(0.1, abs=0.02)
    assert {test["channel"] for test in told["holdout"]} == {"theta_rad"}
    assert min(test["fit"] for test in told["holdout"]) > 0.95
    assert main(["identify", *AEROSHIELD, "--out", str(tmp_path / "out"), "--trim", "70", "80", files[0]]) == 2
    assert "a part of 0 s to 9.99 s" in capsys.readouterr().err


def test_the_truth_of_a_plant_without_a_law_is_told_and_that_of_another_plant_refused(swung, tmp_path, capsys):
    # Truth: the log is of the plant file's own numbers, without noise, so K is found within a per cent of them.
    save_log(tmp_path / "log.csv", swung)
    asked = ["identify", *AEROSHIELD, "--window", "2", "--free", "K", "--out", str(tmp_path)]
    assert main([*asked, "--truth", AEROSHIELD[1], "--json", str(tmp_path / "log.csv")]) == 0
    told = json.loads(capsys.readouterr().out)
    (found,) = [entry for entry in told["estimates"] if entry["name"] == "K"]
    assert found["value"] == pytest.approx(told["truth"]["K"], rel=0.01)
    assert (tmp_path / "report.html").is_file()
    assert main([*asked, "--truth", "plants/emps.toml", str(tmp_path / "log.csv")]) == 2
    assert "equations of emps" in capsys.readouterr().err
