"""Colours and progress: on a terminal that wants them, and nowhere else."""

import io
import os
import pty
import re
import subprocess
import sys
from pathlib import Path

import pytest

from tests.soak import sampled
from toolchain.cache import CACHE_DIR
from twinlaw.cli import console

ROOT = Path(__file__).resolve().parents[3]
TWINLAW = [sys.executable, "-m", "twinlaw.command"]
# The verbs that load least, as a process of its own starts each here.
WORKS, FAILS = [*TWINLAW, "doctor", "--json"], [*TWINLAW, "new-plant", "missing.toml"]
ESCAPE = "\x1b["


def on_a_terminal(command: list[str], **environment: str) -> str:
    """What a command shows on a terminal of its own."""
    master, slave = pty.openpty()
    given = {"PATH": os.environ["PATH"], "PYTHONPATH": str(ROOT), "TERM": "xterm", **environment}
    process = subprocess.Popen(command, stdin=slave, stdout=slave, stderr=slave, env=given, cwd=ROOT)
    os.close(slave)
    shown = b""
    try:
        while data := os.read(master, 4096):
            shown += data
    except OSError:
        pass  # the terminal has no writer any more
    os.close(master)
    assert process.wait() == 2
    return shown.decode()


TERMINALS = [({}, True), ({"NO_COLOR": "1"}, False), ({"NO_COLOR": ""}, True), ({"TERM": "dumb"}, False)]


@pytest.mark.parametrize(("environment", "coloured"), sampled(TERMINALS, keep=TERMINALS[:2]))
def test_an_error_is_red_where_the_terminal_wants_it(environment: dict[str, str], coloured: bool) -> None:
    shown = on_a_terminal(FAILS, **environment)
    assert "missing.toml" in shown
    assert (ESCAPE in shown) is coloured


def test_a_pipe_gets_neither_colours_nor_progress() -> None:
    done = subprocess.run(FAILS, capture_output=True, text=True, cwd=ROOT, check=False)
    assert ESCAPE not in done.stdout + done.stderr
    assert done.stderr.count("\n") == 1


class Terminal(io.StringIO):
    """Keeps what a terminal is shown."""

    def isatty(self) -> bool:
        return True


def test_a_countdown_knows_in_which_round_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    # Truth: three rounds of four, the second of which ends after two.
    monkeypatch.setattr(sys, "stderr", Terminal())
    tell = console.Countdown("search: generation", 3)
    for done in (1, 2, 3, 4, 1, 2, 1, 2, 3, 4):
        tell(done, 4)
    shown = [line.strip() for line in sys.stderr.getvalue().split("\r") if line.strip()]  # type: ignore[attr-defined]
    assert shown[0] == "search: generation 1 of 4, 1 of 3"  # nothing to tell from yet
    assert all(line.endswith(" to go") for line in shown[1:])
    assert [shown[0], *(line.rpartition(", ")[0] for line in shown[1:])] == [
        f"search: generation {done} of 4, {which} of 3"
        for which, last in ((1, 4), (2, 2), (3, 4))
        for done in range(1, last + 1)
    ]
    assert shown[-1].endswith(", 0 s to go")


def test_who_has_no_home_hears_nothing_of_it() -> None:
    program = "from twinlaw.command import main; main(['doctor']); import twinlaw.pages.plots"
    given = {"PATH": os.environ["PATH"], "HOME": "/dev/null/none", "TWINLAW_CACHE": str(CACHE_DIR)}
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, cwd=ROOT, env=given)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.parametrize("closed", sampled(["2>&-", ">&-", "<&- >&- 2>&-"], keep=["<&- >&- 2>&-"]))
def test_a_stream_that_the_caller_closed_changes_no_exit_status(closed: str) -> None:
    done = subprocess.run(["sh", "-c", f'exec "$@" {closed}', "sh", *FAILS], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 2
    assert "Traceback" not in done.stderr
    done = subprocess.run(["sh", "-c", f'exec "$@" {closed}', "sh", *WORKS], cwd=ROOT, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")


def test_only_one_place_knows_colours() -> None:
    # So that no verb can forget NO_COLOR: the escape is written in twinlaw/cli/console.py alone.
    escape = re.compile(r"\\x1b|\\033|\\e\[|\\u001b")
    found = [path for path in (ROOT / "twinlaw").rglob("*.py") if escape.search(path.read_text("utf-8"))]
    assert [path.name for path in found] == ["console.py"]


def test_notes_are_lines_of_their_own_in_which_zero_has_no_sign(capsys: pytest.CaptureFixture[str]) -> None:
    console.notes(["the direction +0.91 b -0.00 J", "moved by -0.0 sd"])
    assert capsys.readouterr().out == "- the direction +0.91 b 0.00 J\n- moved by 0.0 sd\n"
