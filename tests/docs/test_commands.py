"""Every command on every page works as it stands, or with smaller numbers, or a table here says why it is not tried."""

import os
import re
import shlex
import shutil
import subprocess
import sys
import tomllib
from functools import cache
from pathlib import Path

import pytest

from recordings.datasets.files import datasets_folder
from tests.docs.commands import PAGES, calls, checkout, commands, fenced, mentions
from tests.test_project import ROOT
from toolchain.cache import CACHE_DIR
from twinlaw.cli.completion import Command, command_tree
from twinlaw.verbs import VERBS, build_parser

RUN = "twinlaw run --plant plants/ce150.toml --out build"  # once for all pages

# A pattern at the beginning of a command, and why it is not tried here; it is read by the real parser nevertheless.
NOT_TRIED = {
    r"make |\. \.venv": "sets up an environment; tests/docs/test_tutorial.py tries what `make run` calls",
    r"twinlaw run$": "as `make run`: tests/docs/test_readme.py",
    r"twinlaw run --plant plants/mine\.toml": "the chain with another file: docs/identification.md",
    r"twinlaw flash$|twinlaw .*--port /dev/": "needs a board",
    r"twinlaw flash --port emulated": "needs stm32flash; tests/rig/programming/test_flash.py",
    r"twinlaw watch": "runs until it is ended; tests/docs/test_tutorial.py does",
    r"twinlaw compare|cp build-compare": "takes minutes; tests/twinlaw/verbs/test_compare.py with fewer flights",
    r"twinlaw envelope": "takes a minute; tests/twinlaw/verbs/test_envelope.py with one condition",
    r"twinlaw diagnose --plant plants/(?!ce150)": "takes minutes on a recording; tests/diagnosis/test_real_data.py has one",
    r"twinlaw splits |python tests/real_rigs\.py": "takes minutes; tests/twinlaw/workflows/test_splits.py with two short logs",
    r"twinlaw identify .*--search genetic": "takes ten seconds; tests/twinlaw/verbs/test_identify_genetic.py",
    r"twinlaw sweep .*--repetitions": "tests/twinlaw/verbs/test_frequency.py with one repetition",
    r"twinlaw blind make --rig second": "tests/blind/test_second_make.py",
    r"twinlaw blind calibrate": "needs answers to many cases; tests/blind/test_calibrate.py has some made up",
    r"twinlaw blind sensitivity": "takes minutes; tests/twinlaw/workflows/test_sensitivity.py with a case of six seconds",
    r"twinlaw experiments --plant .*velagic.*--repetitions": "the repetitions of docs/identification.md with another plant",
    r"pip |dask |twinlaw .*--cluster": "needs other computers; tests/jobs/test_cluster.py has some on this one",
}
# What is smaller here than on the page, so that it takes seconds.
SMALLER = {
    "--repetitions 100": "--repetitions 1",
    r"--seed \d+ --cases \d{3}": "--seed 3 --cases 1 --kinds nominal",
    "--cases 2 --workers": "--cases 1 --workers",
}
HELD = {"docs/tutorial.md": "tests/docs/test_tutorial.py", "docs/new-plant.md": "tests/docs/test_new_plant.py"}
TRIED = tuple(page for page in PAGES if page not in HELD and commands(page))


def reason(command: str) -> str | None:
    """Why a command is not tried, if it is not."""
    return next((why for pattern, why in NOT_TRIED.items() if re.match(pattern, command)), None)


def smaller(command: str) -> str:
    for large, small in SMALLER.items():
        command = re.sub(large, small, command)
    return command


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What RUN leaves."""
    folder = checkout(tmp_path_factory.mktemp("built"))
    shell(RUN, folder)
    return folder / "build"


def shell(command: str, folder: Path) -> None:
    path = f"{folder / 'bin'}:{os.environ['PATH']}"
    given = {"PATH": path, "PYTHONPATH": str(ROOT), "TWINLAW_CACHE": str(CACHE_DIR)}
    given["TWINLAW_DATASETS"] = str(datasets_folder())
    done = subprocess.run(
        ["sh", "-e", "-c", command], cwd=folder, env={**os.environ, **given}, capture_output=True, text=True
    )
    assert done.returncode == 0, f"{command}\n{done.stdout}{done.stderr}"


@pytest.mark.soak
@pytest.mark.parametrize("page", TRIED)
def test_the_commands_of_a_page_work_in_their_order(page: str, built: Path, tmp_path: Path) -> None:
    if page == "docs/real-data.md" and not (datasets_folder() / "emps").is_dir():
        pytest.skip(f"no recordings in {datasets_folder()}: see recordings/datasets/registry.toml")
    folder = checkout(tmp_path / "checkout")
    shutil.copytree(built, folder / "build")
    for command in commands(page):
        if command != RUN and reason(command) is None:
            shell(smaller(command), folder)
    for program in fenced(page, "python"):
        done = subprocess.run(
            [sys.executable, "-c", program],
            cwd=folder,
            env={**os.environ, "PYTHONPATH": str(ROOT)},
            capture_output=True,
        )
        assert done.returncode == 0, done.stderr.decode()


@pytest.mark.parametrize("page", PAGES)
def test_the_parser_takes_every_command_and_knows_what_sentences_mention(page: str) -> None:
    for call in calls(page):
        words = shlex.split(call.replace("$", ""))[1:]
        build_parser(words[:1]).parse_args(words)
    for mention in mentions(page):
        verb, *words = mention.split()[1:]
        assert verb in VERBS, mention
        known = {flag for entry in tree_of(verb).all for option in entry.options for flag in option.flags}
        assert {word for word in words if word.startswith("--")} <= known, mention


@cache
def tree_of(verb: str) -> Command:
    """A verb with what is below it."""
    return next(entry for entry in command_tree(build_parser((verb,))).commands if entry.last == verb)


def test_programs_and_files_on_a_page_are_held() -> None:
    with_programs = [page for page in PAGES if fenced(page, "python") and page not in HELD]
    assert set(with_programs) <= set(TRIED)
    for page in PAGES:
        for text in fenced(page, "toml"):
            tomllib.loads(text)


def test_no_reason_and_no_smaller_number_has_outlived_its_command() -> None:
    shown = [command for page in PAGES for command in commands(page)]
    for pattern in NOT_TRIED:
        assert any(re.match(pattern, command) for command in shown), pattern
    for large in SMALLER:
        assert any(re.search(large, command) for command in shown), large
