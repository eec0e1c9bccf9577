"""docs/json.md: a row for every verb that prints JSON, with the keys that it prints."""

import json
from pathlib import Path

import pytest

from tests.angles import few_angles
from tests.docs.reading.json_page import PAGE, ROWS, is_as_documented, keys
from tests.docs.reading.results import result
from tests.twinlaw.verbs.crews import works_here
from twinlaw.cli.completion import command_tree
from twinlaw.command import build_parser, main
from twinlaw.verbs import VERBS
from twinlaw.verbs import blind as blind_verb
from twinlaw.workflows.diagnose.each import Answered

# What longer commands have printed is kept, without what changes from run to run.
KEPT = {
    "compare": "compared_velagic",
    "design": "designed",
    "diagnose": "each",
    "envelope": "envelope",
    "identify": "swept_references_free",
    "verify": "verified",
    "experiments": "coverage",
    "sweep": "sweep_coverage",
    "blind score": "blind_fresh_first",
}


def test_every_verb_that_prints_json_has_its_row() -> None:
    below = (command for verb in command_tree(build_parser(tuple(VERBS))).commands for command in verb.all)
    leaves = {entry.at for entry in below if not entry.commands}
    assert set(ROWS) == {at.removeprefix("twinlaw ") for at in leaves} - {"completion"}


@pytest.mark.parametrize("verb", KEPT)
def test_what_a_longer_command_printed_is_what_its_row_says(verb: str) -> None:
    assert set(result(KEPT[verb])) <= keys(verb)


@pytest.mark.usefixtures("undrawn")
@pytest.mark.parametrize(
    "command",
    [
        "design",
        "generate --table FOLDER/controller.json",
        "build --table FOLDER/controller.json",
        "simulate --table FOLDER/controller.json",
        "trace elevation_q_1_V_rad[2] --table FOLDER/controller.json",
        "import FOLDER/run.csv",
        "export FOLDER/run.csv",
        "new-plant my_arm",
        "doctor",
    ],
)
def test_a_verb_prints_the_keys_of_its_row(
    command: str,
    ran: tuple[Path, str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    few_angles(monkeypatch)
    verb, *words = command.replace("FOLDER", str(ran[0])).split()
    files = {"import": "log.csv", "export": "log.mf4"}
    out = [] if verb in ("trace", "doctor") else ["--out", str(tmp_path / files.get(verb, ""))]
    assert main([verb, *words, *out, "--json"]) == 0
    assert is_as_documented(verb, json.loads(capsys.readouterr().out))


def test_the_verbs_of_sealed_cases_print_the_keys_of_their_rows(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    # Truth: one case is made and answered by the quickest baseline; a diagnosis takes minutes, so here it is there already.
    works_here(monkeypatch)
    kept = Answered("case-0001", None, None, kept=True)
    monkeypatch.setattr(blind_verb, "answers", lambda *_: iter([kept]))
    cases, answers = str(tmp_path / "cases"), str(tmp_path / "answers")
    for verb, words in {
        "blind make": ["--seed", "5", "--cases", "1", "--kinds", "nominal", "--out", cases],
        "blind baseline": ["residual-size", cases, answers],
        "blind diagnose": [cases, answers],
    }.items():
        capsys.readouterr()
        assert main([*verb.split(), *words, "--json"]) == 0
        assert is_as_documented(verb, json.loads(capsys.readouterr().out))


def test_bad_input_is_the_object_that_the_page_says(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["design", "--plant", str(tmp_path / "none.toml"), "--out", str(tmp_path), "--json"]) == 2
    said = json.loads(capsys.readouterr().out)
    assert set(said) == {"error", "what", "where", "got", "expected", "remedy"}
    assert all(f"`{key}`" in PAGE for key in said)
