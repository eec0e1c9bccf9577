"""What a person sees of a command: progress on a terminal, tables, one line for an error."""

import os
import sys
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import TextIO

from records.text.zeros import unsigned_zeros

WIDTH = 78  # of a line that is written over itself


def colours(stream: TextIO) -> bool:
    """Whether `stream` wants colours: a terminal, and NO_COLOR (https://no-color.org) is not set."""
    return stream.isatty() and not os.environ.get("NO_COLOR") and os.environ.get("TERM") != "dumb"


def paint(text: str, code: int, stream: TextIO) -> str:
    """`text` in an ANSI colour where the stream wants it."""
    return f"\x1b[{code}m{text}\x1b[0m" if colours(stream) else text


@contextmanager
def stage(title: str) -> Iterator[None]:
    """Show `title` on the terminal while the body works and how long it took; nothing in a pipe."""
    if not sys.stderr.isatty():
        yield
        return
    began = time.monotonic()
    sys.stderr.write(f"  {title} ...")
    sys.stderr.flush()
    mark = paint("failed", 31, sys.stderr)
    try:
        yield
        mark = paint("done", 32, sys.stderr)
    finally:
        sys.stderr.write(f"\r  {title:<60} {mark} {time.monotonic() - began:6.1f} s\n")
        sys.stderr.flush()


@contextmanager
def leaving(told: Callable[[], str]) -> Iterator[None]:
    """Interrupted, the body leaves what `told` says in the one line of the error."""
    try:
        yield
    except KeyboardInterrupt as stop:
        raise KeyboardInterrupt(str(stop) or told()) from None


@contextmanager
def tally(title: str, count: int) -> Iterator[Callable[[bool, bool], None]]:
    """Show on the terminal how many of `count` are done; the body is given what to call for each: was it kept from before, did it fail."""
    began, kept, failed, done = time.monotonic(), 0, 0, 0

    def told() -> str:
        further = f", {kept} from before" if kept else ""
        further += paint(f", {failed} failed", 31, sys.stderr) if failed else ""
        left = (time.monotonic() - began) / (done - kept) * (count - done) if done > kept else 0.0
        return f"  {title}: {done} of {count}{further}" + (f", {_duration(left)} to go" if left else "")

    def tell(was_kept: bool, has_failed: bool) -> None:
        nonlocal kept, failed, done
        kept, failed, done = kept + was_kept, failed + has_failed, done + 1
        show()

    def show() -> None:
        if sys.stderr.isatty():
            sys.stderr.write(f"\r{told():<{WIDTH}}")
            sys.stderr.flush()

    show()
    try:
        yield tell
    finally:
        if sys.stderr.isatty():
            sys.stderr.write(f"{time.monotonic() - began:.1f} s\n")


class Countdown:
    """How far a long piece of work is and how long the rest may take, written over one line of a terminal; nothing in a pipe.

    The work comes in `rounds`, each counted from 1 on; one may end early, and each is taken to last as long as those before it. How long
    the rest takes is told from the second call on: before the first there is much that is done once, as compiling.
    """

    def __init__(self, thing: str, rounds: int = 1) -> None:
        self._thing, self._rounds = thing, rounds
        self._round, self._last = 1, 0
        self._first: tuple[float, float] | None = None  # when that was, and the share that was done

    def __call__(self, done: int, of: int) -> None:
        """So many are done of so many of the round at hand; what does not go on from the last call begins another."""
        if self._last and done <= self._last:
            self._round += 1
        self._last = done
        if not sys.stderr.isatty():
            return
        share = min((self._round - 1 + done / of) / self._rounds, 1.0)
        which = f", {self._round} of {self._rounds}" if self._rounds > 1 else ""
        sys.stderr.write(f"\r{f'  {self._thing} {done} of {of}{which}{self._to_go(share)}':<{WIDTH}}")
        if done == of:
            sys.stderr.write(f"\r{'':<{WIDTH}}\r")
        sys.stderr.flush()

    def _to_go(self, share: float) -> str:
        now_s = time.monotonic()
        if self._first is None:
            self._first = now_s, share
        began_s, begun = self._first
        if share <= begun:
            return ""
        return f", {_duration((now_s - began_s) / (share - begun) * (1.0 - share))} to go"


def _duration(seconds: float) -> str:
    """Roughly: 40 s, 12 min, 3.5 h."""
    if seconds < 90.0:
        return f"{seconds:.0f} s"
    return f"{seconds / 60.0:.0f} min" if seconds < 5400.0 else f"{seconds / 3600.0:.1f} h"


def table(rows: Sequence[Sequence[str]], heading: Sequence[str] = ()) -> str:
    """Columns aligned by width: the first to the left, the others too; the heading is underlined."""
    lines = [*([heading] if heading else []), *([unsigned_zeros(cell) for cell in row] for row in rows)]
    widths = [max(len(line[column]) for line in lines) for column in range(len(lines[0]))]
    shown = ["  ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)).rstrip() for line in lines]
    if heading:
        shown.insert(1, "  ".join("-" * width for width in widths))
    return "\n".join(shown)


def notes(sentences: Iterable[str]) -> None:
    """Print sentences, a line each, zero without a sign as in tables and pages."""
    for sentence in sentences:
        print(f"- {unsigned_zeros(sentence)}")


def remark(message: str) -> None:
    """Print one line on stderr that is no error."""
    _on_stderr(f"twinlaw: {message}")


def fail(message: str) -> None:
    """Print one line on stderr, marked as an error; where nothing can be written there the exit status alone tells."""
    _on_stderr(f"{paint('twinlaw: error:', 31, sys.stderr)} {' '.join(message.split())}")


def _on_stderr(line: str) -> None:
    try:
        sys.stderr.write(f"{line}\n")
        sys.stderr.flush()
    except (
        OSError
    ):  # what is still to be written there goes nowhere, or the interpreter would leave with a status of its own
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stderr.fileno())
