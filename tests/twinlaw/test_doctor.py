"""`twinlaw doctor` says what is there, what is not and who misses it."""

import json
import shutil
from pathlib import Path

import pytest

from toolchain import host
from twinlaw.command import main
from twinlaw.verbs.doctor import NEEDED, packages


def findings(capsys: pytest.CaptureFixture[str]) -> dict[str, dict[str, str | None]]:
    return {finding["name"]: finding for finding in json.loads(capsys.readouterr().out)}


def test_what_every_verb_needs_is_here(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["doctor", "--json"]) == 0
    found = findings(capsys)
    assert all(finding["found"] for finding in found.values() if finding["needed_for"] == NEEDED)
    assert {"Python", "numpy", "ziglang", "C compiler", "openocd"} <= found.keys()


def test_a_program_that_is_not_there_is_missing_with_its_remedy(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(shutil, "which", lambda name: None)
    assert main(["doctor"]) == 0
    line = next(line for line in capsys.readouterr().out.splitlines() if line.startswith("stm32flash"))
    assert "missing" in line
    assert line.endswith("apt install stm32flash")


def test_packages_come_by_the_extra_that_asks_for_them() -> None:
    asked = ["numpy>=2.0", 'no-such-package>=1; extra == "peers"', "no_such_either"]
    named = {finding.name: finding for finding in packages(asked)}
    assert named["numpy"].found
    assert named["no-such-package"].needed_for.startswith("bench")
    assert named["no_such_either"].needed_for == NEEDED
    assert named["no_such_either"].found is None


def test_a_compiler_that_cannot_compile_is_said_and_fails(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(host, "CACHE_DIR", tmp_path)
    monkeypatch.setattr(host.sys, "executable", "/bin/false")
    assert main(["doctor"]) == 1
    assert "C compiler is missing" in capsys.readouterr().err
