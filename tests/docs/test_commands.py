"""Every command on every page works as it stands, or with smaller numbers, or a table here says why it is not tried."""

import os
import re
import shlex
import shutil
import signal
import socket
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from functools import cache
from importlib.util import find_spec
from pathlib import Path

import pytest

from recordings.datasets.files import datasets_folder
from rig.emulator.pty_port import PtyBoard
from tests.docs.reading.commands import PAGES, calls, checkout, commands, fenced, indented, mentions
from tests.test_project import ROOT
from toolchain.cache import CACHE_DIR
from twinlaw.cli.completion import Command, command_tree
from twinlaw.verbs import VERBS, build_parser

RUN = "twinlaw run --plant plants/ce150.toml --out build"  # once for all pages
PATIENCE_S = 600.0

# A pattern at the beginning of a command, and why it is not tried here; it is read by the real parser nevertheless.
NOT_TRIED = {
    r"make |\. \.venv|pip ": "changes the environment; tests/docs/test_tutorial.py tries what `make run` calls",
}
# What is smaller here than on the page, so that it takes a minute or two at most.
SMALLER = {
    "--repetitions (100|60|17)": "--repetitions 1",
    r"--rig real --seed \d+ --cases \d{2,3}": "--rig real --seed 3 --cases 1 --kinds nominal",
    r"--seed \d+ --cases \d{2,3}": "--seed 3 --cases 1 --kinds single",
    r"--cases \d{2,3}": "--cases 1",
    "--cases 2 --workers": "--cases 1 --workers",
    "--constant ALARM MATTERS --factors 0.7 1.4": "--constant ALARM --factors 1.4",
    "compare --plant plants/ce150.toml": r"\g<0> --controllers pid --runs 2 --effects azimuth.cable_spring --steps 1000",
    "splits --plant": "splits --most 1 --plant",
    r"campaign 1000000": "campaign 1000",
    r"real_rigs\.py rigs": r"\g<0> --only maglev_coil --most 1",
}
# What a page leaves to the reader, and what is none of this computer's: the board, the other computers.
READERS = {
    "envelope --seed 1": r"\g<0> --keep-flights",
    "FLIGHTS": "envelope/flights",
}
NO_TOOL = (
    r"twinlaw flash"  # what programs a chip is not found here: the answer says so; tests/rig/programming has it found
)
WATCHES, SERVES = r"twinlaw watch", r"dask "  # both run until they are ended
ADDRESS = "10.0.0.5:8786"
HELD = {"docs/tutorial.md": "tests/docs/test_tutorial.py", "docs/new-plant.md": "tests/docs/test_new_plant.py"}
TRIED = tuple(page for page in PAGES if page not in HELD and commands(page))


def reason(command: str) -> str | None:
    """Why a command is not tried, if it is not."""
    return next((why for pattern, why in NOT_TRIED.items() if re.match(pattern, command)), None)


def smaller(command: str) -> str:
    """The command with what is smaller here, and with what a reader puts in."""
    for large, small in {**SMALLER, **READERS}.items():
        command = re.sub(large, small, command)
    return command


