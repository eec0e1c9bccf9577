"""The command `twinlaw`: one verb per file of twinlaw/verbs, named in the order of the work.

Exit status: 0 done, 1 a verification failed, 2 bad input (one line on stderr: where, what, got, expected, remedy).
"""

import argparse
import os
import signal
import sys
from collections.abc import Sequence

from records.errors import BadInput, VerificationFailed
from twinlaw import console
from twinlaw.verbs import VERBS

DESCRIPTION = "From a plant's equations to a verified flight of a microcontroller, and back."
EPILOGUE = "Start with: twinlaw run --plant plants/ce150.toml --out build"


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one verb and return the exit status."""
    options = _parser().parse_args(arguments)
    try:
        return int(options.run(options))
    except BadInput as error:
        console.fail(str(error))
        return 2
    except VerificationFailed as error:
        console.fail(str(error))
        return 1
    except BrokenPipeError:
        # The reader of a pipe has left (`twinlaw bench | head`): not an error of ours.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except KeyboardInterrupt:
        console.fail("interrupted; files already written are whole, the others were not begun")
        return 128 + signal.SIGINT


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="twinlaw", description=DESCRIPTION, epilog=EPILOGUE)
    verbs = parser.add_subparsers(title="verbs, in the order of the work", metavar="VERB", required=True)
    for name, verb in VERBS.items():
        sentence = (verb.__doc__ or "").splitlines()[0]
        sub = verbs.add_parser(
            name, help=sentence, description=verb.__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
        )
        verb.add_arguments(sub)
        sub.set_defaults(run=verb.run)
    return parser


if __name__ == "__main__":
    sys.exit(main())
