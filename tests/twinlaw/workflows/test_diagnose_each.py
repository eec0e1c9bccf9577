"""`twinlaw diagnose --each` and the sealed cases: each answered by itself, the same bytes as alone, and nothing done twice."""

import json
import shutil
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from blind.cases.make import Benchmark, make
from records.errors import BadInput
from records.log import save_log
from tests.blind.conftest import shorten
from tests.diagnosis.arm import arm_log
from tests.soak import SOAK
from tests.test_project import ROOT
from tests.twinlaw.verbs.crews import works_here
from twinlaw.command import main
from twinlaw.workflows.diagnose.each import answer
from twinlaw.workflows.diagnose.parcel import parcel
from twinlaw.workflows.diagnose.questions import questions

PLANT = ROOT / "plants" / "aeroshield.toml"
FILES = {"diagnosis.json", "plant.toml", "report.html"}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of two logs and a case: three seconds of a run, ten samples, and the three seconds with two more held out."""
    place = tmp_path_factory.mktemp("logs")
    log = arm_log(seconds=5.0)

    def save(path: Path, rows: slice) -> None:
        save_log(path, replace(log, t_s=log.t_s[rows] - log.t_s[rows][0], u=log.u[rows], y=log.y[rows]))

    save(place / "run.csv", slice(0, 300))
    save(place / "short.csv", slice(0, 10))
    (place / "notes.csv").write_text("no,log\n")
    case = place / "case-7"
    case.mkdir()
    shutil.copy(PLANT, case / "plant.toml")
    save(case / "train.csv", slice(0, 300))
    save(case / "hold-1.csv", slice(300, 500))
    return place


def test_a_folder_holds_its_logs_and_its_cases(folder: Path) -> None:
    found = {entry.name: entry for entry in questions(PLANT, [folder], [])}
    assert set(found) == {"run", "short", "case-7"}
    assert found["run"].plant == PLANT
    assert [path.name for path in found["case-7"].logs] == ["train.csv"]
    assert [path.name for path in found["case-7"].holdout] == ["hold-1.csv"]
    assert found["case-7"].plant == folder / "case-7" / "plant.toml"


def test_a_held_out_log_is_no_question(folder: Path) -> None:
    found = questions(PLANT, [folder], [folder / "short.csv"])
    assert next((entry.name, entry.holdout) for entry in found) == ("run", (folder / "short.csv",))
    assert "short" not in [entry.name for entry in found]


def test_two_of_one_name_and_a_folder_of_nothing_are_refused(folder: Path, tmp_path: Path) -> None:
    with pytest.raises(BadInput, match="two of this name"):
        questions(PLANT, [folder, folder / "run.csv"], [])
    with pytest.raises(BadInput, match="neither a run log nor a case"):
        questions(PLANT, [tmp_path], [])


def test_a_folder_without_the_option_says_which_it_is(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["diagnose", "--plant", str(PLANT), str(folder)]) == 2
    assert "add --each" in capsys.readouterr().err


def test_what_travels_knows_nothing_of_this_computer_s_folders(folder: Path, tmp_path: Path) -> None:
    moved = shutil.copytree(folder, tmp_path / "elsewhere")
    one, other = (parcel(questions(PLANT, [place], [])[0]) for place in (folder, moved))
    assert one == other
    with pytest.raises(BadInput) as refused:
        answer(parcel(questions(PLANT, [folder / "none.csv"], [])[0]))
    assert str(refused.value).startswith("none.csv: run log: got No such file")


def test_each_is_answered_as_alone_and_only_once(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    if not SOAK:  # a process of its own answers with the same bytes: below, and tests/jobs/test_run.py
        works_here(monkeypatch)
    out = tmp_path / "out"
    command = ["diagnose", "--plant", str(PLANT), "--each", "--workers", "1", "--out", str(out), "--json", str(folder)]
    assert main(command) == 2  # one of the three is too short
    said = capsys.readouterr()
    assert len(said.err.splitlines()) == 1
    assert "short: short" in said.err
    told = json.loads(said.out)
    assert told == json.loads((out / "summary.json").read_text())
    by_name = {entry["name"]: entry for entry in told["answers"]}
    assert list(by_name) == ["run", "short", "case-7"]
    assert "too short" in by_name["short"]["failure"]
    assert by_name["run"]["verdict"] in ("no gap", "cannot tell")
    assert {path.name for path in (out / "run").iterdir()} == FILES | {"run.json"}
    assert {path.name for path in (out / "case-7").iterdir()} == FILES | {"run.json", "prediction-hold-1.csv"}
    assert not (out / "short").exists()

    alone = answer(parcel(questions(PLANT, [folder / "run.csv"], [])[0]))
    assert {name: (out / "run" / name).read_text() for name in FILES} == alone

    before = {path: path.stat().st_mtime_ns for path in out.glob("*/*")}
    (out / "case-7" / "prediction-hold-1.csv").write_text("half a fi")
    (out / "case-7" / "prediction-hold-0.csv").write_text("of a log that is no longer held out")
    assert main(command) == 2
    assert not (out / "case-7" / "prediction-hold-0.csv").exists()
    after = {path: path.stat().st_mtime_ns for path in out.glob("*/*")}
    assert {path.parent.name for path in after if after[path] != before[path]} == {"case-7"}
    assert (out / "case-7" / "prediction-hold-1.csv").read_text().startswith("t_s,")


def test_a_sealed_case_is_the_same_from_a_process_and_goes_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    shorten(monkeypatch)
    if not SOAK:  # from processes the same comes in tests/jobs/test_run.py
        works_here(monkeypatch)
    make(Benchmark(6, 1, ("nominal",)), tmp_path / "here")
    words = ["blind", "make", "--seed", "6", "--cases", "1", "--kinds", "nominal", "--out", str(tmp_path / "there")]
    with monkeypatch.context() as patch:
        patch.setattr(sys.modules["blind.cases.make"], "seal", interrupt)
        assert main([*words, "--workers", "1"]) == 130
    assert "interrupted" in capsys.readouterr().err
    kept = tmp_path / ".there.unfinished"
    assert len(list(kept.glob("*.json"))) == 1
    assert not (tmp_path / "there").exists()
    with monkeypatch.context() as patch:
        patch.setattr("jobs.crew.ProcessPoolExecutor", None)  # nothing is left to do
        assert main([*words, "--workers", "1"]) == 0
    assert not kept.exists()
    here = list((tmp_path / "here").rglob("*.*"))
    assert len(here) > 2
    for path in here:
        assert path.read_bytes() == (tmp_path / "there" / path.relative_to(tmp_path / "here")).read_bytes()


def interrupt(*_: object) -> None:
    """As Ctrl-C would."""
    raise KeyboardInterrupt
