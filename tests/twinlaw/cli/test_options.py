"""Options that several verbs share mean the same in each, wherever they stand."""

import argparse
from pathlib import Path

import pytest

from twinlaw.cli import options
from twinlaw.command import main
from twinlaw.verbs import verb_module

VERBS = {"diagnose": "logs", "identify": "files"}


def split(verb: str, *words: str) -> tuple[list[Path], list[Path]]:
    """Logs held out, and the others."""
    parser = argparse.ArgumentParser()
    verb_module(verb).add_arguments(parser)
    chosen = parser.parse_args(words)
    return options.held_out(chosen, VERBS[verb]), getattr(chosen, VERBS[verb])


@pytest.mark.parametrize("verb", VERBS)
@pytest.mark.parametrize(
    "words",
    [
        ["--holdout", "a.csv", "b.csv", "--out", "d", "c.csv", "e.csv"],
        ["--out", "d", "c.csv", "e.csv", "--holdout", "a.csv", "b.csv"],
        ["--holdout", "a.csv", "b.csv", "--", "c.csv", "e.csv"],
        ["--holdout", "a.csv", "--holdout", "b.csv", "--out", "d", "c.csv", "e.csv"],
    ],
)
def test_several_logs_are_held_out_after_one_option_or_after_several(verb: str, words: list[str]) -> None:
    assert split(verb, *words) == ([Path("a.csv"), Path("b.csv")], [Path("c.csv"), Path("e.csv")])


@pytest.mark.parametrize("verb", VERBS)
@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--holdout", "a.csv", "b.csv"], ["all 2 logs held out", "give --holdout behind the others"]),
        ([], ["got none, expected at least one"]),
    ],
)
def test_a_command_without_a_log_to_use_says_so_in_one_line(
    verb: str, words: list[str], said: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([verb, "--out", str(tmp_path / "out"), *words]) == 2
    told = capsys.readouterr().err
    assert all(word in told for word in said)
    assert told.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_two_logs_of_one_name_are_refused_before_either_is_lost(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    paths = [tmp_path / day / "log.csv" for day in ("monday", "tuesday")]
    for path in paths:
        path.parent.mkdir()
        path.with_suffix(".toml").write_text('schema = "run-log/1"\n')
    for words in (paths, [paths[0], "--holdout", paths[1]]):
        assert main(["identify", "--out", str(tmp_path / "out"), *map(str, words)]) == 2
        assert "log: logs: got two of this name" in capsys.readouterr().err


@pytest.mark.parametrize(
    "words",
    [
        ["validate", "--dtr", "off"],
        ["watch", "--rts", "on"],
        ["watch", "--port", "flight.csv", "--dtr", "on"],
        ["validate", "--port", "emulated://firmware.elf", "--rts", "off"],
    ],
)
def test_a_line_is_not_set_of_what_has_none(words: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    """Truth: an emulated board and a log have neither DTR nor RTS."""
    assert main(words) == 2
    said = capsys.readouterr().err
    assert "expected a serial port, which has these lines" in said
    assert said.count("\n") == 1
