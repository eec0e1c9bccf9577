"""`twinlaw blind sensitivity`: which constants are tried, what counts as a change, and a small case from end to end."""

import json
import shutil
import sys
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest

from blind.scoring.changes import change
from diagnosis import decisions
from records.deciding import deciding
from records.errors import BadInput
from records.log import save_log
from sim.loop import fly_law
from sim.manoeuvres import flight
from tests.blind.test_score import answer, effect, sealed, truth, write
from tests.docs.reading.json_page import is_as_documented
from tests.plants import bound, stated_table
from tests.test_project import ROOT
from twinlaw.command import main
from twinlaw.workflows.diagnose.sensitivity import Found, Trial, facts, read_at_load, rows, trials_of

TRUTHS = [truth("nominal"), truth("single", effect("azimuth.tilt")), truth("single", effect("main_input.delay"))]
NOTHING = answer("no gap", "azimuth", [], [])
TILT = answer("gap", "azimuth", [("azimuth.tilt", 0.9)], ["azimuth.tilt"])


def test_changes_are_counted_by_case_and_shares_by_the_cases_where_they_count(tmp_path: Path) -> None:
    names = sealed(tmp_path / "cases", TRUTHS)
    for folder, given in (("old", (NOTHING, TILT, TILT)), ("new", (TILT, TILT, NOTHING))):
        for name, content in zip(names, given, strict=True):
            write(tmp_path / folder, name, content)
    found = change(tmp_path / "cases", tmp_path / "old", tmp_path / "new")
    assert (found.cases, found.other, found.verdicts, found.first_names, found.failed) == (3, 2, 2, 2, 0)
    assert (found.right_first, found.place, found.false_alarms) == (0.0, 0.0, 1.0)
    back = change(tmp_path / "cases", tmp_path / "new", tmp_path / "none")
    assert (back.failed, back.right_first, back.place) == (3, -0.5, -0.5)
    same = change(tmp_path / "cases", tmp_path / "new", tmp_path / "new")
    assert same.size == (0, 0.0)
    shown = rows([Found(Trial("REST_SHARES", 1.4), found)])[0]
    assert shown == ("REST_SHARES", "1.4", "0 0.7", "shares of the rest", "2", "2", "+0.000", "+0.000", "+1.000", "0")
    assert facts([Found(Trial("REST_SHARES", 1.4), found)])[0]["value"] == [0.0, pytest.approx(0.7)]


def test_all_constants_are_tried_but_those_that_cannot_be_another() -> None:
    trials, untried = trials_of((), (0.7, 1.4))
    assert {trial.constant for trial in trials} | set(untried) == {name for name, _ in deciding(vars(decisions))}
    assert all("the same" in reason or name in read_at_load() for name, reason in untried.items())
    assert trials_of(("SINGLES",), (1.01, 1.4))[0] == [Trial("SINGLES", 1.4)]
    with pytest.raises(BadInput, match="write ALARM"):
        trials_of(("alarms",), (0.7,))


def test_what_was_read_when_the_diagnosis_was_loaded_is_not_tried(monkeypatch: pytest.MonkeyPatch) -> None:
    def late(most: int = decisions.NEXT, least: float = decisions.SURELY) -> float:
        return most * least

    monkeypatch.setitem(sys.modules, "diagnosis.of_this_test", SimpleNamespace(late=late, own=decisions.SINGLES))
    assert {"SURELY", "SINGLES"} <= read_at_load()
    assert "EFFORT" not in read_at_load()
    assert "read once" in trials_of(("SURELY",), (0.7,))[1]["SURELY"]


@pytest.mark.parametrize("factor", ["1", "0", "-2", "inf", "much"])
def test_a_factor_that_changes_nothing_or_all_is_refused(factor: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["blind", "sensitivity", "cases", "out", "--factors", factor])
    assert "expected a positive number other than 1" in capsys.readouterr().err


def small_case(folder: Path) -> None:
    """Six seconds of flight of the plant as stated, sealed as a case without effect."""
    rig, table = bound("ce150"), stated_table("ce150")
    log = replace(fly_law(rig, table, flight(rig)), table_digest=None, extra={})
    case, rows_of = folder / "case-0001", slice(2000, 2600)
    sealed(folder, [truth("nominal")])
    case.mkdir()
    shutil.copy(ROOT / "plants" / "ce150.toml", case / "plant.toml")
    save_log(case / "train-1.csv", replace(log, t_s=log.t_s[rows_of], u=log.u[rows_of], y=log.y[rows_of]))


@pytest.mark.soak
def test_a_small_case_is_answered_once_for_each_value_and_kept(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Six seconds hide some effects from every diagnosis: with next to none allowed it cannot tell."""
    small_case(tmp_path / "cases")
    out = tmp_path / "out"
    words = ["blind", "sensitivity", str(tmp_path / "cases"), str(out), "--workers", "1", "--constant", "BLIND_SHARE"]
    assert main([*words, "--factors", "0.001", "1.5", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert is_as_documented("blind sensitivity", told)
    assert {path.name for path in out.iterdir()} == {"unchanged", "BLIND_SHARE-x0.001", "BLIND_SHARE-x1.5"}
    by_factor = {entry["factor"]: entry for entry in told["changes"]}
    verdicts = {
        path.parent.parent.name: json.loads(path.read_text())["verdict"] for path in out.glob("*/*/diagnosis.json")
    }
    assert by_factor[0.001]["verdicts"] == (verdicts["BLIND_SHARE-x0.001"] != verdicts["unchanged"])
    assert verdicts["BLIND_SHARE-x0.001"] == "cannot tell"
    monkeypatch.setattr("jobs.crew.ProcessPoolExecutor", None)  # nothing is left to do
    assert main([*words, "--factors", "0.001", "1.5"]) == 0
    assert "BLIND_SHARE" in capsys.readouterr().out
