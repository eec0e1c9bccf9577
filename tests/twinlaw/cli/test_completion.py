"""Completion in the real shells: verbs, options, the words of an option, and file names where a file is wanted."""

import json
import os
import pty
import select
import shutil
import subprocess
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from twinlaw.cli.completion import SHELLS, Command, command_tree, completion_text
from twinlaw.command import main
from twinlaw.verbs import VERBS, build_parser

PATIENCE_S = 60.0


@pytest.fixture(scope="module")
def root() -> Command:
    return command_tree(build_parser(tuple(VERBS)))


@pytest.fixture
def scripts(root: Command, tmp_path: Path) -> Callable[[str], Path]:
    """scripts(shell): its script in a folder that holds plant.toml and a folder with a space in its name."""

    def written(shell: str) -> Path:
        if shutil.which(shell) is None:
            pytest.skip(f"no {shell} in the PATH: apt install {shell}")
        (tmp_path / "plant.toml").touch()
        (tmp_path / "my plants").mkdir()
        path = tmp_path / f"twinlaw.{shell}"
        path.write_text(completion_text(root, shell), encoding="utf-8")
        return path

    return written


def test_the_tree_holds_every_verb_and_every_option(root: Command) -> None:
    assert [command.last for command in root.commands] == list(VERBS)
    assert all(command.help for command in root.commands)
    flags = {command.at: {flag for option in command.options for flag in option.flags} for command in root.all}
    assert {"--plant", "--out", "--json", "--arithmetic", "--help"} <= flags["run"]
    assert "--reliability" in flags["blind score"]
    words = {option.flags[-1]: option.words for command in root.all for option in command.options}
    assert "fixed" in words["--arithmetic"]


@pytest.mark.parametrize("shell", SHELLS)
def test_the_verb_prints_the_same_text_every_time(
    root: Command, shell: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["completion", shell]) == 0
    text = capsys.readouterr().out
    assert text == completion_text(root, shell)
    for command in root.all:
        for option in command.options:
            assert all((flag.lstrip("-") if shell == "fish" else flag) in text for flag in option.flags)


def test_another_shell_is_refused_in_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as left:
        main(["completion", "tcsh"])
    assert left.value.code == 2
    assert capsys.readouterr().err.count("\n") == 1


ASKED = [
    ("twinlaw di", {"diagnose"}),
    ("twinlaw b", {"build", "bench", "blind"}),
    ("twinlaw blind ", {"make", "diagnose", "baseline", "score", "calibrate", "sensitivity"}),
    ("twinlaw completion ", set(SHELLS)),
    ("twinlaw run --arithmetic ", {"float32", "fixed"}),
    ("twinlaw run --pl", {"--plant"}),
    ("twinlaw blind score --r", {"--reliability"}),
    ("twinlaw diagnose --ho", {"--holdout"}),
    ("twinlaw watch --port emu", {"emulated"}),
    ("twinlaw compare --controllers pid l", {"lqg"}),
    ("twinlaw compare --controllers pid lqg --ef", {"--effects"}),
]


@pytest.mark.parametrize(("line", "offered"), ASKED)
def test_bash_offers_what_fits(scripts: Callable[[str], Path], line: str, offered: set[str]) -> None:
    script = scripts("bash")
    words = line.split(" ")
    array = " ".join(json.dumps(word) for word in words)
    program = f'source {script}; COMP_WORDS=({array}); COMP_CWORD={len(words) - 1}; _twinlaw; printf "%s\\n" "${{COMPREPLY[@]}}"'
    done = subprocess.run(["bash", "-c", program], capture_output=True, text=True, check=True)
    assert (set(done.stdout.split()), done.stderr) == (offered, "")


def test_bash_leaves_file_names_to_the_shell(scripts: Callable[[str], Path]) -> None:
    asked = "COMP_WORDS=(twinlaw run --plant pl); COMP_CWORD=3; _twinlaw"
    program = f"source {scripts('bash')}; {asked}; echo ${{#COMPREPLY[@]}}; complete -p twinlaw"
    done = subprocess.run(["bash", "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines() == ["0", "complete -o default -F _twinlaw twinlaw"]


@pytest.mark.parametrize(
    ("line", "offered"),
    [*ASKED, ("twinlaw run --plant pl", {"plant.toml"}), ("twinlaw run --plant my", {"my plants/"})],
)
def test_fish_offers_what_fits(scripts: Callable[[str], Path], line: str, offered: set[str]) -> None:
    script = scripts("fish")
    program = f"source {script}; complete --do-complete {json.dumps(line)}"
    home = {**os.environ, "HOME": str(script.parent), "XDG_CONFIG_HOME": str(script.parent / "config")}
    done = subprocess.run(
        ["fish", "--no-config", "-c", program], capture_output=True, text=True, check=True, env=home, cwd=script.parent
    )
    found = {entry.split("\t")[0] for entry in done.stdout.splitlines()}
    # For a value fish also offers what fits loosely: what begins as it was typed is what counts.
    typed = line.rsplit(" ", 1)[-1]
    assert {word for word in found if word.startswith(typed) and not (typed == "" and word.startswith("-"))} == offered
    assert done.stderr == ""


@pytest.mark.parametrize(
    ("typed", "becomes"),
    [
        ("twinlaw diag", "twinlaw diagnose "),
        ("twinlaw blind sc", "twinlaw blind score "),
        ("twinlaw run --pla", "twinlaw run --plant"),
        ("twinlaw run --arithmetic fl", "twinlaw run --arithmetic float32 "),
        ("twinlaw run --plant plan", "twinlaw run --plant plant.toml "),
        ("twinlaw watch --port emu", "twinlaw watch --port emulated "),
        ("twinlaw compare --controllers pid lq", "twinlaw compare --controllers pid lqg "),
        ("twinlaw compare --controllers pid lqg --eff", "twinlaw compare --controllers pid lqg --effects"),
    ],
)
def test_zsh_completes_what_is_typed(scripts: Callable[[str], Path], typed: str, becomes: str) -> None:
    script = scripts("zsh")
    start = f"PS1='> '; autoload -Uz compinit; compinit -D -u; source {script}; print READY\n"
    assert becomes in screen(["zsh", "-f", "-i"], start, f"{typed}\t", becomes, script.parent)


def screen(command: list[str], start: str, typed: str, wanted: str, folder: Path) -> str:
    """What a shell in a terminal of its own shows after `typed`; it is waited for until `wanted` is there."""
    child, terminal = pty.fork()
    if child == 0:
        os.chdir(folder)
        os.environ.update({"TERM": "dumb", "HOME": str(folder)})
        os.execvp(command[0], command)
    try:
        os.write(terminal, start.encode())
        until_shown(terminal, "\nREADY")
        os.write(terminal, typed.encode())
        return until_shown(terminal, wanted)
    finally:
        os.close(terminal)
        os.waitpid(child, 0)


def until_shown(terminal: int, wanted: str) -> str:
    shown, end = "", time.monotonic() + PATIENCE_S
    while wanted not in shown.replace("\r", "") and time.monotonic() < end:
        if select.select([terminal], [], [], 0.1)[0]:
            shown += os.read(terminal, 4096).decode(errors="replace")
    return shown.replace("\r", "")
