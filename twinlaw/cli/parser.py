"""The parser of the command line: all verbs by name, with the options of those that are asked for."""

import argparse
from collections.abc import Sequence
from typing import NoReturn

from twinlaw.cli import console
from twinlaw.verbs import VERBS, verb_module, verb_text

DESCRIPTION = "From a plant's equations to a verified flight of a microcontroller, and back."
EPILOGUE = "Start with: twinlaw run --plant plants/ce150.toml --out build"


class WrongCommandLine(SystemExit):
    """Exit status 2, and the line that has been told."""

    def __init__(self, line: str) -> None:
        super().__init__(2)
        self.line = line


class Parser(argparse.ArgumentParser):
    """A parser that tells what is wrong with the command line in one line, as all else is told."""

    def error(self, message: str) -> NoReturn:
        """Leave with exit status 2."""
        line = f"{message}; `{self.prog} --help` names what there is"
        console.fail(line)
        raise WrongCommandLine(line)


def build_parser(asked: Sequence[str]) -> Parser:
    """The parser of all verbs, with the options of those that are `asked` for."""
    parser = Parser(prog="twinlaw", description=DESCRIPTION, epilog=EPILOGUE)
    verbs = parser.add_subparsers(title="verbs, in the order of the work", metavar="VERB", required=True)
    for word in VERBS:
        text = verb_text(word)
        sub = verbs.add_parser(
            word,
            help=text.splitlines()[0].replace("%", "%%"),
            description=text,
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )
        if word in asked:
            verb = verb_module(word)
            verb.add_arguments(sub)
            sub.set_defaults(run=verb.run)
    return parser