def _free_port() -> int:
    with socket.socket() as there:
        there.bind(("127.0.0.1", 0))
        return int(there.getsockname()[1])


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What RUN leaves."""
    folder = checkout(tmp_path_factory.mktemp("built"))
    shell(RUN, folder)
    return folder / "build"


@pytest.fixture(scope="module")
def board(built: Path) -> Iterator[str]:
    """The device of an emulated board that carries what RUN left."""
    with PtyBoard(built / "firmware.elf") as there:
        yield there.path


@pytest.fixture
def serving() -> Iterator[list[subprocess.Popen[bytes]]]:
    """What a page has started and not ended; it is ended behind the page."""
    there: list[subprocess.Popen[bytes]] = []
    yield there
    for process in reversed(there):
        process.terminate()
        process.wait(PATIENCE_S)


def environment(folder: Path) -> dict[str, str]:
    path = f"{folder / 'bin'}:{os.environ['PATH']}"
    given = {"PATH": path, "PYTHONPATH": os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])}
    given |= {"TWINLAW_CACHE": str(CACHE_DIR), "TWINLAW_DATASETS": str(datasets_folder())}
    return {**os.environ, **given}


def shell(command: str, folder: Path) -> None:
    done = subprocess.run(
        ["sh", "-e", "-c", command], cwd=folder, env=environment(folder), capture_output=True, text=True
    )
    assert done.returncode == 0, f"{command}\n{done.stdout}{done.stderr}"


def without_a_tool(command: str, folder: Path) -> None:
    """Where what programs a chip is not installed, the command names it in one line and has done nothing."""
    here = {**environment(folder), "PATH": str(folder / "bin")}
    done = subprocess.run(["/bin/sh", "-c", command], cwd=folder, env=here, capture_output=True, text=True)
    assert (done.returncode, done.stderr.count("\n")) == (2, 1), done.stderr
    assert ("stm32flash" if "--port" in command else "openocd") in done.stderr


def watched(command: str, folder: Path) -> None:
    """Start a watch, see that it offers an address, and end it as a person does."""
    process = subprocess.Popen(
        shlex.split(command),
        cwd=folder,
        env=environment(folder),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        assert process.stdout is not None
        first = process.stdout.readline()
        assert first.startswith("open http://127.0.0.1:"), (command, first, process.communicate()[1])
        process.send_signal(signal.SIGINT)
        assert process.wait(PATIENCE_S) == 0, command
    finally:
        process.kill()


@pytest.mark.soak
@pytest.mark.parametrize("page", TRIED)
def test_the_commands_of_a_page_work_in_their_order(
    page: str, built: Path, board: str, tmp_path: Path, serving: list[subprocess.Popen[bytes]]
) -> None:
    if page == "docs/real-data.md" and not (datasets_folder() / "emps").is_dir():
        pytest.skip(f"no recordings in {datasets_folder()}: see recordings/datasets/registry.toml")
    folder = checkout(tmp_path / "checkout")
    shutil.copytree(built, folder / "build")
    (folder / "STARTS.toml").write_text(indented(page, 'schema = "starts/1"'))
    address = f"127.0.0.1:{_free_port()}"
    for shown in commands(page):
        command = smaller(shown).replace("/dev/ttyACM0", board).replace(ADDRESS, address)
        if command == RUN or reason(command) is not None:
            continue
        if re.match(SERVES, command):
            if find_spec("distributed") is None:
                pytest.skip("no Dask: pip install --editable '.[cluster]'")
            told = command.replace(
                "dask scheduler", f"dask scheduler --host 127.0.0.1 --port {address.partition(':')[2]}"
            )
            words = [sys.executable, "-m", *told.split()]
            serving.append(subprocess.Popen(words, cwd=folder, env=environment(folder), stderr=subprocess.DEVNULL))
        elif re.match(WATCHES, command):
            watched(command, folder)
        elif re.match(NO_TOOL, command):
            without_a_tool(command, folder)
        else:
            shell(command, folder)
    for program in fenced(page, "python"):
        done = subprocess.run(
            [sys.executable, "-c", program],
            cwd=folder,
            env={**os.environ, "PYTHONPATH": str(ROOT)},
            capture_output=True,
        )
        assert done.returncode == 0, done.stderr.decode()


@pytest.mark.soak
def test_what_the_page_on_a_real_board_mentions_works_on_an_emulated_one(
    built: Path, board: str, tmp_path: Path
) -> None:
    folder = checkout(tmp_path / "checkout")
    shutil.copytree(built, folder / "build")
    told = dict.fromkeys(
        call for call in mentions("docs/hardware.md") if re.match("twinlaw (validate|watch) --port", call)
    )
    assert len(told) == 5
    for call in told:
        command = re.sub("--port [A-Z]+|--port /dev/ttyACM0", f"--port {board}", call).removesuffix(" --steps 100000")
        command += " --steps 500" if "validate" in command else ""
        (watched if re.match(WATCHES, command) else shell)(command, folder)


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
    for large in (*SMALLER, *READERS):
        assert any(re.search(large, command) for command in shown), large
