"""The tutorial does what it says: each of its commands runs, in its order, and the gap gets the name that the page promises."""

import json
import os
import re
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from tests.test_project import ROOT
from toolchain.cache import CACHE_DIR

PAGE = (ROOT / "docs" / "tutorial.md").read_text(encoding="utf-8")
BLOCK = re.compile(r"(?:^    .*\n|^\n(?=    ))+", flags=re.MULTILINE)
NUMBER = re.compile(r"(?<![\w.^])-?\d+(?:\.\d+)?(?:e-?\d+)?")
PATIENCE_S = 600.0


def blocks() -> list[str]:
    """The page's indented blocks, as a shell reads them."""
    return [re.sub(r"^    ", "", block, flags=re.MULTILINE).strip() for block in BLOCK.findall(PAGE) if block.strip()]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A checkout in so far as the page needs one, with `twinlaw` in the PATH."""
    (tmp_path / "plants").symlink_to(ROOT / "plants")
    program = tmp_path / "bin" / "twinlaw"
    program.parent.mkdir()
    program.write_text(f'#!/bin/sh\nexec {sys.executable} -m twinlaw.command "$@"\n')
    program.chmod(0o755)
    return tmp_path


@pytest.mark.soak
def test_every_command_of_the_page_works_and_the_gap_gets_its_name(folder: Path) -> None:
    path = f"{folder / 'bin'}:{os.environ['PATH']}"
    environment = {**os.environ, "PATH": path, "PYTHONPATH": str(ROOT), "TWINLAW_CACHE": str(CACHE_DIR)}
    found = blocks()
    assert found[:2] == ["make run", ". .venv/bin/activate"]
    shell("twinlaw run --plant plants/ce150.toml --out build", folder, environment)  # as the Makefile does
    for block in found[2:]:
        if block.startswith("twinlaw watch"):
            for command in block.splitlines():
                look(command, folder, environment)
        else:
            said = shell(block, folder, environment)
            if block.split("\n")[-1].startswith("twinlaw diagnose"):
                as_the_page_prints_it(said)
    diagnosis = json.loads((folder / "build/diagnosis/diagnosis.json").read_text())
    assert diagnosis["verdict"] == "gap"
    assert diagnosis["found"] == ["azimuth.cable_spring"]
    assert diagnosis["shrinkage"]["fraction"] > 0.8


def test_the_makefile_runs_what_the_page_says_that_it_runs() -> None:
    makefile = (ROOT / "Makefile").read_text()
    assert "twinlaw run --plant $(PLANT) --out $(OUT)" in makefile
    assert "PLANT ?= plants/ce150.toml" in makefile
    assert "OUT ?= build" in makefile


def as_the_page_prints_it(said: str) -> None:
    """The page's lines are said in their order, in these words; the figures within 5 %, as their last bits are the processor's."""
    (printed,) = re.findall(r"^```text\n(.*?)^```", PAGE, flags=re.MULTILINE | re.DOTALL)
    lines = iter(said.splitlines())
    for wanted in printed.splitlines():
        if wanted != "...":
            found = next((line for line in lines if NUMBER.sub("#", line) == NUMBER.sub("#", wanted)), None)
            assert found is not None, (wanted, said)
            if "chance" not in wanted:  # its exponent alone is told, and moves by one with a bit here and there
                assert numbers(found) == pytest.approx(numbers(wanted), rel=0.05), (found, wanted)
    for symbol, secret in secrets().items():
        told = re.search(rf"cable_spring .*\b{symbol} (\S+) ± (\S+)", said)
        assert told is not None
        assert abs(float(told[1]) - secret) <= 2.0 * float(told[2]), (symbol, told[0])  # as the page says


def secrets() -> dict[str, float]:
    """The numbers of the page's spring; one that is not given is zero."""
    given = re.findall(r"\[effects\.azimuth\.cable_spring\.(\w+)\]\n +value = (\S+)", PAGE)
    return {"h": 0.0, **{symbol: float(value) for symbol, value in given}}


def numbers(line: str) -> list[float]:
    return [float(number) for number in NUMBER.findall(line)]


def shell(script: str, folder: Path, environment: dict[str, str]) -> str:
    done = subprocess.run(["sh", "-e", "-c", script], cwd=folder, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, script + done.stdout + done.stderr
    return done.stdout


def look(command: str, folder: Path, environment: dict[str, str]) -> None:
    """Start a watch, see that it offers an address, and end it as a person does."""
    words = command.split()
    process = subprocess.Popen(words, cwd=folder, env=environment, stdout=subprocess.PIPE, text=True)
    try:
        assert process.stdout is not None
        assert process.stdout.readline().startswith("open http://127.0.0.1:")
        process.send_signal(signal.SIGINT)
        assert process.wait(PATIENCE_S) == 0
    finally:
        process.kill()
