"""The command `twinlaw`: one verb per file of twinlaw/verbs, named in the order of the work.

Exit status: 0 done, 1 a verification failed, 2 bad input (one line on stderr: where, what, got, expected, remedy; with --json the same as
an object on stdout).
"""

import gc
import json
import logging
import os
import re
import signal
import sys
import traceback
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from io import TextIOWrapper

from jobs.threads import told_late
from records.errors import BadInput, VerificationFailed
from toolchain.cache import CACHE_DIR, NOT_AS_ASKED
from twinlaw.cli import console
from twinlaw.cli.parser import WrongCommandLine
from twinlaw.verbs import build_parser


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one verb and return the exit status."""
    alone = arguments is None  # the process is this command's, and does nothing else
    if alone:
        gc.disable()  # to read modules takes a quarter longer where rubbish is looked for, of which there is none
    _stand_in_for_closed_streams()
    _print_anything()
    if alone and NOT_AS_ASKED:
        console.remark(NOT_AS_ASKED)
    words = list(sys.argv[1:] if arguments is None else arguments)
    # Matplotlib would keep its list of fonts in the home folder, and complain where there is none.
    os.environ.setdefault("MPLCONFIGDIR", str(CACHE_DIR / "matplotlib"))
    logging.getLogger("matplotlib.font_manager").setLevel(logging.ERROR)  # nor tell that it looks for them
    try:
        with told_late():
            status = _obey(words, alone)
        sys.stdout.flush()  # here, where a full disk can still be told
        return status
    except VerificationFailed as error:
        console.fail(str(error))
        return 1
    except BrokenPipeError:
        # The reader of a pipe has left (`twinlaw bench | head`): not an error of ours.
        _silence_stdout()
        return 0
    except OSError as error:
        _silence_stdout()
        place = error.filename or "standard output"
        console.fail(
            f"{place}: got {error.strerror or error}, expected room and leave to write; free the disk, or go elsewhere"
        )
        return 2
    except Exception as error:  # a fault of ours: a trace is for whoever mends it, and exit status 1 would be Python's
        return _own_fault(error, words)
    except KeyboardInterrupt as stop:
        console.fail(f"interrupted; {str(stop) or 'files already written are whole, the others were not begun'}")
        return 128 + signal.SIGINT


def _own_fault(error: Exception, words: Sequence[str]) -> int:
    """What no check of the input has foreseen, in one line, its trace in a file."""
    trace = CACHE_DIR / "last-fault.txt"
    line = f"{type(error).__name__}: {error}: got a fault of twinlaw itself, expected none"
    try:
        trace.parent.mkdir(parents=True, exist_ok=True)
        trace.write_text("".join(traceback.format_exception(error)), encoding="utf-8", errors="backslashreplace")
        line += f"; report it with the command and {trace}"
    except OSError:
        line += "; report it with the command"
    console.fail(line)
    _tell_program(words, {"error": line})
    return 2


def _demand_utf8(words: Sequence[str]) -> None:
    """Raise BadInput for a name in bytes that are no UTF-8, which no page, table or JSON could hold."""
    for word in words:
        try:
            word.encode()
        except UnicodeEncodeError:
            raise _no_utf8("name on the command line", word) from None


def _no_utf8(what: str, name: str) -> BadInput:
    told = os.fsencode(name).decode("utf-8", "backslashreplace")
    return BadInput(what, told, "bytes that are no UTF-8", "a name in UTF-8", "rename it")


def _found_name(error: UnicodeEncodeError) -> str:
    """The word in which the byte stands that a name on the disk has brought."""
    return (
        re.split(r"[\s\"'`<>]", error.object[: error.start])[-1]
        + re.split(r"[\s\"'`<>]", error.object[error.start :])[0]
    )


def _obey(words: Sequence[str], alone: bool) -> int:
    """Run the verb; what cannot be used is told in one line, and to a program as an object too."""
    try:
        _demand_utf8(words)
        options = build_parser(words[:1]).parse_args(words)
        if alone:
            _collect_seldom()
        return int(options.run(options))
    except WrongCommandLine as error:
        _tell_program(words, {"error": error.line})
        raise
    except BadInput as error:
        return _bad_input(error, words)
    except UnicodeEncodeError as error:  # of a folder's files, or of the folder of the program itself
        if error.reason != "surrogates not allowed":
            raise
        return _bad_input(_no_utf8("name of a file or folder", _found_name(error)), words)


def _bad_input(error: BadInput, words: Sequence[str]) -> int:
    console.fail(str(error))
    _tell_program(words, {"error": str(error), **asdict(error)})
    return 2


def _collect_seldom() -> None:
    """What was imported stays until the end, and equations are trees of many small objects: rubbish is looked for among others, seldom."""
    gc.freeze()
    gc.set_threshold(20_000)  # objects, where 700 are usual
    gc.enable()


def _tell_program(words: Sequence[str], content: Mapping[str, str]) -> None:
    if "--json" in words:
        print(json.dumps(content), flush=True)


def _stand_in_for_closed_streams() -> None:
    """A stream that the caller closed (`2>&-`) leads nowhere: the exit status tells, and no file of ours takes its number."""
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is None:
            setattr(sys, name, os.fdopen(os.open(os.devnull, os.O_RDWR), mode))


def _print_anything() -> None:
    """What the terminal's encoding lacks is told in its stead, as Python does on stderr."""
    if isinstance(sys.stdout, TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")


def _silence_stdout() -> None:
    """What is still to be written there goes nowhere, and the interpreter leaves without complaint."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


if __name__ == "__main__":
    sys.exit(main())
