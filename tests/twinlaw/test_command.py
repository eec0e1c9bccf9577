"""The command's own promises: exit status 1 is a failed verification alone, and no traceback comes out of it."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from toolchain.cache import CACHE_DIR
from twinlaw import command
from twinlaw.command import main

ROOT = Path(__file__).resolve().parents[2]


def test_a_fault_of_our_own_is_one_line_and_no_failed_verification(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    def broken(words: list[str], alone: bool) -> int:
        raise KeyError("Psi_m")

    monkeypatch.setattr(command, "_obey", broken)
    monkeypatch.setattr(command, "CACHE_DIR", tmp_path / "cache")
    assert main(["design", "--json"]) == 2
    told = capsys.readouterr()
    assert len(told.err.splitlines()) == 1
    assert "KeyError: 'Psi_m'" in told.err
    assert "fault of twinlaw itself" in json.loads(told.out)["error"]
    assert "Traceback" in (tmp_path / "cache" / "last-fault.txt").read_text()
    monkeypatch.setattr(command, "CACHE_DIR", tmp_path / "cache" / "last-fault.txt")
    assert main(["design"]) == 2


@pytest.mark.parametrize("name", [b"pl\xe4n.toml", b"\xff", "plän".encode("latin1") + b"/a.toml"])
def test_a_name_that_is_no_utf8_is_refused_before_anything_is_made(name: bytes, tmp_path: Path) -> None:
    arguments = [b"run", b"--plant", name, b"--out", b"o"]
    given = {**os.environ, "TWINLAW_CACHE": str(CACHE_DIR), "PYTHONPATH": str(ROOT)}
    words = [os.fsencode(sys.executable), b"-m", b"twinlaw.command", *arguments]
    done = subprocess.run(words, cwd=tmp_path, env=given, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout, list(tmp_path.iterdir())) == (2, "", [])
    assert "no UTF-8" in done.stderr
    assert len(done.stderr.splitlines()) == 1


@pytest.mark.parametrize(("text", "told"), [("b'2:a\udce4.csv' of 3", r"2:a\xe4.csv"), ("\udcff", r"\xff")])
def test_a_name_on_the_disk_that_is_no_utf8_is_told_as_bad_input(
    text: str, told: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Truth: in a folder that was named lies a file whose name has the lone byte; it is met in the middle of a verb."""

    def broken(words: list[str]) -> int:
        return len(text.encode())

    monkeypatch.setattr(command, "build_parser", broken)
    assert main(["diagnose", "--json"]) == 2
    content = json.loads(capsys.readouterr().out)
    assert (content["where"], content["remedy"]) == (told, "rename it")


@pytest.mark.parametrize("writable", [True, False])
def test_a_cache_that_cannot_be_written_where_it_was_asked_for_is_told_once(tmp_path: Path, writable: bool) -> None:
    """Truth: in place of the folder stands a file, and nothing is made there; doctor names both."""
    asked = tmp_path / "asked"
    if not writable:
        asked.touch()
    given = {**os.environ, "TWINLAW_CACHE": str(asked), "PYTHONPATH": str(ROOT)}
    words = [sys.executable, "-m", "twinlaw.command", "doctor", "--json"]
    done = subprocess.run(words, cwd=tmp_path, env=given, capture_output=True, text=True, check=False)
    told = f"twinlaw: TWINLAW_CACHE={asked} cannot be used: what can be made again is kept in "
    found = {entry["name"]: entry for entry in json.loads(done.stdout)}
    if writable:
        assert done.stderr == ""
        assert found["cache"]["found"] == str(asked)
        assert "TWINLAW_CACHE" not in found
        return
    assert done.stderr == f"{told}{found['cache']['found']}\n"
    assert found["TWINLAW_CACHE"]["found"] is None


def test_a_name_in_utf8_is_told_as_it_is(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["design", "--plant", str(tmp_path / "plän λ.toml")]) == 2
    assert "plän λ.toml" in capsys.readouterr().err


def test_an_option_that_a_verb_has_not_is_told_with_that_verb_s_help(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as left:
        main(["generate", "--plant", "plants/ce150.toml"])
    assert left.value.code == 2
    assert (
        "unrecognized arguments: --plant plants/ce150.toml; `twinlaw generate --help` names" in capsys.readouterr().err
    )
